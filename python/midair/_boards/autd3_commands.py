"""Commands of AUTD3 boards as bytes: frames, sequences and modulation in the two protocols of their firmware.

A frame is, for each board, 249 phase codes and then 249 intensity codes. A command is one step or several;
every board acknowledges a step before the next one goes out. The layouts are those of the makers' crates
autd3-cpu-wire and autd3-cpu-fw, 0.12.0 for protocol 3 and 0.13.0 for protocol 5. Nothing here imports midair
itself.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from enum import IntEnum
from fractions import Fraction
from typing import NamedTuple

from .errors import BoardError

TRANSDUCERS = 249
#: Bytes of a board in a frame.
CODES = 2 * TRANSDUCERS
#: Ultrasound periods a second; the clock of everything that a device plays by itself.
ULTRASOUND = 40_000
#: Patterns in each of the two banks of a device, and the longest time of one in ultrasound periods.
PATTERNS = (2, 1024)
DIVIDERS = (1, 65535)
BANKS = (0, 1)
#: The largest number of samples of a modulation, samples a second, and samples in a period of a sine at
#: least. The time of one sample is the time in which the silencer changes an intensity.
SAMPLES = 65536
SAMPLING = 4000
SAMPLES_A_PERIOD = 4
#: Times of the default silencer in ultrasound periods: 1 ms for a phase, 250 us for an intensity.
PHASE_STEPS = 40
INTENSITY_STEPS = 10
#: Step of the silencer in a period if it has no time; the device needs a number.
RATE_STEPS = 256
#: A device without a message for this time, in s, mutes itself.
FAILSAFE_MS = 500

#: The most bytes of a step behind its header, and the most patterns of codes in it.
PAYLOAD = 1442
PATTERNS_A_STEP = 2

#: Behaviour of an activated bank: it plays at once and repeats.
AT_ONCE = 0xFF
ENDLESS = 0xFFFF
#: A bank contains codes, not foci.
RAW = 1

_BANK = struct.Struct("<BBQ")  # bank, when, and by which value
_PATTERNS = struct.Struct("<BBH")  # bank, count, the first one's place
_CONFIG_PATTERNS = struct.Struct("<BBHIBBHH")  # bank, RAW, divider, count, three of foci, repetitions
_SAMPLES = struct.Struct("<BBI")  # bank, 0, the first sample's place
_CONFIG_SAMPLES = struct.Struct("<BBHIH")  # bank, 0, divider, count, repetitions
_SILENCER = struct.Struct("<BBHHHH")  # flags, 0, two rates, steps of an intensity, steps of a phase
#: Settings of a processor: the makers' defaults, and the failsafe, which is off by default in protocol 5.
_SETTINGS = struct.pack(
    "<I5H5I9H",
    *(250_000, 8, 3, 6, 1000, 64, 10_000, 100, 50, 1, 500_000),
    *(FAILSAFE_MS, 32, 5, 48, 64, 8, 0, 3, 1000),
)


class Protocol(NamedTuple):
    """A protocol, by its number, and the firmware that has it.

    Attributes
    ----------
    counted
        Whether steps carry a count, by which a board drops a repeated step.
    paired
        Whether codes are in pairs of phase and intensity, or all phases before all intensities.
    """

    number: int
    firmware: str
    counted: bool
    paired: bool


#: Protocols by number, the newest first.
PROTOCOLS = {
    each.number: each for each in (Protocol(5, "0.13", False, True), Protocol(3, "0.12", True, False))
}


class Command(IntEnum):
    """Kinds of steps that midair sends, by their number."""

    RESET = 0x00
    SYNCHRONIZE = 0x01
    CLEAR = 0x03
    SETTINGS = 0x05
    CONFIG_PATTERNS = 0x11
    PLAY_PATTERNS = 0x12
    WRITE_PATTERNS = 0x15
    PATTERN = 0x16
    WRITE_SAMPLES = 0x20
    CONFIG_SAMPLES = 0x21
    PLAY_SAMPLES = 0x22
    SILENCER = 0x30
    FIRMWARE = 0xEB


class Step(NamedTuple):
    """One datagram to every board: its command and its payload, one for all boards or one for each."""

    command: Command
    payloads: Sequence[bytes] = (b"",)


def opening(protocol: Protocol) -> list[Step]:
    """Steps that put boards into their first state: silent and synchronised."""
    if protocol.counted:
        # The count starts again; the failsafe is on by default.
        return [Step(Command.RESET), Step(Command.CLEAR), Step(Command.SYNCHRONIZE)]
    return [Step(Command.CLEAR), Step(Command.SETTINGS, [_SETTINGS]), Step(Command.SYNCHRONIZE)]


def pattern(frame: bytes, boards: int, protocol: Protocol) -> Step:
    """One frame, played at once, in the device's first bank of patterns."""
    _check_length(frame, 1, boards)
    header = _BANK.pack(BANKS[0], AT_ONCE, 0)
    return Step(Command.PATTERN, [header + codes for codes in _parts(frame, protocol)])


def sequence(
    frames: bytes, count: int, boards: int, divider: int, bank: int, protocol: Protocol
) -> list[Step]:
    """Frames that the device repeats by itself, each for `divider` ultrasound periods."""
    check_count(count)
    _check_length(frames, count, boards)
    parts, steps = _parts(frames, protocol), []
    for first in range(0, count, PATTERNS_A_STEP):
        last = min(first + PATTERNS_A_STEP, count)
        header = _PATTERNS.pack(bank, last - first, first)
        # The parts of a frame are one board after another.
        payloads = [
            header + b"".join(parts[first * boards + k : last * boards : boards]) for k in range(boards)
        ]
        steps.append(Step(Command.WRITE_PATTERNS, payloads))
    config = _CONFIG_PATTERNS.pack(bank, RAW, divider, count, 0, 0, 0, ENDLESS)
    played = _BANK.pack(bank, AT_ONCE, 0)
    return [*steps, Step(Command.CONFIG_PATTERNS, [config]), Step(Command.PLAY_PATTERNS, [played])]


def check_count(count: int) -> None:
    """Reject a sequence of fewer or more frames than a device can store."""
    least, most = PATTERNS
    if not least <= count <= most:
        raise BoardError(
            f"sequence of {counted(count, 'frame')}: an AUTD3 board holds {least} to {most}: send one, "
            "stream more"
        )


def divider(rate: float) -> int:
    """Ultrasound periods a frame at `rate` frames a second; rejects a rate without a whole number of them."""
    least, most = DIVIDERS
    periods = ULTRASOUND / rate if math.isfinite(rate) and rate > 0 else math.nan
    nearest = min(max(round(periods), least), most) if math.isfinite(periods) else least
    if not abs(periods - nearest) <= 1e-9 * nearest:
        raise BoardError(
            f"rate {rate:.12g} frames/s: an AUTD3 board plays 40 kHz divided by a whole number up to {most}; "
            f"the nearest is {ULTRASOUND / nearest:.12g}"
        )
    return nearest


def modulation(wave: float | bytes | None) -> list[Step]:
    """Samples of a sine of 0 to 255 at `wave` Hz, a whole number of periods; given codes; or 255 for None."""
    samples = bytes([255, 255]) if wave is None else wave if isinstance(wave, bytes) else _sine(wave)
    if not 2 <= len(samples) <= SAMPLES:
        raise BoardError(
            f"modulation of {counted(len(samples), 'sample')}: an AUTD3 board holds 2 to {SAMPLES}"
        )
    bank, most = BANKS[0], PAYLOAD - _SAMPLES.size
    steps = [
        Step(Command.WRITE_SAMPLES, [_SAMPLES.pack(bank, 0, first) + samples[first : first + most]])
        for first in range(0, len(samples), most)
    ]
    config = _CONFIG_SAMPLES.pack(bank, 0, ULTRASOUND // SAMPLING, len(samples), ENDLESS)
    played = _BANK.pack(bank, AT_ONCE, 0)
    return [*steps, Step(Command.CONFIG_SAMPLES, [config]), Step(Command.PLAY_SAMPLES, [played])]


def silencer(divider: int) -> Step:
    """Phases and intensities reach a pattern within its time, and at most within the default silencer's.

    Not strict: the strict silencer cannot be set during a fast sequence, and needs a newer FPGA.
    """
    steps = min(INTENSITY_STEPS, divider), min(PHASE_STEPS, divider)
    return Step(Command.SILENCER, [_SILENCER.pack(0, 0, RATE_STEPS, RATE_STEPS, *steps)])


def counted(number: int, thing: str) -> str:
    """Number of things, in words."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _check_length(frames: bytes, count: int, boards: int) -> None:
    """Reject frames of another number of boards."""
    wanted = count * boards * CODES
    if len(frames) != wanted:
        raise BoardError(
            f"{counted(count, 'frame')} for {counted(boards, 'AUTD3 board')}: {len(frames)} bytes, not "
            f"{wanted}; give {CODES} a board and frame"
        )


def _parts(frames: bytes, protocol: Protocol) -> list[bytes]:
    """Order the codes of each board and frame for the protocol."""
    parts = [frames[at : at + CODES] for at in range(0, len(frames), CODES)]
    return [_paired(part) for part in parts] if protocol.paired else parts


def _paired(codes: bytes) -> bytes:
    pairs = bytearray(CODES)
    pairs[::2], pairs[1::2] = codes[:TRANSDUCERS], codes[TRANSDUCERS:]
    return bytes(pairs)


def _sine(hz: float) -> bytes:
    """Codes round(127.5 (1 + sin)) of the shortest buffer with whole periods of `hz`."""
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
