"""Plays points that another program sends while the board plays."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._boards.connection import Connection
from .._boards.errors import BoardError
from .._boards.transport import before_what_computes
from .._boards.wire import Kind
from .._midair import Scene, SceneError
from .._motion import stream
from .._support.arguments import number
from ..path import Path

#: Largest number of points in a frame; time in s without a message from the sender after which the board
#: turns off.
MOST_POINTS, SILENCE = 256, 0.2

#: Number of places along a path that are checked before it is played.
LOOKED = 16

#: Time in s between two keep-alive messages to the board while the frame does not change.
REST = 0.05


class Frame(NamedTuple):
    """Points (M, 3) in m; pressures (M,) in Pa, None for as loud as possible; and a factor for the drive."""

    points: NDArray[np.float64]
    pressures: NDArray[np.float64] | None = None
    loudness: float = 1.0


@dataclass
class Wanted:
    """Frames to play: a function that returns the frame at a time in s since the start, or None at the end.

    constant : whether all frames are the same
    change : largest change of a phase in rad per frame, used if `Live` has no bound of its own
    """

    at: Callable[[float], Frame | None]
    constant: bool = False
    change: float | None = None


class Live:
    """Plays the newest points on a board; turns the board off if the sender sends no sign of life."""

    def __init__(
        self, connection: Connection, rate: float | None = None, change: float | None = None
    ) -> None:
        self.connection = connection
        most = connection.board.rate
        self.rate = most if rate is None else min(number("rate", rate, above=0), most)
        self._change = change
        self._news = threading.Condition()
        self._wanted: Wanted | None = None
        self._begun = self._signed = -math.inf
        self._ended = False
        self._error: str | None = None
        self._played: tuple[Frame, NDArray[np.complex64]] | None = None
        self._delay = 0.0
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def place(self, points: NDArray[np.float64], pressures: NDArray[np.float64] | None = None) -> None:
        """Play points (M, 3) in m, with pressures (M,) in Pa or as loud as possible.

        Raises SceneError for invalid points, BoardError if the board is gone.
        """
        if len(points) > MOST_POINTS:
            raise SceneError(f"points are {len(points)}: give {MOST_POINTS} at most")
        Scene(self.connection.board.array, points, 1.0 if pressures is None else pressures)
        self.play(Wanted(lambda time: Frame(points, pressures), constant=True))

    def follow(self, path: Path) -> None:
        """Play a path: a closed path repeats, the end of an open path stays.

        Raises SceneError for more points than a frame can have, BoardError if the board is gone.
        """
        if path.points > MOST_POINTS:
            raise SceneError(f"path has {path.points} points: give {MOST_POINTS} at most")
        looked = np.linspace(0, path.duration, LOOKED)
        for points in path.at(looked):
            Scene(self.connection.board.array, points)

        def wanted(time: float) -> Frame:
            at = [time % path.duration if path.closed else min(time, path.duration)]
            return Frame(path.at(at)[0], path.targets(at)[0] if path.pascals else None)

        self.play(Wanted(wanted))

    def play(self, wanted: Wanted) -> None:
        """Play the frames of `wanted` from now on, instead of the earlier ones."""
        with self._news:
            self._wanted, self._error = wanted, None
            self._begun = self._signed = time.monotonic()
            self._news.notify()

    def keep(self) -> None:
        """Record a sign of life from the sender."""
        with self._news:
            self._signed = time.monotonic()

    def off(self) -> None:
        """Turn the board off until new points come. Raises BoardError if the board is gone."""
        with self._news:
            self._wanted = None
            self._news.notify()
        self.connection.off()

    @property
    def error(self) -> str | None:
        """The error that ended the last playback, None if there was none."""
        return self._error

    def state(self) -> dict[str, Any]:
        """Return the board's state, its counts of frames, and the error that ended the last playback."""
        stats = self.connection.stats
        counts = {"frames": stats.frames, "late": stats.late, "lapses": stats.lapses}
        return {"state": self.connection.state, **counts, "error": self._error}

    def metrics(self) -> dict[str, Any]:
        """Return the state, and the last frame's points in m, |p| at them in Pa, and delay in ms."""
        points: list[list[float]] = []
        reached: list[float] = []
        if self._wanted is not None and (played := self._played) is not None:
            board = self.connection.board
            emitted = board.decode(board.encode(played[1]))
            gains = Scene(board.array, played[0].points).propagation()
            points, reached = played[0].points.tolist(), np.abs(gains @ emitted).tolist()
        return {**self.state(), "points": points, "pressures": reached, "delay": 1e3 * self._delay}

    def close(self) -> None:
        """Stop playing and turn the board off; the connection stays open."""
        with self._news:
            self._ended, self._wanted = True, None
            self._news.notify()
        self._thread.join(1.0)
        with suppress(BoardError):
            self.connection.off()

    def _lives(self) -> bool:
        return self._wanted is not None and time.monotonic() - self._signed < SILENCE

    def _run(self) -> None:
        before_what_computes()
        while not self._ended:
            with self._news:
                self._news.wait_for(lambda: self._ended or self._lives())
            try:
                self._stream()
                with self._news:
                    if self._lives():
                        continue
                    # Later signs of life must not restart these points.
                    self._wanted = None
                self.connection.off()
            # An error of any kind ends the playback of the present points only; later points are played.
            except Exception as error:
                with self._news:
                    self._wanted, self._error = None, str(error)
                with suppress(BoardError):
                    self.connection.off()

    def _stream(self) -> None:
        """Play frames with one bound of phase change, until nothing is left to play or the bound changes."""
        if (wanted := self._wanted) is None:
            return
        board, period = self.connection.board, 1 / self.rate
        change = wanted.change if self._change is None else self._change
        frames: list[Frame] = []
        due = time.monotonic()
        last: bytes | None = None
        for drive in stream(board.array, self._frames(wanted.change, frames), rate=self.rate, change=change):
            if (playing := self._wanted) is None or not self._lives():
                return
            frame = frames.pop()
            # Most frames have a loudness of 1; no copy is made for them.
            played = drive if frame.loudness == 1 else drive * np.float32(frame.loudness)
            code = board.encode(played)
            self._played = frame, played
            if code == last and playing.constant:
                self._rest(playing)
                due = time.monotonic()
                continue
            self.connection.send(played)
            last, now = code, time.monotonic()
            self._delay = now - due
            # After a late frame the following ones are due later, too.
            due = max(due + period, now - period)
            time.sleep(max(0.0, due - now))

    def _rest(self, playing: Wanted) -> None:
        """Wait for other points while a constant frame plays, and send the board keep-alive messages."""
        while self._wanted is playing and self._lives() and not self._ended:
            with self._news:
                left = self._signed + SILENCE - time.monotonic()
                other = self._news.wait_for(lambda: self._wanted is not playing, min(max(left, 0), REST))
            if not other:
                self.connection._call(Kind.HOLD)

    def _frames(self, change: float | None, frames: list[Frame]) -> Iterator[Any]:
        """Yield the points and pressures for `midair.stream`, and append the whole frames to `frames`."""
        while (wanted := self._wanted) is not None and wanted.change == change and self._lives():
            frame = wanted.at(time.monotonic() - self._begun)
            if frame is None:
                with self._news:
                    if self._wanted is wanted:
                        self._wanted = None
                return
            frames.append(frame)
            yield frame.points if frame.pressures is None else (frame.points, frame.pressures)
