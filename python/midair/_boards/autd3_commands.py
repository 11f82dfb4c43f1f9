"""Commands of AUTD3 boards: frames, sequences and modulation as the packages of autd3 take them, checked.

A frame is, for each board, 249 phase codes and then 249 intensity codes. Nothing here imports midair itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TypeVar

from autd3 import Duration
from autd3.commands import FixedCompletionTime, Modulation, Pattern, PatternStm, PatternStmOption, SetSilencer
from autd3.geometry import Autd3, Geometry
from autd3.value import PatternBank, SamplingConfig
from autd3_modulation import ModulationBuffer
from autd3_pattern import IntensityBuffer, PhaseBuffer

from .errors import BoardError

TRANSDUCERS = 249
#: Ultrasound periods a second; the device's clock for all it plays by itself.
ULTRASOUND = 40_000
#: Patterns that a device holds, and the longest time of one in ultrasound periods.
PATTERNS = (2, 1024)
DIVIDERS = (1, 65535)
#: Samples of a modulation that a device holds, how many it plays a second (one lasts as long as the silencer
#: takes for an intensity), and how many a period of a sine needs at least.
SAMPLES = 65536
SAMPLING = 4000
SAMPLES_A_PERIOD = 4
#: Times of the default silencer in ultrasound periods: a phase comes within 1 ms, an intensity within 250 us.
PHASE_STEPS = 40
INTENSITY_STEPS = 10

_Buffer = TypeVar("_Buffer", PhaseBuffer, IntensityBuffer)


def geometry(poses: Sequence[tuple[Sequence[float], Sequence[float]]]) -> Geometry:
    """Boards at (origin in mm, quaternion (w, x, y, z)), in their order."""
    return Geometry([Autd3(origin=origin, rotation=rotation) for origin, rotation in poses])


def pattern(frame: bytes, boards: int) -> Pattern:
    """One frame, played at once; the device's first bank of patterns holds it."""
    _check_length(frame, 1, boards)
    return Pattern(_part(PhaseBuffer, frame, 0), _part(IntensityBuffer, frame, TRANSDUCERS))


def sequence(frames: bytes, count: int, boards: int, divider: int, bank: PatternBank) -> PatternStm:
    """Frames that the device plays by itself over and over, each for `divider` ultrasound periods."""
    least, most = PATTERNS
    if not least <= count <= most:
        raise BoardError(
            f"sequence of {counted(count, 'frame')}: an AUTD3 board holds {least} to {most}: send one, "
            "stream more"
        )
    _check_length(frames, count, boards)
    size = len(frames) // count
    parts = [frames[start : start + size] for start in range(0, len(frames), size)]
    phases = [_part(PhaseBuffer, part, 0) for part in parts]
    intensities = [_part(IntensityBuffer, part, TRANSDUCERS) for part in parts]
    # Eight bits a phase, as by default: four would double what fits, but codes 0 and 255 then lie together.
    return PatternStm(SamplingConfig(divider), phases, intensities, PatternStmOption(bank=bank))


def divider(rate: float) -> int:
    """Ultrasound periods a frame at `rate` frames a second; refused where that is no whole number of them."""
    least, most = DIVIDERS
    periods = ULTRASOUND / rate if math.isfinite(rate) and rate > 0 else math.nan
    nearest = min(max(round(periods), least), most) if math.isfinite(periods) else least
    if not abs(periods - nearest) <= 1e-9 * nearest:
        raise BoardError(
            f"rate {rate:.12g} frames/s: an AUTD3 board plays 40 kHz divided by a whole number up to {most}; "
            f"the nearest is {ULTRASOUND / nearest:.12g}"
        )
    return nearest


def modulation(hz: float | None) -> Modulation:
    """A sine of 0 to 255 at `hz`, a whole number of periods of it; a constant 255 for None."""
    codes = bytes([255, 255]) if hz is None else _sine(hz)
    return Modulation(SamplingConfig.FREQ_4K, ModulationBuffer.from_bytes(codes))


def silencer(divider: int) -> SetSilencer:
    """Phases and intensities glide to a pattern within its time, and at most within the default silencer's.

    Not strict: the strict one refuses to be set while a fast sequence runs, and asks for a newer FPGA.
    """

    def time(steps: int) -> Duration:
        return Duration.from_micros(min(steps, divider) * 1_000_000 // ULTRASOUND)

    return SetSilencer(FixedCompletionTime(time(INTENSITY_STEPS), time(PHASE_STEPS), strict_mode=False))


def counted(number: int, thing: str) -> str:
    """A number of things, in words."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _check_length(frames: bytes, count: int, boards: int) -> None:
    """The packages take buffers of more boards than there are without a word."""
    wanted = count * boards * 2 * TRANSDUCERS
    if len(frames) != wanted:
        raise BoardError(
            f"{counted(count, 'frame')} for {counted(boards, 'AUTD3 board')}: {len(frames)} bytes, not "
            f"{wanted}; give {2 * TRANSDUCERS} a board and frame"
        )


def _part(buffer: type[_Buffer], frame: bytes, start: int) -> _Buffer:
    """249 codes of each board, from `start` in the board's part of the frame."""
    boards = range(start, len(frame), 2 * TRANSDUCERS)
    return buffer.from_array([frame[at : at + TRANSDUCERS] for at in boards])


def _sine(hz: float) -> bytes:
    """Codes round(127.5 (1 + sin)) of the shortest buffer that holds whole periods of `hz`."""
    highest = SAMPLING / SAMPLES_A_PERIOD
    lowest = SAMPLING / SAMPLES
    if not lowest <= hz <= highest:
        raise BoardError(
            f"modulation at {hz:.12g} Hz: an AUTD3 board modulates at {lowest:.6g} to {highest:g} Hz"
        )
    turns = (Fraction(hz) / SAMPLING).limit_denominator(SAMPLES)
    nearest = float(turns * SAMPLING)
    if abs(nearest - hz) > 1e-9 * hz:
        raise BoardError(
            f"modulation at {hz:.12g} Hz: no whole number of periods fits the {SAMPLES} samples that an "
            f"AUTD3 board plays at {SAMPLING} Hz; the nearest that fits is {nearest:.12g} Hz"
        )
    periods, samples = turns.as_integer_ratio()
    angles = (2 * math.pi * (k * periods % samples) / samples for k in range(samples))
    return bytes(math.floor(127.5 * (1 + math.sin(angle)) + 0.5) for angle in angles)
