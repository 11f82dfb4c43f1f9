"""Plays the points that other programs send, and keeps the board off while no program sends any."""

import math
import re
import threading
import time
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import Future, InvalidStateError
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._boards.connection import Connection
from .._boards.errors import BoardError, BoardLost
from .._boards.transport import before_what_computes
from .._midair import Scene, stated
from .._sequence import stream
from .._support.arguments import frame_rate, number, warn, warnings_to
from ..path import Path
from .life import Life

#: Largest number of points in a frame.
MOST_POINTS = 256

#: Number of places along a path that are checked before it is played, and its shortest duration in s.
LOOKED, LEAST_DURATION = 16, 1e-3

#: Time in s between two keep-alive messages to the board while it gets no new frame.
REST = 0.05

#: Bound of phases in rad/s unless another is given: pi/16 a frame at 10 kHz, which transducers follow. A slow
#: board needs all of it, because a hand moves far between two of its frames.
CHANGE_RATE = math.pi / 16 * 10e3

#: Time in s within which a client gets a warning of one kind once.
AGAIN = 1.0

#: Longest time in s that a caller waits until the board is off.
PATIENCE = 1.0


class Frame(NamedTuple):
    """Points (M, 3) in m; pressures (M,) in Pa, None for as loud as possible; and a factor for the drive."""

    points: NDArray[np.float64]
    pressures: NDArray[np.float64] | None = None
    loudness: float = 1.0


@dataclass(eq=False)
class Wanted:
    """Frames to play: a function that returns the frame at a time in s since the start, or None at the end.

    source : who sent them
    constant : whether all frames are the same
    change : largest change of a phase in rad per frame, used if `Live` has no bound of its own
    """

    source: Hashable
    at: Callable[[float], Frame | None]
    constant: bool = False
    change: float | None = None


class Live:
    """Plays the newest points on a board while their source gives signs of life; otherwise the board is off.

    Its methods may be called in any thread.

    Parameters
    ----------
    connection
        The board. `close` closes this connection.
    rate
        Frames per second, at most the board's own rate, which is the default.
    change
        Largest change of a phase in rad per frame; by default that of the points, or CHANGE_RATE.
    again
        Connects to the board again if it is lost. Without it, or if it fails, `wait` raises the error.
    """

    def __init__(
        self,
        connection: Connection,
        rate: float | None = None,
        change: float | None = None,
        again: Callable[[], Connection] | None = None,
    ) -> None:
        most = connection.board.rate
        self.rate = most if rate is None else min(frame_rate(rate), most)
        self._change = None if change is None else number("change", change, above=0)
        self.connection = connection
        #: The last error of a playback, and the source of its points; None once others play.
        self.failed: tuple[Hashable, str] | None = None
        #: Called with the source of points that caused a warning, and its text.
        self.warned: Callable[[Hashable, str], object] = lambda source, text: None
        self._noted: dict[tuple[Hashable, str], float] = {}
        self._again = again
        self._wave: Any = None
        # The condition protects what follows, and is notified of changes.
        self._news = threading.Condition()
        self._life = Life()
        self._wanted: Wanted | None = None
        self._begun = -math.inf
        #: Whether the board is off for certain: nothing was sent to it since it was switched off.
        self._dark = True
        #: Done when nothing will play any more; with the error if the board is lost.
        self._over: Future[None] = Future()
        # The thread below alone writes what follows.
        self._current: Wanted | None = None
        self._played: tuple[Frame, NDArray[np.complex64]] | None = None
        self._delay, self._late = 0.0, 0
        self._kept = -math.inf
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def place(
        self, source: Hashable, points: NDArray[np.float64], pressures: NDArray[np.float64] | None = None
    ) -> None:
        """Play points (M, 3) in m, with pressures (M,) in Pa or as loud as possible.

        Raises SceneError for invalid points.
        """
        if len(points) > MOST_POINTS:
            raise stated("points", f"are {len(points)}", f"give {MOST_POINTS} at most")
        Scene(self.connection.board.array, points, 1.0 if pressures is None else pressures)
        self.play(Wanted(source, lambda time: Frame(points, pressures), constant=True))

    def follow(self, source: Hashable, path: Path) -> None:
        """Play a path: a closed path repeats, the end of an open path stays.

        Raises SceneError for more points than a frame can have, and for points that cannot be played.
        """
        if path.points > MOST_POINTS:
            raise stated("path", f"has {path.points} points", f"give {MOST_POINTS} at most")
        number("path.duration", path.duration, least=LEAST_DURATION)
        for points in path.at(np.linspace(0, path.duration, LOOKED)):
            Scene(self.connection.board.array, points)

        def at(time: float) -> Frame:
            when = [time % path.duration if path.closed else min(time, path.duration)]
            return Frame(path.at(when)[0], path.targets(when)[0] if path.pascals else None)

        self.play(Wanted(source, at))

    def play(self, wanted: Wanted, *, tracked: bool = False) -> None:
        """Play these frames from now on instead of the earlier ones, unless their source is silent.

        `tracked` means that the points follow a hand.
        """
        now = time.monotonic()
        with self._news:
            if self._life.play(wanted.source, now, tracked=tracked):
                self._wanted, self._begun, self.failed = wanted, now, None
                self._news.notify_all()

    def note(self, source: Hashable, text: str) -> None:
        """Pass on a warning about points of a source, and show it; each kind at most once in a while."""
        now, kind = time.monotonic(), (source, re.sub(r"[\d.e+-]+", "", text))
        self._noted = {kind: at for kind, at in self._noted.items() if now < at + AGAIN}
        if self._noted.setdefault(kind, now) == now:
            self.warned(source, text)
            warn(text)

    def modulate(self, wave: float | ArrayLike | None) -> None:
        """Modulate all drives, also after the board was lost and connected again."""
        self.connection.modulate(wave)
        self._wave = wave

    @contextmanager
    def life(self) -> Iterator[Life]:
        """Lend the signs of life to one thread, and act on what it has changed."""
        with self._news:
            yield self._life
            self._news.notify_all()

    def off(self) -> None:
        """Turn the board off until new points come; wait until it is off."""
        with self._news:
            self._life.off()
            self._dark = False
            self._news.notify_all()
            self._news.wait_for(lambda: self._dark or self._over.done() or self._life.player is not None, PATIENCE)

    def state(self) -> dict[str, Any]:
        """Return the board's state, its counts of frames, and the error that ended the last playback."""
        stats, failed = self.connection.stats, self.failed
        counts = {"frames": stats.frames, "late": self._late, "lapses": stats.lapses}
        return {"state": self.connection.state, **counts, "error": None if failed is None else failed[1]}

    def metrics(self) -> dict[str, Any]:
        """Return the state, and the last frame's points in m, |p| at them in Pa, and delay in ms."""
        points: list[list[float]] = []
        reached: list[float] = []
        if not self._dark and (played := self._played) is not None:
            board = self.connection.board
            emitted = board.decode(board.encode(played[1]))
            gains = Scene(board.array, played[0].points).propagation()
            points, reached = played[0].points.tolist(), np.abs(gains @ emitted).tolist()
        return {**self.state(), "points": points, "pressures": reached, "delay": 1e3 * self._delay}

    def wait(self) -> None:
        """Wait until the board is lost and cannot be connected again; raise the error."""
        self._over.result()

    def close(self) -> None:
        """Turn the board off and close the connection."""
        self._end()
        self._thread.join(PATIENCE)
        self.connection.close()

    def _end(self, lost: Exception | None = None) -> None:
        with self.life() as life, suppress(InvalidStateError):
            life.off()
            if lost is None:
                self._over.set_result(None)
            else:
                self._over.set_exception(lost)

    def _left(self) -> float:
        """Return the time in s for which the points may play without another sign of life; 0: off."""
        return self._life.left(time.monotonic())

    def _alive(self) -> Wanted | None:
        """Return what may play now."""
        with self._news:
            return self._wanted if self._left() else None

    def _run(self) -> None:
        before_what_computes()
        while not self._over.done():
            with self._news:
                self._news.wait_for(lambda: self._over.done() or not self._dark or self._left())
            try:
                with warnings_to(lambda text: self.note(self._current and self._current.source, text)):
                    self._stream()
                if self._alive() is None:
                    self._darken()
            # An error of any kind ends the playback of the present points only; later points are played.
            except Exception as error:
                self._recover(error)

    def _darken(self) -> None:
        try:
            self.connection.off()
        except BoardError:
            # Nothing goes faster than the next attempt.
            time.sleep(REST)
            raise
        with self._news:
            self._dark = True
            self._news.notify_all()

    def _recover(self, error: Exception) -> None:
        """End the playback that failed. If the board is lost, connect again; if that fails, end."""
        with self._news:
            source = None if self._current is None else self._current.source
            self.failed = source, str(error)
            if self._wanted is self._current:
                self._life.off()
        if isinstance(error, BoardLost):
            try:
                if self._again is None:
                    raise error
                self.connection.close()
                self.connection = self._again()
                if self._wave is not None:
                    self.connection.modulate(self._wave)
            # A device's library may raise errors of any kind.
            except Exception as lost:
                self._end(lost)

    def _stream(self) -> None:
        """Play frames with one bound of phase change, until nothing is left to play or the bound changes."""
        if (wanted := self._alive()) is None:
            return
        board, period = self.connection.board, 1 / self.rate
        change = self._change or wanted.change or min(CHANGE_RATE / self.rate, math.pi)
        frames: list[Frame] = []
        due = time.monotonic()
        last: bytes | None = None
        for drive in stream(board.array, self._frames(wanted.change, frames), rate=self.rate, change=change):
            frame, playing = frames.pop(), self._current
            # Most frames have a loudness of 1; no copy is made for them.
            played = drive if frame.loudness == 1 else drive * np.float32(frame.loudness)
            code = board.encode(played)
            with self._news:
                if not self._left():
                    return
                self._dark = False
            self._played = frame, played
            resting = playing is not None and playing.constant and code == last
            if not resting:
                self.connection.send(played)
                last, now = code, time.monotonic()
                self._kept, self._delay = now, now - due
                self._late += self._delay > 2 * period
                # After a late frame the following ones are due later, too.
                due = max(due + period, now - period)
            if not self._pause(math.inf if resting else due, playing):
                last = None
            if resting:
                due = time.monotonic()

    def _pause(self, until: float, playing: Wanted | None) -> bool:
        """Wait until a time, without end for points at rest: then other points end the wait.

        Sends the board keep-alive messages meanwhile. Returns False if the board has gone off by itself.
        """
        while True:
            now = time.monotonic()
            if now >= self._kept + REST:
                self._kept = now
                if not self.connection._keep():
                    return False
            with self._news:
                wait = min(until, self._kept + REST) - now
                over = self._news.wait_for(
                    lambda: not self._left() or (until == math.inf and self._wanted is not playing),
                    min(wait, self._left()),
                )
            if over or time.monotonic() >= until:
                return True

    def _frames(self, change: float | None, frames: list[Frame]) -> Iterator[Any]:
        """Yield the points and pressures for `midair.stream`, and append the whole frames to `frames`."""
        while (wanted := self._alive()) is not None and wanted.change == change:
            self._current = wanted
            frame = wanted.at(time.monotonic() - self._begun)
            if frame is None:
                with self._news:
                    if self._wanted is wanted:
                        self._life.off()
                return
            frames.append(frame)
            yield frame.points if frame.pressures is None else (frame.points, frame.pressures)
