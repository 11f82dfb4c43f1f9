"""Guard: the process that owns a device, and turns it off when its owner (the user's program) ends or hangs.

The guard detects the owner's end in two ways. The pipe between them closes. Or the guard's parent number
changes, even if a forked child of the owner keeps the pipe open. The guard also checks whether the owner is
stopped, and counts missing beats of an owner that hangs in native code. It runs in a session of its own, so
closing the owner's terminal does not end it.
"""

import json
import math
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

from . import wire
from .errors import BoardError, BoardLost, BoardTimeout, named
from .transport import Transport, before_what_computes, open_transport
from .watcher import Stops, Watch
from .wire import Kind, Late

#: Time in s between two checks of the owner.
TICK = 0.02

#: Time in s between two checks that a playing device without new frames is still connected.
LOOK = 0.25

#: Time in s that a call to the device may take before the owner assumes that the guard hangs.
BUSY = {Kind.UPLOAD: 10.0, Kind.MODULATE: 10.0}

Message = tuple[Kind, int, bytes]


class Waiting(NamedTuple):
    """A frame that waits until it is due. `number` is the number of the message that sent it."""

    due: float
    latest: float
    late: Late
    number: int
    frame: bytes


class State(NamedTuple):
    """What a device does: it is off, lost, or plays frames since a time, in a loop at `rate` a second."""

    name: str
    frames: Sequence[bytes] = ()
    since: float = 0.0
    rate: float = 1.0

    def frame(self) -> bytes:
        """Return the frame that plays now, empty if none does."""
        played = int((time.monotonic() - self.since) * self.rate)
        return self.frames[played % len(self.frames)] if self.frames else b""


#: A device that is lost stays so until it plays again.
OFF, LOST = State("off"), State("lost")


class Owner:
    """What the guard knows of its owner's life.

    Parameters
    ----------
    process
        Its process number.
    hold
        Time in s without a call after which everything is turned off.

    Attributes
    ----------
    called, beaten
        When its last call was executed, and when its last beat came.
    """

    def __init__(self, process: int, hold: float) -> None:
        self.process = process
        self._hold = hold
        self._stops = Stops(process)
        self.called = self.beaten = time.monotonic()

    def is_silent(self, *, look: bool) -> bool:
        """Return whether the owner hangs, or has not called for `hold`; `look`: or is stopped."""
        now = time.monotonic()
        return now - self.beaten >= wire.MISSED or (look and self._stops.look()) or self.left() <= 0

    def left(self) -> float:
        """Return the time in s until `hold` is over."""
        return self.called + self._hold - time.monotonic()


class Guard:
    """Executes the owner's messages on a device, plays frames when they are due, and watches the owner.

    `inbox` is the queue of the owner's messages.
    """

    def __init__(self, transport: Transport, owner: Owner, inbox: SimpleQueue[Message], replies: int) -> None:
        self._transport = transport
        self._owner = owner
        self._inbox = inbox
        self._replies = replies
        #: Several threads write answers.
        self._lock = threading.Lock()
        self._put_by: list[Message] = []
        self._waiting: deque[Waiting] = deque()
        self._state = OFF
        self._wave: float | bytes | None = None
        self._counts = {"frames": 0, "late": 0, "lapses": 0}
        self._until = math.inf
        self._looked = 0.0

    def run(self) -> None:
        """Execute messages until the owner closes the connection or is gone."""
        before_what_computes()
        while os.getppid() == self._owner.process:
            # All messages are read before the next frame is played, so that "off" and newer frames overtake
            # older ones.
            for kind, number, content in (came := self._come()):
                if kind == Kind.CLOSE:
                    return
                self._until = time.monotonic() + BUSY.get(kind, wire.MISSED)
                self._serve(kind, number, content)
            self._until = time.monotonic() + wire.MISSED
            if self._waiting and self._waiting[0].due <= time.monotonic():
                self._play_next()
            silent = self._owner.is_silent(look=not came)
            if self._state.frames:
                now = time.monotonic()
                if silent:
                    self._counts["lapses"] += 1
                    self._attempt(0, self._off)
                elif not self._waiting and now - self._looked >= LOOK:
                    self._looked = now
                    self._attempt(0, self._transport.look)

    def beat(self, number: int) -> None:
        """Record that the owner (the user's program) lives. Answer unless the device blocks the guard.

        May run in any thread.
        """
        self._owner.beaten = now = time.monotonic()
        if now < self._until:
            self._reply(Kind.DONE, number)

    def _reply(self, kind: Kind, number: int, content: bytes = b"") -> None:
        """Answer a message. Number 0 needs no answer."""
        # `run` detects an owner that is gone.
        if number:
            with suppress(wire.Gone), self._lock:
                wire.write(self._replies, kind, number, content)

    def _come(self) -> list[Message]:
        """Wait for messages, at most until the next task, and return those that arrived."""
        found, self._put_by = self._put_by, []
        with suppress(Empty):
            found.append(self._inbox.get(timeout=0 if found else self._pause()))
        return found + self._more()

    def _more(self) -> list[Message]:
        """Return the messages that are already in the queue."""
        found = []
        with suppress(Empty):
            while True:
                found.append(self._inbox.get_nowait())
        return found

    def _pause(self) -> float:
        """Return the time in s to wait for a message: until the next frame or check, or until `hold` ends."""
        due = self._waiting[0].due - time.monotonic() if self._waiting else math.inf
        return max(0.0, min(TICK, due, self._owner.left() if self._state.frames else math.inf))

    def _serve(self, kind: Kind, number: int, content: bytes) -> None:
        if kind == Kind.PLAY:
            due, latest, late = wire.WHEN.unpack_from(content)
            self._waiting.append(Waiting(due, latest, Late(late), number, content[wire.WHEN.size :]))
        elif kind == Kind.OFF:
            self._attempt(number, self._off)
        elif kind == Kind.MODULATE:
            (hz,) = wire.MODULATION.unpack_from(content)
            codes = content[wire.MODULATION.size :]
            self._attempt(number, self._modulate, codes or (None if math.isnan(hz) else hz))
        elif kind == Kind.UPLOAD:
            count, rate = wire.UPLOADED.unpack_from(content)
            self._attempt(number, self._upload, content[wire.UPLOADED.size :], count, rate)
        elif kind == Kind.EMITTING:
            self._reply(Kind.FRAME, number, self._state.frame())
        else:
            self._reply(Kind.DONE, number, self.status())
        if kind not in (Kind.STATUS, Kind.EMITTING):
            # A call that has kept the device busy for longer than `hold` is no silence of the owner.
            self._owner.called = time.monotonic()

    def _attempt(self, number: int, act: Any, *arguments: Any) -> None:
        """Call the device and answer with the result. Number 0 marks the guard's own calls: no answer."""
        lost = self._state is LOST
        try:
            act(*arguments)
        except BoardError as error:
            self._fail(number, error, lost=lost or type(error) is not BoardError)
        # A device's library may raise errors of any kind.
        except Exception as error:
            reported = BoardLost(f"the link failed ({named(error)}): connect again")
            self._fail(number, reported, lost=True)
        else:
            self._reply(Kind.DONE, number, self.status())

    def _fail(self, number: int, error: BoardError, *, lost: bool) -> None:
        """Answer a failed call, and all calls whose frames still wait, with an error; turn everything off."""
        reported = _reported(error)
        for message in self._more():
            if message[0] == Kind.PLAY:
                self._serve(*message)
            else:
                self._put_by.append(message)
        failed, self._waiting = self._waiting, deque()
        self._state = LOST if lost else OFF
        for each in (number, *(other.number for other in failed)):
            self._reply(Kind.FAILED, each, self.status(**reported))
        with suppress(Exception):
            self._transport.silence()

    def _play_next(self) -> None:
        """Play the first waiting frame; if it is late, wait, skip it or report an error as requested."""
        first, now = self._waiting.popleft(), time.monotonic()
        if first.late == Late.SKIP and self._waiting and self._waiting[0].due <= now:
            self._counts["late"] += 1
            self._reply(Kind.DONE, first.number, self.status())
        elif first.late == Late.ERROR and now > first.latest:
            self._counts["late"] += 1
            late = BoardTimeout(wire.LATE.format(1e3 * (now - first.due)))
            self._fail(first.number, late, lost=self._state is LOST)
        else:
            self._attempt(first.number, self._play, first.frame)

    def _play(self, frame: bytes) -> None:
        # The state changes first, because the device may play the frame even if the link then fails.
        self._state = State("playing", [frame])
        self._transport.play(frame)
        self._counts["frames"] += 1

    def _upload(self, frames: bytes, count: int, rate: float) -> None:
        length = len(frames) // count
        parts = [frames[k : k + length] for k in range(0, len(frames), length)]
        self._state = State("playing", parts, time.monotonic(), rate)
        self._transport.upload(frames, count, rate)
        self._counts["frames"] += count

    def _modulate(self, wave: float | bytes | None) -> None:
        self._transport.modulate(wave)
        self._wave = wave

    def _off(self) -> None:
        """Turn everything off; drop waiting frames."""
        dropped, self._waiting = self._waiting, deque()
        if self._state.frames:
            self._state = OFF
        try:
            self._transport.silence()
        finally:
            for each in dropped:
                self._reply(Kind.DONE, each.number, self.status())

    def status(self, **more: str) -> bytes:
        """Return the status for the owner, as JSON."""
        modulates = self._state.frames and self._wave is not None
        state = "modulating" if modulates else self._state.name
        return json.dumps({"state": state, **self._counts, **more}).encode()


def main() -> None:
    """Open the device that the first message describes, serve the owner, and turn the device off."""
    parent = os.getppid()
    watch = Watch()
    requests, replies = _pipes()
    inbox: SimpleQueue[Message] = SimpleQueue()
    served: list[Guard] = []
    threading.Thread(target=_listen, args=(requests, inbox, served), daemon=True).start()
    kind, number, content = inbox.get()
    if kind == Kind.CLOSE:
        watch.end()
        return
    setting = json.loads(content)
    sys.path[:] = setting["path"]
    signal.signal(signal.SIGTERM, _end)
    transport: Transport | None = None
    try:
        transport = open_transport(setting["transport"])
        guard = Guard(transport, Owner(parent, setting["hold"]), inbox, replies)
        served.append(guard)
        watch.begin({name: setting[name] for name in ("path", "transport", "owner")})
        wire.write(replies, Kind.DONE, number, guard.status())
        guard.run()
    # A device's library may raise errors of any kind.
    except Exception as error:
        with suppress(wire.Gone):
            wire.write(replies, Kind.FAILED, number, json.dumps(_reported(error)).encode())
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        if transport is not None:
            with suppress(Exception):
                transport.silence()
            transport.close()
        watch.end()


def _pipes() -> tuple[int, int]:
    """Return the pipes from and to the owner.

    Standard input and output become empty, so that libraries cannot use the pipes.
    """
    requests, replies = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    return requests, replies


def _reported(error: Exception) -> dict[str, str]:
    """Return kind and text of an error for the owner, in one line."""
    text = str(error) if isinstance(error, BoardError | ImportError) else named(error)
    return {"kind": type(error).__name__, "message": " ".join(text.split())}


def _listen(requests: int, inbox: SimpleQueue[Message], served: list[Guard]) -> None:
    """Read messages: answer beats at once, queue the others. At the end of the pipe, queue CLOSE."""
    before_what_computes()
    with suppress(wire.Gone):
        while True:
            kind, number, content = wire.read(requests)
            if kind != Kind.BEAT:
                inbox.put((kind, number, content))
            elif served:
                served[0].beat(number)
    inbox.put((Kind.CLOSE, 0, b""))


def _end(number: int, frame: object) -> None:
    """Handle SIGTERM: exit through the code that turns the device off."""
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit
