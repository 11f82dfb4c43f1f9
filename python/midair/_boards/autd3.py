"""Transport to AUTD3 boards over UDP, for both protocol versions. All boards acknowledge every step."""

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
from .transport import Transport

MOST_BOARDS = 128
EMULATOR = "autd3:emulator"

#: Time in s to wait for the acknowledgement of a step; largest number of repetitions without one.
ACKNOWLEDGED = 0.02
RETRIES = 14
#: When a board is lost, the step that turns all boards off is sent twice, because a datagram may get lost.
TWICE = 2
#: Time in s between two keep-alive datagrams. Boards that do not answer for LOST s count as lost and mute
#: themselves.
BEAT = 0.03
LOST = 0.4

#: Reasons for which a board rejects a step, by its status code.
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

#: Possible causes, for the error message, if boards stop answering.
ELSEWHERE = ": unplugged, rebooted or taken over by another program"

_STEP = struct.Struct("<BBI")  # count, command, 0: execute now
_REPLY = struct.Struct("<BBBBQ")  # count, status, flags, board number, board clock

_Reply = tuple[int, bytes]


class Overtaken(Exception):
    """Raised if `silence` was called while a step was being sent, so that the step is dropped."""


class Link:
    """Connection to a chain of boards, silent at first. A thread sends keep-alive messages."""

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
        """Send a step repeatedly until every board has acknowledged it; return the data of their replies."""
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
        """Raise BoardLost if boards have stopped replying."""
        if self._gone:
            raise BoardLost(f"{self._address}: {self._gone}; connect again")

    def close(self) -> None:
        """Close the connection without turning the boards off."""
        self._over.set()
        with self._lock:
            self._gone = "closed"
            self._chain.close()

    def _acknowledged(self, step: Step, wanted: Callable[[], bool]) -> list[_Reply]:
        """Send a step, with retries, and return each board's reply."""
        replies: dict[int, _Reply] = {}
        for _ in range(1 + RETRIES):
            if not wanted():
                raise Overtaken
            replies |= self._exchange(set(range(self._boards)) - set(replies), step)
            if len(replies) == self._boards:
                return [replies[unit] for unit in range(self._boards)]
        missing = min(set(range(self._boards)) - set(replies))
        raise self._lost(f"board {missing} did not reply within {1000 * (1 + RETRIES) * ACKNOWLEDGED:g} ms", ELSEWHERE)

    def _exchange(self, units: Collection[int], step: Step | None = None) -> dict[int, _Reply]:
        """Send a step, or a keep-alive if `step` is None; return (status, data) of the boards that reply."""
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
                # A board that lost this step repeats the reply to the step before it, with the older count.
                if count != self._counts[unit]:
                    continue
                self._counts[unit] = (count + 1) % 256
            self._answered[unit] = time.monotonic()
            replies[unit] = status, body[_REPLY.size :]
            if len(replies) == len(units):
                break
        return replies

    def _content(self, unit: int, step: Step | None) -> bytes:
        """Return the content of the datagram to one board."""
        if step is None:
            return b""
        payload = step.payloads[unit if len(step.payloads) > 1 else 0]
        return _STEP.pack(self._counts[unit], step.command, 0) + payload

    def _lost(self, why: str, cause: str = "") -> BoardLost:
        """Turn off the boards that still receive, stop the keep-alive messages, and return the error."""
        self._over.set()
        self._gone = f"{why}{cause}; boards that still play mute themselves in half a second"
        off = commands.pattern(bytes(self._boards * CODES), self._boards, self.protocol)
        for _ in range(TWICE):
            self._chain.send(Kind.STEP, {unit: self._content(unit, off) for unit in range(self._boards)})
            list(self._chain.replies(Kind.STEP, ACKNOWLEDGED))
        return BoardLost(f"{self._address}: {self._gone}; connect again")

    def _beat(self) -> None:
        """Send keep-alive messages until closed. No reply for LOST s: the connection is lost."""
        while not self._over.wait(BEAT):
            with self._lock, suppress(BoardError):
                self._exchange(range(self._boards))
                for unit, answered in enumerate(self._answered):
                    if self._spoken - answered > LOST:
                        raise self._lost(f"board {unit} stopped answering", ELSEWHERE)

    def _check_firmware(self, unit: int, info: bytes) -> None:
        """Raise BoardError if the processor and the FPGA of a board have firmware of different versions."""
        if info[:2] != info[3:5]:
            raise BoardError(
                f"{self._address}: board {unit} has firmware {version(info[:3])} in its processor, "
                f"{version(info[3:6])} in its FPGA: put {self.protocol.firmware} in both by its makers' tool"
            )


class Autd3Transport(Transport):
    """Plays frames on AUTD3 boards.

    `address` is "autd3" (searches every network interface), "autd3:eth0" (one interface), "autd3:[IPv6]:PORT"
    or "autd3:emulator" (an emulator in this process, which makes no sound). After opening, the boards are
    silent.
    """

    def __init__(self, address: str, boards: int) -> None:
        if not 1 <= boards <= MOST_BOARDS:
            raise BoardError(f"{address}: {boards} boards, give 1 to {MOST_BOARDS}")
        self._boards = boards
        self._bank, self._divider = BANKS[0], PHASE_STEPS
        # Number of calls of `silence` so far. A step that began before the last call is dropped.
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
        """Play one frame without end. Returns when every board has acknowledged it."""
        before, step = self._silenced, commands.pattern(frame, self._boards, self._link.protocol)
        self._play([step], PHASE_STEPS, BANKS[0], before)

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Store `count` frames in the boards, which repeat them by themselves at `rate` frames per second."""
        before, divider, bank = self._silenced, commands.divider(rate), 1 - self._bank
        steps = commands.sequence(frames, count, self._boards, divider, bank, self._link.protocol)
        self._play(steps, divider, bank, before)

    def modulate(self, wave: float | bytes | None) -> None:
        """Modulate all later frames, too: by a sine at a frequency in Hz, by codes 0 to 255; None ends it."""
        steps = commands.modulation(wave)
        with self._lock:
            for step in steps:
                self._link.send(step)

    def silence(self) -> None:
        """Turn all transducers off within 250 us after arrival; drop frames that are being sent."""
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
        """Turn all transducers off, as far as boards still receive, and close the connection."""
        with suppress(BoardError):
            self.silence()
        self._link.close()

    def _play(self, steps: Sequence[Step], divider: int, bank: int, before: int) -> None:
        """Set the silencer for frames that last `divider` ultrasound periods each; send the frames' steps."""

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
    """Start the makers' emulator of boards with firmware 0.12; return it and its address."""
    try:
        import autd3
    except ImportError as error:
        raise BoardError(f'{EMULATOR} needs autd3: pip install "midair[autd3]"') from error
    emulator = autd3.UdpEmulator(boards)
    return emulator, "autd3:" + repr(emulator.option().iface).split('"')[1]
