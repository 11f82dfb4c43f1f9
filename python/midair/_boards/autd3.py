"""AUTD3 boards over UDP, of either protocol: all boards acknowledge every step."""

from __future__ import annotations

import struct
import threading
import time
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from typing import Any

from . import autd3_commands as commands
from .autd3_chain import ASSIGNED, MUTED, PAUSE, Chain, Kind, version
from .autd3_commands import BANKS, CODES, FAILSAFE_MS, PHASE_STEPS, Command, Step
from .errors import BoardError, BoardLost

MOST_BOARDS = 128
EMULATOR = "autd3:emulator"

#: A step without an acknowledgement within this time, in s, is repeated. A lost datagram costs one retry.
ACKNOWLEDGED = 0.02
RETRIES = 5
#: Repetitions of the last step to lost boards.
TWICE = 2
#: Time between two words to the boards, in s. Boards silent for the second time are lost and mute themselves.
BEAT = 0.03
LOST = 0.4

#: Reasons of a board to reject a step; a step to a board that is not ready is repeated for this time, in s.
REFUSED = {
    0x01: "it does not know it",
    0x02: "its content is not in order",
    0x04: "its silencer forbids it",
    0x07: "its FPGA does not answer",
    0x08: "its clock is not in step",
    0x10: "its FPGA is being updated",
    0x12: "it is about to reboot",
    0x14: "it missed a tick of its clock",
}
NOT_READY = (0x08, 0x14)
READY = 5.0

#: Causes of boards without a reply.
ELSEWHERE = ": unplugged, rebooted or taken over by another program"

_STEP = struct.Struct("<BBI")  # count, command, 0: at once
_REPLY = struct.Struct("<BBBBQ")  # count, status, flags, the board's number, its clock

_Reply = tuple[int, bytes]


class Overtaken(Exception):
    """Raised for a step that was given up."""


class Link:
    """Boards that are silent at first; a thread keeps them alive while nothing else is sent.

    Raises the errors of `Chain`, and BoardError for a board with firmware of two series.
    """

    def __init__(self, address: str, boards: int) -> None:
        self._address, self._boards = address, boards
        self._chain = Chain(address, boards)
        self.protocol = self._chain.protocol
        self._counts = [0] * boards
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._gone = ""
        self._spoken = time.monotonic()
        self._answered = [self._spoken] * boards
        try:
            for step in commands.opening(self.protocol):
                self.send(step)
            for unit, info in enumerate(self.send(Step(Command.FIRMWARE))):
                self._check_firmware(unit, info)
        except BaseException:
            self._chain.close()
            raise
        threading.Thread(target=self._beat, name=address, daemon=True).start()

    def send(self, step: Step, wanted: Callable[[], bool] = lambda: True) -> list[bytes]:
        """Send a step until every board has acknowledged it; return the data of their replies.

        Raises Overtaken if the step was given up, BoardLost if boards do not reply, BoardError if a board
        rejects it.
        """
        with self._lock:
            until = time.monotonic() + READY
            replies = self._acknowledged(step, wanted)
            while any(status in NOT_READY for status, _ in replies) and time.monotonic() < until:
                time.sleep(PAUSE)
                replies = self._acknowledged(step, wanted)
        for unit, (status, _) in enumerate(replies):
            if status:
                why = REFUSED.get(status, f"error {status}")
                raise BoardError(f"{self._address}: board {unit} refuses {step.command.name}: {why}")
        return [data for _, data in replies]

    def look(self) -> None:
        """Raise BoardLost once boards do not reply."""
        if self._gone:
            raise BoardLost(f"{self._address}: {self._gone}; connect again")

    def close(self) -> None:
        """Leave the boards."""
        self._over.set()
        with self._lock:
            self._gone = "closed"
            self._chain.close()

    def _acknowledged(self, step: Step, wanted: Callable[[], bool]) -> list[_Reply]:
        """Wait for each board's reply to a step."""
        replies: dict[int, _Reply] = {}
        for _ in range(1 + RETRIES):
            if not wanted():
                raise Overtaken
            replies |= self._exchange(set(range(self._boards)) - set(replies), step)
            if len(replies) == self._boards:
                return [replies[unit] for unit in range(self._boards)]
        missing = min(set(range(self._boards)) - set(replies))
        raise self._lost(f"board {missing} did not reply within {1000 * ACKNOWLEDGED:g} ms", ELSEWHERE)

    def _exchange(self, units: Collection[int], step: Step | None = None) -> dict[int, _Reply]:
        """Return status and data of the replies that arrive in time to a step, or to a keep-alive word."""
        self.look()
        now = time.monotonic()
        if now - self._spoken > FAILSAFE_MS / 1000:
            raise self._lost("this computer was too busy to send the boards a word")
        self._spoken = now
        kind = Kind.BEAT if step is None else Kind.STEP
        self._chain.send(kind, {unit: self._content(unit, step) for unit in units})
        replies: dict[int, _Reply] = {}
        for unit, body in self._chain.replies(kind, ACKNOWLEDGED):
            if unit not in units or unit in replies or len(body) < _REPLY.size:
                continue
            count, status, flags, number, _ = _REPLY.unpack_from(body)
            if not flags & ASSIGNED or number != unit:
                raise self._lost(f"board {unit} has lost its number", ELSEWHERE)
            if step is None and flags & MUTED:
                raise self._lost(f"board {unit} has muted itself")
            if self.protocol.counted and step is not None and step.command != Command.RESET:
                # A board that drops a step acknowledges the one before.
                if count != self._counts[unit]:
                    continue
                self._counts[unit] = (count + 1) % 256
            self._answered[unit] = time.monotonic()
            replies[unit] = status, body[_REPLY.size :]
            if len(replies) == len(units):
                break
        return replies

    def _content(self, unit: int, step: Step | None) -> bytes:
        """Datagrams of a step, a board each."""
        if step is None:
            return b""
        payload = step.payloads[unit if len(step.payloads) > 1 else 0]
        return _STEP.pack(self._counts[unit], step.command, 0) + payload

    def _lost(self, why: str, cause: str = "") -> BoardLost:
        """Make the error of lost boards, and turn off those that still receive; no message follows."""
        self._over.set()
        self._gone = f"{why}{cause}; boards that still play mute themselves in half a second"
        off = commands.pattern(bytes(self._boards * CODES), self._boards, self.protocol)
        for _ in range(TWICE):
            self._chain.send(Kind.STEP, {unit: self._content(unit, off) for unit in range(self._boards)})
            list(self._chain.replies(Kind.STEP, ACKNOWLEDGED))
        return BoardLost(f"{self._address}: {self._gone}; connect again")

    def _beat(self) -> None:
        """Keep the boards alive; report boards that do not reply for long as lost."""
        while not self._over.wait(BEAT):
            with self._lock, suppress(BoardError):
                self._exchange(range(self._boards))
                for unit, answered in enumerate(self._answered):
                    if self._spoken - answered > LOST:
                        raise self._lost(f"board {unit} stopped answering", ELSEWHERE)

    def _check_firmware(self, unit: int, info: bytes) -> None:
        """Reject a board whose processor and FPGA have firmware of two series."""
        if info[:2] != info[3:5]:
            raise BoardError(
                f"{self._address}: board {unit} has firmware {version(info[:3])} in its processor, "
                f"{version(info[3:6])} in its FPGA: put {self.protocol.firmware} in both by its makers' tool"
            )


class Autd3Transport:
    """Frames to AUTD3 boards.

    `address` is "autd3" (searches every network interface), "autd3:eth0" (one), "autd3:[IPv6]:PORT" or
    "autd3:emulator" (emulated in this process, where nothing emits). Opening leaves the boards silent.
    """

    def __init__(self, address: str, boards: int) -> None:
        if not 1 <= boards <= MOST_BOARDS:
            raise BoardError(f"{address}: {boards} boards, give 1 to {MOST_BOARDS}")
        self._boards = boards
        self._bank, self._divider = BANKS[0], PHASE_STEPS
        # Number of calls of `silence`: steps from before one are given up.
        self._silenced = 0
        self._lock = threading.Lock()
        if address == EMULATOR:
            self._emulator, address = _emulated(boards)
        self._link = Link(address, boards)
        try:
            self.silence()
        except BaseException:
            self.close()
            raise

    def play(self, frame: bytes) -> None:
        """Play a frame until another; return when every board has acknowledged it."""
        before, step = self._silenced, commands.pattern(frame, self._boards, self._link.protocol)
        self._play([step], PHASE_STEPS, BANKS[0], before)

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Let the boards repeat `count` frames at `rate` a second by themselves."""
        before, divider, bank = self._silenced, commands.divider(rate), 1 - self._bank
        steps = commands.sequence(frames, count, self._boards, divider, bank, self._link.protocol)
        self._play(steps, divider, bank, before)

    def modulate(self, wave: float | bytes | None) -> None:
        """Multiply the pressure, now and later, by a sine from 0 to 1, or by codes; by 1 for None."""
        steps = commands.modulation(wave)
        with self._lock:
            for step in steps:
                self._link.send(step)

    def silence(self) -> None:
        """Turn all transducers off within 250 us of the arrival; give up frames on their way."""
        self._silenced += 1
        off = commands.pattern(bytes(self._boards * CODES), self._boards, self._link.protocol)
        with self._lock:
            self._link.send(commands.silencer(PHASE_STEPS))
            self._link.send(off)
            self._bank, self._divider = BANKS[0], PHASE_STEPS

    def look(self) -> None:
        """Raise BoardLost if boards do not answer."""
        self._link.look()

    def close(self) -> None:
        """Turn all transducers off, also of boards that do not answer, and release the boards."""
        with suppress(BoardError):
            self.silence()
        self._link.close()

    def _play(self, steps: Sequence[Step], divider: int, bank: int, before: int) -> None:
        """Play frames of `divider` ultrasound periods each, with a silencer fast enough for them."""

        def wanted() -> bool:
            return self._silenced == before

        with self._lock, suppress(Overtaken):
            if divider != self._divider:
                self._link.send(commands.silencer(divider), wanted)
                self._divider = divider
            for step in steps:
                self._link.send(step, wanted)
            self._bank = bank


def _emulated(boards: int) -> tuple[Any, str]:
    """The makers' emulator of boards with firmware 0.12, and its address."""
    try:
        import autd3
    except ImportError as error:
        raise BoardError(f'{EMULATOR} needs autd3: pip install "midair[autd3]"') from error
    emulator = autd3.UdpEmulator(boards)
    return emulator, "autd3:" + repr(emulator.option().iface).split('"')[1]
