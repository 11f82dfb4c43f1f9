"""Horizon: codes of frames as they come, each decided with some of those after it in sight.

A window of frames is solved by tracks, its first frame the one handed out last, which stays. A third of the
others is decided; the rest is where the tracks of the next window begin. In trials that is as loud, within
three thousandths, as a window that moves frame by frame, in a quarter of the time.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, Solver
from .._support.arguments import real, refused
from ..path._piece import changing_pressures
from .ahead import Tracks, board_of
from .drives import coded
from .frames import AIR
from .request import Request

#: Points (M, 3) in m and targets (M,) in Pa.
Frame = tuple[NDArray[np.float64], NDArray[np.float64]]


class Horizon:
    """An iterator over codes (N,), `ahead` frames behind the frames that it is given.

    done, state : to go on, how many frames were handed out, and what `state` told then; `frames` begin
        with the last of them
    """

    def __init__(
        self,
        tracks: Tracks,
        frames: Iterator[Frame],
        ahead: int,
        done: int = 0,
        state: dict[str, Any] | None = None,
    ) -> None:
        self._tracks = tracks
        self._coming = frames
        # More frames than any list has are all of them.
        self._ahead = min(ahead, sys.maxsize >> 1)
        # The frame handed out last and those in sight; codes of the first of them, and how many stay.
        self._frames: list[Frame] = []
        self._codes: NDArray[np.uint16] | None = None if state is None else state["codes"]
        self._decided = 0 if state is None else int(state["decided"])
        self._done = done

    def __iter__(self) -> Iterator[NDArray[np.uint16]]:
        return self

    def __next__(self) -> NDArray[np.uint16]:
        held = min(self._done, 1)
        most = held + 1 + self._ahead
        self._frames += islice(self._coming, most - len(self._frames))
        if len(self._frames) == held:
            raise StopIteration
        if self._decided == held:
            self._codes = self._plan(held)
            last = len(self._frames) < most
            self._decided = len(self._frames) if last else held + 1 + self._ahead // 3
        assert self._codes is not None
        self._frames, self._codes = self._frames[held:], self._codes[held:]
        self._decided -= held
        self._done += 1
        found: NDArray[np.uint16] = self._codes[0]
        return found

    @property
    def frame(self) -> Frame:
        """The frame handed out last."""
        return self._frames[0]

    def state(self) -> dict[str, Any]:
        """What there is to know to go on, once a frame was handed out."""
        return {"codes": self._codes, "decided": self._decided}

    def _plan(self, held: int) -> NDArray[np.uint16]:
        points, targets = _table(self._frames)
        if self._codes is None:
            return self._tracks.find(points, targets)
        if not targets[0].any():
            # A silent frame binds nobody.
            rest = self._tracks.find(points[held:], targets[held:], first=self._done)
            return np.concatenate([self._codes[:held], rest])
        missing = len(points) - len(self._codes)
        start = np.concatenate([self._codes, np.repeat(self._codes[-1:], missing, axis=0)])
        return self._tracks.find(points, targets, start=start, first=self._done - held)


def _table(frames: list[Frame]) -> Frame:
    """Points (T, M, 3) and targets (T, M) of frames of M points at most; 0 for who is not there."""
    count = max(len(points) for points, _ in frames)
    points, targets = np.zeros((len(frames), count, 3)), np.zeros((len(frames), count))
    for frame, (places, asked) in enumerate(frames):
        points[frame, : len(places)], targets[frame, : len(places)] = places, asked
    return points, targets


def streamed(
    array: Array, frames: Iterable[Any], change: float, ahead: int, aim: str | None, options: dict[str, Any]
) -> Iterator[NDArray[np.complex64]]:
    """The drive (N,) of each of endless frames, points (M, 3) or pairs of points and pressures (M,)."""
    air = {name: options[name] for name in AIR if name in options}
    given = options.get("quantization")
    board = board_of(array.quantization if given is None else given)
    coming = (_read(array, air, frame) for frame in frames)
    for first in coming:
        tracks = Tracks(Scene(array, first[0], **air), change, board, lowered=aim != "max", coded=False)
        horizon = Horizon(tracks, chain([first], coming), ahead)
        for codes in horizon:
            points, targets = horizon.frame
            yield tracks.played(points[None], targets[None], codes[None])[0]


def _read(array: Array, air: dict[str, Any], frame: Any) -> Frame:
    """Points and targets of a frame; left out the balanced level."""
    points, pressures = read_frame(frame)
    if pressures is None:
        return points, np.full(len(points), Scene(array, points, **air).reach().level)
    return points, pressures


def read_frame(frame: Any) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Points (M, 3) and pressures (M,), if any, of a frame of a stream."""
    given, pressures = frame if isinstance(frame, tuple) and len(frame) == 2 else (frame, None)
    cure = "give points x 3 numbers in m, and pressures if any as the second of a pair"
    points = real("frame", given, cure)
    if points.ndim != 2 or points.shape[1] != 3 or not len(points):
        raise refused("frame", given, cure)
    return points, None if pressures is None else changing_pressures(pressures, 1, len(points))[0]


#: What a solver remembers of its last frame.
REMEMBERED = ("drives", "weights", "unevenness")


class Found(Protocol):
    """Finds frames in their order.

    board : the quantization of the drives, None for that of the array
    """

    board: dict[str, Any] | None

    def block(self, frames: slice) -> NDArray[Any]:
        """Drives or codes (frames, N) of the frames after those of the last block."""

    def state(self) -> dict[str, Any]:
        """What it has to know to go on after the last block."""

    def restore(self, done: int, state: dict[str, Any]) -> None:
        """Go on after the frame `done` - 1."""


class Followed:
    """By a solver, each frame from the last one; `exact` where its phases are the board's."""

    def __init__(self, asked: Request, solver: Solver, exact: bool) -> None:
        self.board: dict[str, Any] | None = asked.options.get("quantization")
        self._asked = asked
        self._solver = solver
        self._phases = asked.board.get("phases") if exact and asked.full else None

    def block(self, frames: slice) -> NDArray[Any]:
        drives = self._solver.follow(self._asked.points[frames], self._asked.targets[frames])
        return drives if self._phases is None else coded(drives, self._phases)

    def state(self) -> dict[str, Any]:
        last = self._solver.last()
        return {} if last is None else dict(zip(REMEMBERED, last, strict=True))

    def restore(self, done: int, state: dict[str, Any]) -> None:
        if state:
            self._solver.restore(state["drives"], state["weights"], float(state["unevenness"]))


class Foreseen:
    """By tracks, each frame with some of the next in sight."""

    def __init__(self, asked: Request, tracks: Tracks, ahead: int) -> None:
        self.board: dict[str, Any] | None = tracks.board
        self._asked = asked
        self._tracks = tracks
        self._ahead = ahead
        self._horizon = Horizon(tracks, zip(asked.points, asked.targets, strict=True), ahead)

    def block(self, frames: slice) -> NDArray[Any]:
        points, targets = self._asked.points[frames], self._asked.targets[frames]
        return self._tracks.played(points, targets, np.stack(list(islice(self._horizon, len(points)))))

    def state(self) -> dict[str, Any]:
        return self._horizon.state()

    def restore(self, done: int, state: dict[str, Any]) -> None:
        rest = zip(self._asked.points[done - 1 :], self._asked.targets[done - 1 :], strict=True)
        self._horizon = Horizon(self._tracks, rest, self._ahead, done, state)
