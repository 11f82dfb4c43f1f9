"""Guard: the process that owns a device, and turns it off when its owner (the user's program) ends or hangs.

The guard detects the owner's end in two ways. The pipe between them closes. Or the guard's parent number
changes, even if a forked child of the owner keeps the pipe open. The guard also checks whether the owner is
stopped, and counts missing beats of an owner that hangs in native code. It runs in a session of its own, so
closing the owner's terminal does not end it.
"""

from __future__ import annotations

import json
import math
import os
import signal
import sys
import threading
import time
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any

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


@dataclass(frozen=True)
class Waiting:
    """A frame that waits until it is due. `number` is the number of the message that sent it."""

    due: float
    latest: float
    late: Late
    number: int
    frame: bytes


class Guard:
    """State of the guard: the transport, the playing frame, and the time of the last call.

    Parameters
    ----------
    hold
        Time in s without a call after which everything is turned off.
    parent
        Process number of the owner.
    inbox, replies
        Queue of messages from the owner, and the pipe for answers.
    """

    def __init__(
        self, transport: Transport, hold: float, parent: int, inbox: SimpleQueue[Message], replies: int
    ) -> None:
        self._transport = transport
        self._hold = hold
        self._parent = parent
        self._stops = Stops(parent)
        self._inbox = inbox
        self._replies = replies
        self._waiting: deque[Waiting] = deque()
        self._put_by: list[Message] = []
        self._called = time.monotonic()
        self._wave: float | bytes | None = None
        self._playing: list[bytes] = []
        self._uploaded = (0.0, 1.0)
        self._lost = False
        self._beaten = time.monotonic()
        self._until = math.inf
        self._looked = 0.0
        self._lock = threading.Lock()
        self._frames = 0
        self._late = 0
        self._lapses = 0

    def run(self) -> None:
        """Execute messages until the owner closes the connection or is gone."""
        before_what_computes()
        while os.getppid() == self._parent:
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
            now = time.monotonic()
            missed = now - self._beaten >= wire.MISSED or (not came and self._stops.look())
            if self._playing and (missed or now - self._called >= self._hold):
                self._lapses += 1
                self._attempt(0, self._off)
            elif self._playing and not self._waiting and now - self._looked >= LOOK:
                self._looked = now
                self._attempt(0, self._transport.look)

    def beat(self, number: int) -> None:
        """Record that the owner (the user's program) lives. Answer unless the device blocks the guard.

        May run in any thread.
        """
        self._beaten = now = time.monotonic()
        if now < self._until:
            self._answer(Kind.DONE, number, b"")

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
        now = time.monotonic()
        due = self._waiting[0].due if self._waiting else math.inf
        return max(0.0, min(TICK, due - now, self._called + self._hold - now if self._playing else math.inf))

    def _serve(self, kind: Kind, number: int, content: bytes) -> None:
        if kind not in (Kind.STATUS, Kind.EMITTING):
            self._called = time.monotonic()
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
            self._answer(Kind.FRAME, number, self._now())
        else:
            self._answer(Kind.DONE, number, self.status())

    def _attempt(self, number: int, act: Any, *arguments: Any) -> None:
        """Call the device and answer with the result. Number 0 marks the guard's own calls: no answer."""
        try:
            act(*arguments)
        except BoardError as error:
            self._lost |= type(error) is not BoardError
            self._fail(number, error)
        # A device's library may raise errors of any kind.
        except Exception as error:
            self._lost = True
            self._fail(number, BoardLost(f"the link failed ({named(error)}): connect again"))
        else:
            self._answer(Kind.DONE, number, self.status())

    def _fail(self, number: int, error: BoardError) -> None:
        """Answer a failed call, and all calls whose frames still wait, with an error; turn everything off."""
        reported = _reported(error)
        for message in self._more():
            if message[0] == Kind.PLAY:
                self._serve(*message)
            else:
                self._put_by.append(message)
        failed, self._waiting, self._playing = self._waiting, deque(), []
        for each in (number, *(other.number for other in failed)):
            self._answer(Kind.FAILED, each, self.status(**reported))
        with suppress(Exception):
            self._transport.silence()

    def _play_next(self) -> None:
        """Play the first waiting frame; if it is late, wait, skip it or report an error as requested."""
        first, now = self._waiting.popleft(), time.monotonic()
        if first.late == Late.SKIP and self._waiting and self._waiting[0].due <= now:
            self._late += 1
            self._answer(Kind.DONE, first.number, self.status())
        elif first.late == Late.ERROR and now > first.latest:
            self._late += 1
            self._fail(first.number, BoardTimeout(wire.LATE.format(1e3 * (now - first.due))))
        else:
            self._attempt(first.number, self._play, first.frame)

    def _play(self, frame: bytes) -> None:
        # The frame is recorded first, because the device may play it even if the link then fails.
        self._playing, self._uploaded = [frame], (0.0, 1.0)
        self._transport.play(frame)
        self._frames += 1
        self._lost = False

    def _upload(self, frames: bytes, count: int, rate: float) -> None:
        length = len(frames) // count
        self._playing = [frames[k : k + length] for k in range(0, len(frames), length)]
        self._uploaded = (time.monotonic(), rate)
        self._transport.upload(frames, count, rate)
        self._frames += count
        self._lost = False

    def _modulate(self, wave: float | bytes | None) -> None:
        self._transport.modulate(wave)
        self._wave = wave

    def _off(self) -> None:
        """Turn everything off; drop waiting frames."""
        dropped, self._waiting, self._playing = self._waiting, deque(), []
        try:
            self._transport.silence()
        finally:
            for each in dropped:
                self._answer(Kind.DONE, each.number, self.status())

    def _now(self) -> bytes:
        """Return the frame that plays now, empty if none does. In an upload, the elapsed time gives it."""
        if not self._playing:
            return b""
        begin, rate = self._uploaded
        return self._playing[int((time.monotonic() - begin) * rate) % len(self._playing)]

    def status(self, **more: str) -> bytes:
        """Return the status for the owner, as JSON."""
        playing = "off" if not self._playing else "playing" if self._wave is None else "modulating"
        state = "lost" if self._lost else playing
        reported = {"state": state, "frames": self._frames, "late": self._late, "lapses": self._lapses}
        return json.dumps(reported | more).encode()

    def _answer(self, kind: Kind, number: int, content: bytes) -> None:
        # Number 0 needs no answer. `run` detects an owner that is gone.
        if number:
            with suppress(wire.Gone), self._lock:
                wire.write(self._replies, kind, number, content)


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
        guard = Guard(transport, setting["hold"], parent, inbox, replies)
        served.append(guard)
        watch.begin({name: setting[name] for name in ("path", "transport")})
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
