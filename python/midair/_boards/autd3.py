"""AUTD3 boards over UDP, by the packages of autd3 0.12, in a thread with an event loop of its own."""

from __future__ import annotations

import asyncio
import ipaddress
import threading
from collections.abc import Awaitable, Callable, Coroutine, Sequence
from concurrent.futures import TimeoutError as Late
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeVar

from .errors import BoardError, BoardLost, BoardNotFound, BoardTimeout

try:
    import autd3
    from autd3.commands import Command
    from autd3.params import PORT
    from autd3.value import PatternBank

    from . import autd3_commands as commands
except ImportError as error:
    raise BoardError('AUTD3 boards need autd3: pip install "midair[autd3]"') from error

if TYPE_CHECKING:
    from autd3 import Client, Interface

_Result = TypeVar("_Result")

#: Words of the client where a device is there and its firmware is another, and what to do then.
OTHER_FIRMWARE = "protocol version"
FIRMWARE = (
    "midair plays AUTD3 firmware 0.12 (protocol 3; 5 is firmware 0.13): "
    "put 0.12 on the device with its makers' tool"
)

#: What a board acknowledges within this time came; a lost datagram costs one retry, hardly ever two.
ACKNOWLEDGED_MS = 20
RETRIES = 5
#: A board that says nothing for so long is lost. It mutes itself 500 ms after the last word from here.
LOST_MS = 400
#: Seconds that an opening may take (many boards, one after the other, then their clocks), and any other call.
OPENING = 60.0
CALL = 10.0
CLOSING = 1.0


class Autd3Transport:
    """Frames to AUTD3 boards.

    `address` is "autd3" (looks on every network interface), "autd3:eth0" (on one), "autd3:[IPv6]:PORT" or
    "autd3:emulator" (boards emulated in this process, which nobody hears). `poses` has two entries for each
    board: its origin in mm and its unit quaternion (w, x, y, z). Opening it leaves the boards silent.
    """

    def __init__(self, address: str, poses: Sequence[tuple[Sequence[float], Sequence[float]]]) -> None:
        self._address = address
        self._boards = len(poses)
        if not 1 <= self._boards <= autd3.MAX_DEVICES:
            raise BoardError(f"{address}: {self._boards} boards, give 1 to {autd3.MAX_DEVICES}")
        self._geometry = commands.geometry(poses)
        self._client: Client | None = None
        self._bank = PatternBank.B0
        self._divider = commands.PHASE_STEPS
        # Counts the calls of `silence`: what was under way before one is given up.
        self._silenced = 0
        self._closed = False
        self._lock = asyncio.Lock()
        interface = self._interface()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=address, daemon=True)
        self._thread.start()
        try:
            self._run(self._open(interface), OPENING)
        except BaseException:
            self.close()
            raise

    def play(self, frame: bytes) -> None:
        """Play a frame until something else is played; returns when every board has acknowledged it."""
        pattern = commands.pattern(frame, self._boards)
        self._run(self._play(pattern, commands.PHASE_STEPS, PatternBank.B0, self._silenced), CALL)

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Let the boards play `count` frames at `rate` a second by themselves, over and over."""
        divider = commands.divider(rate)
        bank = PatternBank.B0 if self._bank == PatternBank.B1 else PatternBank.B1
        sequence = commands.sequence(frames, count, self._boards, divider, bank)
        self._run(self._play(sequence, divider, bank, self._silenced), CALL)

    def modulate(self, hz: float | None) -> None:
        """Multiply the pressure, now and later, by a sine from 0 to 1 at `hz`; by 1 for None."""
        self._run(self._modulate(commands.modulation(hz)), CALL)

    def silence(self) -> None:
        """Turn all transducers off within 250 us of its coming; frames under way are given up."""
        self._silenced += 1
        self._run(self._stop(), CALL)

    def look(self) -> None:
        """Raise BoardLost of boards that answer the client's heartbeats no more."""
        self._run(self._looked(), CALL)

    def close(self) -> None:
        """Turn all transducers off and let go of the boards; of those that do not answer, too."""
        if self._closed:
            return
        self._silenced += 1
        for last in (self._stop, self._leave):
            with suppress(Exception):
                self._run(last(), CLOSING)
        self._closed = True
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(CLOSING)
        if not self._thread.is_alive():
            self._loop.close()

    def _run(self, work: Coroutine[Any, Any, _Result], seconds: float) -> _Result:
        """The result of what the loop is to do, from any thread but the loop's."""
        if self._closed:
            work.close()
            raise BoardLost(f"{self._address}: closed; connect again")
        future = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return future.result(seconds)
        except Late:
            future.cancel()
            raise BoardTimeout(f"{self._address}: no answer within {seconds:g} s; connect again") from None

    def _interface(self) -> Interface:
        """Where to look for boards."""
        _, colon, place = self._address.partition(":")
        if not colon:
            return autd3.Interface.Auto
        if place == "emulator":
            self._emulator = autd3.UdpEmulator(self._boards)
            return self._emulator.option().iface
        try:
            if place.startswith("["):
                return autd3.Interface.Addr(place)
            if ipaddress.ip_address(place).version == 6:
                return autd3.Interface.Addr(f"[{place}]:{PORT}")
        except ValueError as error:
            if place.startswith("[") or not place:
                raise BoardError(
                    f"{self._address}: {error}; give a network interface, as autd3:eth0"
                ) from error
            return autd3.Interface.Name(place)
        raise BoardError(
            f"{self._address}: AUTD3 boards speak IPv6 only; give autd3, or their network, as autd3:eth0"
        )

    async def _open(self, interface: Interface) -> None:
        """Look for the boards and take them over; they are silent then."""
        option = autd3.UdpOption(iface=interface, lost_timeout=autd3.Duration.from_millis(LOST_MS))
        config = autd3.ClientConfig(ack_timeout=autd3.Duration.from_millis(ACKNOWLEDGED_MS))

        async def attempt() -> None:
            self._client = await autd3.Client.open(self._geometry, option, config)

        try:
            await self._retried(attempt)
        except autd3.Autd3Error as error:
            if error.code != autd3.Autd3Error.NETWORK or OTHER_FIRMWARE in str(error):
                cure = f": {FIRMWARE}" if OTHER_FIRMWARE in str(error) else ""
                raise BoardError(f"{self._address}: {error}{cure}") from error
            raise BoardNotFound(
                f"{self._address}: {str(error).removeprefix('network error: ')}; the array stands for "
                f"{commands.counted(self._boards, 'board')}: check power, cables and firewall (UDP {PORT}), "
                "and of several networks name the one, as autd3:eth0"
            ) from error
        await self._stop()

    async def _play(self, command: Command, divider: int, bank: PatternBank, before: int) -> None:
        """Play what lasts for `divider` ultrasound periods, smoothed by a silencer that lets it."""
        async with self._lock:
            with suppress(_Overtaken):
                if divider != self._divider:
                    await self._deliver(commands.silencer(divider), before)
                    self._divider = divider
                await self._deliver(command, before)
                self._bank = bank

    async def _modulate(self, command: Command) -> None:
        async with self._lock:
            await self._deliver(command)

    async def _stop(self) -> None:
        async with self._lock:
            await self._answered(lambda: self._there().silent_stop())
            self._divider, self._bank = commands.PHASE_STEPS, PatternBank.B0

    async def _looked(self) -> None:
        async def nothing() -> None:
            """What has come says which boards are lost."""

        async with self._lock:
            await self._answered(nothing)

    async def _leave(self) -> None:
        try:
            await self._there().close()
        finally:
            self._client = None

    async def _deliver(self, command: Command, before: int | None = None) -> None:
        """Send a command datagram by datagram, each until every board has acknowledged it."""
        for frame in autd3.Frames.encode(self._geometry, command):

            async def send(frame: autd3.Frame = frame) -> None:
                if before not in (None, self._silenced):
                    raise _Overtaken
                (await (await self._there().send_frame(frame))).check()

            await self._answered(send)

    def _there(self) -> Client:
        """The client while there is one. Nobody else may keep it: its heartbeats go on while one does."""
        if self._client is None:
            raise BoardLost(f"{self._address}: the boards were lost; connect again")
        return self._client

    async def _answered(self, ask: Callable[[], Awaitable[None]]) -> None:
        """Ask the boards until all of them answer."""
        try:
            await self._retried(ask)
            states = self._there().state_checker().check().devices
            lost = [k for k, state in enumerate(states) if state == autd3.DeviceState.Lost]
            if not lost:
                return
            # The client goes on with the others without a word.
            said = f"board {lost[0]} stopped answering"
        except autd3.Autd3Error as error:
            said = str(error)
            if error.code in (autd3.Autd3Error.DEVICE, autd3.Autd3Error.INVALID_ARGUMENT):
                raise BoardError(f"{self._address}: {said}") from error
        # Boards that still answer are turned off. The others mute themselves without heartbeats.
        with suppress(autd3.Autd3Error):
            await self._there().silent_stop()
        self._client = None
        raise BoardLost(
            f"{self._address}: {said}: unplugged, rebooted or taken over by another program; boards that "
            "still play mute themselves in half a second; connect again"
        )

    async def _retried(self, ask: Callable[[], Awaitable[None]]) -> None:
        """Datagrams are lost now and then, and nothing below asks for them again."""
        for retries_left in range(RETRIES, -1, -1):
            try:
                return await ask()
            except autd3.Autd3Error as error:
                if error.code != autd3.Autd3Error.TIMEOUT or not retries_left:
                    raise


class _Overtaken(Exception):
    """What was to be played was overtaken by `silence`."""
