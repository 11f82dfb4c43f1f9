"""Guard: the process that owns a device, and turns it off when its owner ends, hangs or requests it.

The guard notices the end of its owner by the end of the pipe between them, and by its parent's number,
which changes even if a forked child of the owner keeps the pipe open. It checks if its owner is stopped, and
notices missing beats of an owner that hangs in foreign code. Its own session protects it from the end of the
owner's terminal.
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

#: Time between two checks of the owner, in s.
TICK = 0.02

#: Time between two checks that an idle, playing device is still there, in s.
LOOK = 0.25

#: Time in s that the guard may work with its device before its owner assumes that it hangs.
BUSY = {Kind.UPLOAD: 10.0, Kind.MODULATE: 10.0}

Message = tuple[Kind, int, bytes]


@dataclass(frozen=True)
class Waiting:
    """A frame that waits for its time; `number` is that of its message."""

    due: float
    latest: float
    late: Late
    number: int
    frame: bytes


class Guard:
    """State of the guard: the transport, the playing frame, and the time since the last call.

    Parameters
    ----------
    hold
        S without a call after which everything is turned off.
    parent
        The number of the owner's process.
    inbox, replies
        Source of messages, and the pipe for answers.
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
        """Serve until the owner closes or is gone."""
        before_what_computes()
        while os.getppid() == self._parent:
            # All messages are read before the next frame is played: "off" and newer frames overtake older
            # ones.
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
        """Note that the owner lives, and answer unless the device blocks the guard; in any thread."""
        self._beaten = now = time.monotonic()
        if now < self._until:
            self._answer(Kind.DONE, number, b"")

    def _come(self) -> list[Message]:
        """Return the messages that arrived, after a pause."""
        found, self._put_by = self._put_by, []
        with suppress(Empty):
            found.append(self._inbox.get(timeout=0 if found else self._pause()))
        return found + self._more()

    def _more(self) -> list[Message]:
        """Return the messages that have already arrived."""
        found = []
        with suppress(Empty):
            while True:
                found.append(self._inbox.get_nowait())
        return found

    def _pause(self) -> float:
        """Time in s until the guard has work, if no message comes."""
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
        """Call the device, and answer with the result; number 0 is no call of an owner."""
        try:
            act(*arguments)
        except BoardError as error:
            self._lost |= type(error) is not BoardError
            self._fail(number, error)
        # Any error of the device's library.
        except Exception as error:
            self._lost = True
            self._fail(number, BoardLost(f"the link failed ({named(error)}): connect again"))
        else:
            self._answer(Kind.DONE, number, self.status())

    def _fail(self, number: int, error: BoardError) -> None:
        """Answer that a call failed, and with it all earlier calls whose result was unknown; turn off."""
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
        """Play the first waiting frame, unless it is too late."""
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
        # The device may play the frame although the line failed behind it.
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
        """The frame that plays now; for an uploaded sequence by the clock."""
        if not self._playing:
            return b""
        begin, rate = self._uploaded
        return self._playing[int((time.monotonic() - begin) * rate) % len(self._playing)]

    def status(self, **more: str) -> bytes:
        """Status for the owner, as JSON."""
        playing = "off" if not self._playing else "playing" if self._wave is None else "modulating"
        state = "lost" if self._lost else playing
        reported = {"state": state, "frames": self._frames, "late": self._late, "lapses": self._lapses}
        return json.dumps(reported | more).encode()

    def _answer(self, kind: Kind, number: int, content: bytes) -> None:
        # Number 0 is no call of an owner; `run` notices an owner that is gone.
        if number:
            with suppress(wire.Gone), self._lock:
                wire.write(self._replies, kind, number, content)


def main() -> None:
    """Open the device of the first message, serve its owner, and turn the device off."""
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
    # Any error of a device's library when it opens the device.
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
    """The pipes from and to the owner, hidden from libraries that print or read."""
    requests, replies = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    return requests, replies


def _reported(error: Exception) -> dict[str, str]:
    """Error for the owner, in one line; the name is added if it is not one of the boards' own."""
    text = str(error) if isinstance(error, BoardError | ImportError) else named(error)
    return {"kind": type(error).__name__, "message": " ".join(text.split())}


def _listen(requests: int, inbox: SimpleQueue[Message], served: list[Guard]) -> None:
    """Pass beats to the guard at once, other messages to the inbox, and close when the owner is gone."""
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
    """SIGTERM: end through the code that turns the device off."""
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit
