"""Models of the boards' firmware, byte by byte.

Each model receives the bytes of one line (`receive`) and computes the output of its channels (`drive`, in
the order of the board's channels) from the physics of its pulses. No model uses midair's encoders. The
models start in the power-up state, and follow Firmware/FPGA */src of upnalab/SonicSurface, FPGA_3.4.2/src
of RMResearch/OpenMPD_Hardware, DriverBoards of asiermarzo/Ultraino and fpga/shared of
ultrasonic-homies/ultrasonic-holography. The frame of AUTD3 is midair's own: codes, not a protocol.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from pulses import Codes, Complex, Levels, harmonic, pulses


class Line(Protocol):
    """One serial line and the boards that listen to it."""

    def receive(self, data: bytes) -> None: ...

    @property
    def drive(self) -> Complex: ...


class Autd3:
    """AUTD3 boards. A frame has, for each board, 249 phase codes and then 249 intensity codes."""

    def __init__(self, boards: int) -> None:
        self.codes = np.zeros((boards, 2, 249), np.int64)

    def receive(self, data: bytes) -> None:
        for at in range(0, len(data), self.codes.size):
            frame = np.frombuffer(data[at : at + self.codes.size], np.uint8)
            self.codes = frame.astype(np.int64).reshape(self.codes.shape)

    @property
    def drive(self) -> Complex:
        phases, intensities = self.codes[:, 0].ravel(), self.codes[:, 1].ravel()
        return intensities / 255 * np.exp(2j * np.pi * phases / 256)

    @property
    def pulse_widths(self) -> Codes:
        """Pulse widths that the boards play for the intensities, in 1/512 of a period."""
        return np.rint(512 / np.pi * np.arcsin(self.codes[:, 1].ravel() / 255)).astype(np.int64)


class SonicSurface:
    """A board with primary (192) or secondary (193) firmware: two banks, which byte 253 exchanges."""

    def __init__(self, name: int = 192) -> None:
        self.name = name
        self.selected = True
        self.clocks = True
        self.address = 0
        self.playing = [0] * 256
        self.waiting = [0] * 256

    def receive(self, data: bytes) -> None:
        for byte in data:
            if byte == 254 and self.selected:
                self.address = 0
            elif byte == 253:
                self.playing, self.waiting = self.waiting, self.playing
                self.address = 0
            elif byte in (150, 151):
                self.clocks = byte == 151
            elif byte in (192, 193):
                self.selected = byte == self.name
            elif self.selected:
                self.waiting[self.address % 256] = 32 if byte == 32 else byte & 31
                self.address += 1

    @property
    def drive(self) -> Complex:
        """The output of the VHDL in simulation: every eighth channel is one tick late, and the secondary
        board lags.

        The secondary board's counter starts half a period after the primary's, behind a filter of 5 or 8
        taps. The lag is then 186.3 or 189.0 degrees; midair uses the mean.
        """
        codes = np.array(self.playing)
        board = (17 - 0.32) / 32 if self.name == 193 else 0.0
        late = np.where(np.arange(256) % 8 == 3, 1 / 32, 0.0) + board
        return pulses(codes & 31, np.where(codes == 32, 0, 16), 32) * np.exp(2j * np.pi * late)


class SonicSurfaces:
    """A primary and a secondary board on one line."""

    def __init__(self, boards: int) -> None:
        self.boards = [SonicSurface(192 + k) for k in range(boards)]

    def receive(self, data: bytes) -> None:
        for board in self.boards:
            board.receive(data)

    @property
    def drive(self) -> Complex:
        return np.concatenate([board.drive for board in self.boards])


class OpenMpd:
    """A board behind a FIFO that passes bytes on in blocks of 512; `idle` clears an incomplete block."""

    CHUNK = 512

    def __init__(self) -> None:
        self.fifo = bytearray()
        self.count = 0
        self.swapping = False
        self.divider = 4
        self.divider_bits = 0
        self.writing = [0] * 512
        self.playing = [0] * 512
        self._command(0x80)
        for _ in range(511):
            self._command(0)
        self._command(None)

    def receive(self, data: bytes) -> None:
        self.fifo += data
        while len(self.fifo) >= self.CHUNK:
            for byte in self.fifo[: self.CHUNK]:
                self._command(byte)
            self._command(None)
            del self.fifo[: self.CHUNK]

    def idle(self) -> None:
        """Models a pause of 1.22 s without bytes, which clears the FIFO."""
        self.fifo.clear()

    def _command(self, byte: int | None) -> None:
        """Models one clock cycle of the reader, with the byte that it receives, or None."""
        if self.swapping:  # the byte that arrives in this cycle is lost
            self.swapping = False
            self.writing, self.playing = self.playing, self.writing
            return
        if byte is None or (self.count == 0 and byte < 128):
            return
        self.writing[self.count] = byte & 127
        bit = byte >> 7
        if 26 <= self.count < 34:
            at = self.count - 26
            self.divider_bits = (self.divider_bits & ~(1 << at)) | bit << at
        elif self.count == 34 and bit:
            self.divider = self.divider_bits
        self.count = (self.count + 1) % 512
        self.swapping = self.count == 0

    @property
    def drive(self) -> Complex:
        return pulses(np.array(self.playing[:256]), np.array(self.playing[256:]), 128)


class Arduino:
    """The common part of the Arduino sketches: two banks, and bytes whose low nibble is the number of a
    board.

    The board stores the high nibble of bytes for board 1, and sends other bytes on with the number less
    one. Nano's sketch is not published: the model assumes Nano16's with 24 divisions of one port. Bytes
    beyond a bank overwrite other memory of the board; the model drops them.
    """

    def __init__(self, divisions: int, ports: int, room: int = 1) -> None:
        self.divisions, self.ports = divisions, ports
        size = divisions * ports
        self.playing = bytearray(size * room)
        self.playing[: size // 2] = b"\xff" * (size // 2)
        self.waiting = bytearray(size * room)
        self.index = 0
        self.sent = bytearray()

    def receive(self, data: bytes) -> None:
        for byte in data:
            if byte == 0x00:
                self.sent.append(byte)
                self.playing, self.waiting = self.waiting, self.playing
                self.index = 0
                self.swapped()
            elif byte & 15 == 1:
                at, low = divmod(self.index, 2)
                if at < len(self.waiting):
                    self.waiting[at] = self.waiting[at] | byte >> 4 if low else byte & 0xF0
                self.index += 1
            elif self.command(byte):
                self.sent.append(byte)
            else:
                self.sent.append((byte - 1) % 256)

    def swapped(self) -> None:
        pass

    def command(self, byte: int) -> bool:
        """Runs Nano16's command that resets the index; returns whether the byte is that command."""
        if byte == 0x10:
            self.index = 0
        return byte == 0x10

    def levels(self, pattern: int = 0) -> Levels:
        size = self.divisions * self.ports
        data = np.frombuffer(bytes(self.playing[pattern * size : (pattern + 1) * size]), np.uint8)
        return np.unpackbits(data.reshape(self.divisions, self.ports), axis=1, bitorder="little") == 1

    @property
    def drive(self) -> Complex:
        return harmonic(self.levels())


class Mega64(Arduino):
    """A board of 64 pins on ten ports, with 32 patterns and their durations; `drive` is the first pattern."""

    # fmt: off
    PINS = (
        51, 52, 53, 54, 28, 29, 30, 31, 47, 46, 45, 44, 43, 42, 41, 40, 56, 57, 58, 59, 48, 49,
        72, 69, 39, 38, 37, 36, 35, 34, 33, 32, 21, 23, 65, 63, 9, 11, 13, 15, 20, 22, 64, 66,
        8, 10, 12, 14, 24, 25, 26, 27, 16, 17, 18, 19, 7, 6, 5, 4, 3, 2, 1, 0,
    )
    # fmt: on

    #: Lengths in clock cycles of the ten divisions of a period: 396 in all.
    TICKS = (38, 42, 34, 35, 35, 36, 43, 43, 34, 56)

    def __init__(self) -> None:
        super().__init__(10, 10, room=32)
        self.durations = [1] + [0] * 31
        self.coming = list(self.durations)
        self.at = 0

    def swapped(self) -> None:
        self.at = 0

    def command(self, byte: int) -> bool:
        if byte & 0x3F == 0x30:
            which, quarter = divmod(self.at, 4)
            if which < 32:
                kept = self.coming[which] if quarter else 0
                self.coming[which] = kept | (byte & 0xC0) >> 2 * quarter
            self.at += 1
        elif byte == 0x10:
            self.durations = list(self.coming)
            self.at = 0
        else:
            return False
        return True

    @property
    def patterns(self) -> int:
        """Number of patterns that the board plays in turn: those before the first duration of 0."""
        return self.durations.index(0, 1) if 0 in self.durations[1:] else 32

    @property
    def drive(self) -> Complex:
        """Drive of the compiled sketch: ports A C L B K F H D G J lag by `late` periods, and ticks differ."""
        late = np.array([0, 3, 7, 10, 14, 17, 20, 24, 27, 30])[np.array(self.PINS) // 8] / 396
        return harmonic(self.levels()[:, list(self.PINS)], self.TICKS) * np.exp(2j * np.pi * late)


class Chain:
    """MEGA64 boards in a chain: each receives the bytes that the board before it sends."""

    def __init__(self, boards: int) -> None:
        self.boards = [Mega64() for _ in range(boards)]

    def receive(self, data: bytes) -> None:
        for board in self.boards:
            board.receive(data)
            data = bytes(board.sent)
            board.sent.clear()

    @property
    def drive(self) -> Complex:
        return np.concatenate([board.drive for board in self.boards])


class Homies:
    """One of a board's two FPGAs, with 128 channels, modelled without modulation.
    An unknown command locks the FPGA up.
    """

    def __init__(self) -> None:
        self.window = 0
        self.burst = -1
        self.locked = False
        self.latest = 0
        self.phases = np.zeros(128, np.int64)
        self.calibration = np.zeros(128, np.int64)
        self.enabled = np.zeros(128, bool)

    def receive(self, data: bytes) -> None:
        for byte in data:
            if self.burst >= 0:
                self._burst(byte)
            elif not self.locked:
                self.window = self.window >> 8 | byte << 56
                if byte == 0xAA and self.window & 0xFF == 0x55:
                    self._obey(self.window >> 40 & 0xFFFF, self.window >> 8 & 0xFFFFFFFF)

    def _obey(self, command: int, data: int) -> None:
        self.window = 0
        if command == 1:
            self._set(data & 0xFF, data >> 8 & 0xFF, data >> 16 & 1)
        elif command == 2:
            self.burst, self.latest = data, data & 0xFF
        elif command == 3:
            self.calibration = self.phases.copy()
        else:
            self.locked = True

    def _burst(self, byte: int) -> None:
        """Receives a byte of a burst; phases and channels alternate. A burst of 0 still takes one byte."""
        if self.burst % 2 == 0:
            self.latest = byte
        else:
            self._set(self.latest, byte, 1)
        self.burst = self.burst - 1 if self.burst > 1 else -1

    def _set(self, phase: int, channel: int, enable: int) -> None:
        if channel < 128:
            self.phases[channel] = phase
            self.enabled[channel] = bool(enable)

    @property
    def drive(self) -> Complex:
        starts = (self.phases + self.calibration) % 256
        return pulses(starts, np.where(self.enabled, 128, 0), 256)


@dataclass(frozen=True)
class Kind:
    """The properties of a kind of board.

    Attributes
    ----------
    lines
        Returns the models that listen to the lines of this many boards, one for each line.
    length
        Returns the length in bytes of a frame for this many boards.
    off
        Returns whether a frame for this many boards is the kind's own command to switch everything off.
    ticks
        Number of ticks in a period, or their lengths. 0 for a kind that receives codes instead of pulses.
    widths
        Possible pulse widths in ticks. None if a pulse can only last half a period, or be left out.
    """

    lines: Callable[[int], Sequence[Line]]
    length: Callable[[int], int]
    off: Callable[[int, bytes], bool]
    ticks: int | tuple[int, ...] = 0
    widths: Sequence[int] = ()


def _no_bits(_: int, frame: bytes) -> bool:
    return all(byte >> 4 == 0 for byte in frame if byte & 15)


KINDS = {
    "autd3": Kind(
        lambda boards: [Autd3(boards)],
        lambda boards: 498 * boards,
        lambda boards, frame: not np.frombuffer(frame, np.uint8).reshape(boards, 2, 249)[:, 1].any(),
    ),
    "sonicsurface": Kind(
        lambda boards: [SonicSurfaces(boards)],
        lambda boards: 258 if boards == 1 else 517,
        lambda boards, frame: set(frame) <= {32, 192, 193, 253, 254} and frame.count(32) == 256 * boards,
        ticks=32,
    ),
    "openmpd": Kind(
        lambda boards: [OpenMpd() for _ in range(boards)],
        lambda boards: 512 * boards,
        lambda boards, frame: frame == boards * (b"\x80" + bytes(511)),
        ticks=128,
        widths=range(65),
    ),
    "mega64": Kind(
        lambda boards: [Chain(boards)],
        lambda boards: 200 * boards + 10,
        _no_bits,
        ticks=Mega64.TICKS,
        widths=range(6),
    ),
    "nano16": Kind(lambda _: [Arduino(16, 2)], lambda _: 65, _no_bits, ticks=16),
    "nano": Kind(lambda _: [Arduino(24, 1)], lambda _: 49, _no_bits, ticks=24),
    "homies": Kind(
        lambda boards: [Homies() for _ in range(boards)],
        lambda boards: 1024 * boards,  # the off command is sent as words of eight bytes
        lambda boards, frame: frame == boards * b"".join(bytes([0x55, 0, c, 0, 0, 1, 0, 0xAA]) for c in range(128)),
        ticks=256,
    ),
}
