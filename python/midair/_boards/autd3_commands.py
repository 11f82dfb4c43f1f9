"""Commands of AUTD3 boards as bytes: frames, sequences and modulation in the two protocols of their firmware.

A frame has 249 phase codes and then 249 intensity codes for each board. A command consists of one or several
steps; every board acknowledges a step before the next one is sent. The layouts are those of the makers'
crates autd3-cpu-wire and autd3-cpu-fw, 0.12.0 for protocol 3 and 0.13.0 for protocol 5. This module does not
import midair itself.
"""

import math
import struct
from collections.abc import Sequence
from enum import IntEnum
from fractions import Fraction
from typing import NamedTuple

from .errors import BoardError

TRANSDUCERS = 249
#: Bytes of one board in a frame.
CODES = 2 * TRANSDUCERS
#: Ultrasound periods per second; the unit of time in the board's sequences.
ULTRASOUND = 40_000
#: Least and largest number of frames ("patterns") in a bank; least and largest duration of a frame in
#: ultrasound periods; numbers of the two banks.
PATTERNS = (2, 1024)
DIVIDERS = (1, 65535)
BANKS = (0, 1)
#: Largest number of samples of a modulation; samples per second; least number of samples in a sine's period.
#: A sample lasts as long as the silencer takes to change an intensity.
SAMPLES = 65536
SAMPLING = 4000
SAMPLES_A_PERIOD = 4
#: Times of the default silencer, which changes phases and intensities gradually, in ultrasound periods: 1 ms
#: for a phase, 250 us for an intensity.
PHASE_STEPS = 40
INTENSITY_STEPS = 10
#: Change per period in the silencer's other mode, which midair does not use; the board needs a number.
RATE_STEPS = 256
#: A board that receives nothing for this time, in ms, mutes itself.
FAILSAFE_MS = 500

#: A step is one datagram, which every board acknowledges. These are its largest size in bytes without the
#: header, and the largest number of frames in it.
PAYLOAD = 1442
PATTERNS_A_STEP = 2

#: Settings of a bank: play at once, and repeat without end.
AT_ONCE = 0xFF
ENDLESS = 0xFFFF
#: Code for a bank that stores phase and intensity codes, not foci.
RAW = 1

_BANK = struct.Struct("<BBQ")  # bank, when to switch, parameter of the switch
_PATTERNS = struct.Struct("<BBH")  # bank, number of frames, index of the first
_CONFIG_PATTERNS = struct.Struct("<BBHIBBHH")  # bank, RAW, divider, count, three values for foci, repetitions
_SAMPLES = struct.Struct("<BBI")  # bank, 0, index of the first sample
_CONFIG_SAMPLES = struct.Struct("<BBHIH")  # bank, 0, divider, count, repetitions
_SILENCER = struct.Struct("<BBHHHH")  # flags, 0, two rates, steps of an intensity, steps of a phase
#: Settings of a board's processor: the makers' defaults, and the failsafe, which protocol 5 leaves off by
#: default.
_SETTINGS = struct.pack(
    "<I5H5I9H",
    *(250_000, 8, 3, 6, 1000, 64, 10_000, 100, 50, 1, 500_000),
    *(FAILSAFE_MS, 32, 5, 48, 64, 8, 0, 3, 1000),
)


class Protocol(NamedTuple):
    """A version of the boards' protocol and the firmware that uses it.

    Attributes
    ----------
    counted
        Whether each step has a count, by which a board ignores a repeated step.
    paired
        Whether codes are pairs of phase and intensity; otherwise all phases precede all intensities.
    """

    number: int
    firmware: str
    counted: bool
    paired: bool


#: Protocols by number, the newest first.
PROTOCOLS = {5: Protocol(5, "0.13", False, True), 3: Protocol(3, "0.12", True, False)}


class Command(IntEnum):
    """Steps that midair sends, by their number in the protocol."""

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
    """A datagram to every board: its command, and one payload for all boards or one for each."""

    command: Command
    payloads: Sequence[bytes] = (b"",)


def opening(protocol: Protocol) -> list[Step]:
    """Return the steps that make boards silent and synchronised after connecting."""
    if protocol.counted:
        # RESET restarts the count of steps. The failsafe is on by default.
        return [Step(Command.RESET), Step(Command.CLEAR), Step(Command.SYNCHRONIZE)]
    return [Step(Command.CLEAR), Step(Command.SETTINGS, [_SETTINGS]), Step(Command.SYNCHRONIZE)]


def pattern(frame: bytes, boards: int, protocol: Protocol) -> Step:
    """Return the step that plays one frame at once, from the first bank."""
    _check_length(frame, 1, boards)
    header = _BANK.pack(BANKS[0], AT_ONCE, 0)
    return Step(Command.PATTERN, [header + codes for codes in _parts(frame, protocol)])


def sequence(frames: bytes, count: int, boards: int, divider: int, bank: int, protocol: Protocol) -> list[Step]:
    """Return the steps by which boards store frames and repeat them; a frame lasts `divider` periods."""
    check_count(count)
    _check_length(frames, count, boards)
    parts, steps = _parts(frames, protocol), []
    for first in range(0, count, PATTERNS_A_STEP):
        last = min(first + PATTERNS_A_STEP, count)
        header = _PATTERNS.pack(bank, last - first, first)
        # `parts` has all boards of the first frame, then all boards of the next: every `boards`-th part is
        # this board's.
        payloads = [header + b"".join(parts[first * boards + k : last * boards : boards]) for k in range(boards)]
        steps.append(Step(Command.WRITE_PATTERNS, payloads))
    config = _CONFIG_PATTERNS.pack(bank, RAW, divider, count, 0, 0, 0, ENDLESS)
    played = _BANK.pack(bank, AT_ONCE, 0)
    return [*steps, Step(Command.CONFIG_PATTERNS, [config]), Step(Command.PLAY_PATTERNS, [played])]


def check_count(count: int) -> None:
    """Raise BoardError for a sequence of fewer or more frames than a board can store."""
    least, most = PATTERNS
    if not least <= count <= most:
        raise BoardError(
            f"sequence of {counted(count, 'frame')}: an AUTD3 board holds {least} to {most}: send one, stream more"
        )


def divider(rate: float) -> int:
    """Return how many ultrasound periods a frame lasts at `rate` frames per second.

    Raises BoardError if this is no whole number.
    """
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
    """Return the steps of a modulation: a sine of `wave` Hz, given codes of 0 to 255, or 255 for None."""
    samples = bytes([255, 255]) if wave is None else wave if isinstance(wave, bytes) else _sine(wave)
    if not 2 <= len(samples) <= SAMPLES:
        raise BoardError(f"modulation of {counted(len(samples), 'sample')}: an AUTD3 board holds 2 to {SAMPLES}")
    bank, most = BANKS[0], PAYLOAD - _SAMPLES.size
    steps = [
        Step(Command.WRITE_SAMPLES, [_SAMPLES.pack(bank, 0, first) + samples[first : first + most]])
        for first in range(0, len(samples), most)
    ]
    config = _CONFIG_SAMPLES.pack(bank, 0, ULTRASOUND // SAMPLING, len(samples), ENDLESS)
    played = _BANK.pack(bank, AT_ONCE, 0)
    return [*steps, Step(Command.CONFIG_SAMPLES, [config]), Step(Command.PLAY_SAMPLES, [played])]


def silencer(divider: int) -> Step:
    """Return the step that sets the silencer, so that drives change within a frame of `divider` periods.

    Its default times are used if they are shorter.
    """
    steps = min(INTENSITY_STEPS, divider), min(PHASE_STEPS, divider)
    return Step(Command.SILENCER, [_SILENCER.pack(0, 0, RATE_STEPS, RATE_STEPS, *steps)])


def counted(number: int, thing: str) -> str:
    """Return a number and a noun, in the plural if needed."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _check_length(frames: bytes, count: int, boards: int) -> None:
    """Raise BoardError if the frames are not for this number of boards."""
    wanted = count * boards * CODES
    if len(frames) != wanted:
        raise BoardError(
            f"{counted(count, 'frame')} for {counted(boards, 'AUTD3 board')}: {len(frames)} bytes, not "
            f"{wanted}; give {CODES} a board and frame"
        )


def _parts(frames: bytes, protocol: Protocol) -> list[bytes]:
    """Split frames into the codes of each board, in the order of the protocol."""
    parts = [frames[at : at + CODES] for at in range(0, len(frames), CODES)]
    return [_paired(part) for part in parts] if protocol.paired else parts


def _paired(codes: bytes) -> bytes:
    pairs = bytearray(CODES)
    pairs[::2], pairs[1::2] = codes[:TRANSDUCERS], codes[TRANSDUCERS:]
    return bytes(pairs)


def _sine(hz: float) -> bytes:
    """Return codes round(127.5 (1 + sin)) of the shortest buffer with a whole number of periods of `hz`."""
    highest = SAMPLING / SAMPLES_A_PERIOD
    lowest = SAMPLING / SAMPLES
    if not lowest <= hz <= highest:
        raise BoardError(f"modulation at {hz:.12g} Hz: an AUTD3 board modulates at {lowest:.6g} to {highest:g} Hz")
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
