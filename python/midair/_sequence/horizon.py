"""Receding horizon: solves the phase codes of frames in windows that include some later frames.

A window begins with the frame that was returned last, whose codes are fixed. After each solve, a third of the
other frames becomes final. The rest is the initial guess for the next window. In trials this was as loud,
within 0.3 %, as a window that advances by one frame, in a quarter of the time. A track is the phase of a
transducer over all frames of a window. The core solves the tracks; amplitudes then reduce the pressures to
the targets.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, SceneError, Solver, look, numbers, restated, stated, stiffen, tracks
from .._support.arguments import refused
from ..path._frames import changing_pressures
from .drives import Drives, coded, lowered, narrow, sounding
from .frames import AIR
from .propagation import pressures
from .request import Request

#: Number of phases that is used for a board that can play any phase.
PHASES = 256

#: Iterations of tracks, point phases and weights. After ten, the level grows by less than 0.1 % per
#: iteration.
ROUNDS = 10

#: Iterations for a closed curve, which repeats: up to 0.2 % louder than after ten.
ROUNDS_CLOSED = 20

#: Iterations if the initial guess is known from the last window.
ROUNDS_MORE = 5


@dataclass(frozen=True)
class Tracks:
    """Solves tracks (a transducer's phase codes over the frames of a window), and converts codes to drives.

    Attributes
    ----------
    scene
        The array and its air.
    change
        Largest change of a phase, in rad per frame.
    board
        The board's quantization, with "phases".
    lowered
        Whether amplitudes reduce the pressures to the targets.
    coded
        Whether all amplitudes are 1, so that the codes are the whole result.
    """

    scene: Scene
    change: float
    board: dict[str, Any]
    lowered: bool
    coded: bool

    def find(
        self,
        points: NDArray[np.float64],
        targets: NDArray[np.float64],
        *,
        closed: bool = False,
        start: NDArray[np.uint16] | None = None,
        first: int = 0,
        progress: Callable[[int, int], object] | None = None,
    ) -> NDArray[np.uint16]:
        """Return codes (T, N) for points (T, M, 3) and targets (T, M).

        Parameters
        ----------
        start
            Codes (T, N) as the initial guess. Those of the first frame stay as they are.
        first
            Number of frames before these, added to the frame numbers in errors.
        """
        if not (targets > 0).any():
            still = np.zeros((1, len(self.scene.array)), np.uint16) if start is None else start[:1]
            return np.repeat(still, len(points), axis=0)
        if len(points) == 1:
            # The core needs two frames: a single one is solved as a point at rest.
            twice = [np.repeat(table, 2, axis=0) for table in (points, targets)]
            return self.find(*twice, first=first, progress=progress)[:1]
        rounds = ROUNDS_CLOSED if closed else ROUNDS
        try:
            return tracks(
                self.scene,
                points,
                targets,
                change=self.change,
                phases=self.board["phases"],
                closed=closed,
                rounds=rounds if start is None else ROUNDS_MORE,
                start=start,
                progress=None if progress is None else lambda step, steps, _: progress(step, steps),
            )
        except SceneError as error:
            if error.index is None:
                raise
            # The item is points[t, j] or targets[t, j].
            item = error.item.replace(f"[{error.index}", f"[{error.index + first}", 1)
            raise restated(error, item=item, index=error.index + first) from None

    def stiffened(
        self,
        points: NDArray[np.float64],
        codes: NDArray[np.uint16],
        rate: float,
        *,
        closed: bool,
        progress: Callable[[int, int], object] | None = None,
    ) -> NDArray[np.uint16]:
        """Return codes (T, N) of stiff traps that carry their beads at `rate` frames per second."""
        return stiffen(
            self.scene,
            points,
            codes,
            change=self.change,
            phases=self.board["phases"],
            closed=closed,
            rate=rate,
            margin=look(rate),
            progress=None if progress is None else lambda step, steps, _: progress(step, steps),
        )

    def played(
        self, points: NDArray[np.float64], targets: NDArray[np.float64], codes: NDArray[np.uint16]
    ) -> NDArray[Any]:
        """Return the codes if all amplitudes are 1, else drives (T, N), 0 in frames without points."""
        if self.coded:
            return narrow(codes, self.board["phases"])
        full = Drives(codes, sounding(self.scene.array), self.board["phases"])
        over = np.zeros(len(targets))
        if self.lowered:
            got = pressures(self.scene, points, full)
            with np.errstate(divide="ignore", invalid="ignore"):
                over = np.where(targets > 0, got / targets, 0).max(axis=1)
        part = np.where((targets > 0).any(axis=1), 1 / np.maximum(over, 1), 0)
        if self.board.get("amplitudes") is not None:
            part = lowered(part, self.board["amplitudes"])
        return full[:] * part[:, None].astype(np.float32)


def board_of(quantization: dict[str, Any] | None) -> dict[str, Any]:
    """Return the quantization of the board for tracks: the given one, with "phases" added if it has none."""
    board = dict(quantization or {})
    return {**board, "phases": board.get("phases") or PHASES}


def check(solver: str, tau: Any, aim: Any, options: Iterable[str]) -> None:
    """Reject arguments that cannot be combined with `ahead`, that is, with tracks."""
    if solver != "glide":
        raise refused("solver", solver, "with ahead the tracks are found by themselves, leave it out")
    if tau is not None:
        raise refused("tau", tau, "with ahead the tracks take no account of it: leave out tau, or ahead")
    if aim not in (None, "target", "max"):
        raise refused("aim", aim, 'give "target" or "max"')
    if unknown := set(options) - {"quantization"}:
        raise stated(
            f"{min(unknown)}", "is given", "with ahead there is no such option, leave it out", code="conflict"
        )


#: Points (M, 3) in m and targets (M,) in Pa of a frame.
Frame = tuple[NDArray[np.float64], NDArray[np.float64]]


class Horizon:
    """An iterator over the codes (N,) of frames. It reads up to `ahead` frames more than it has returned.

    Parameters
    ----------
    done, state
        To continue an earlier solve: number of frames already returned, and its `state()`. `frames` then
        begins with the last of these.
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
        # `islice` accepts no larger number, and no list is that long.
        self._ahead = min(ahead, sys.maxsize >> 1)
        # `_frames`: the frame returned last and those read after it. `_codes`: codes of the first of them.
        # `_decided`: how many of these codes are final.
        self._frames: list[Frame] = []
        self._codes: NDArray[np.uint16] | None = None if state is None else state["codes"]
        self._decided = 0 if state is None else int(state["decided"])
        self._done = done

    def __iter__(self) -> Iterator[NDArray[np.uint16]]:
        return self

    def __next__(self) -> NDArray[np.uint16]:
        kept = min(self._done, 1)
        most = kept + 1 + self._ahead
        self._frames += islice(self._coming, most - len(self._frames))
        if len(self._frames) == kept:
            raise StopIteration
        if self._decided == kept:
            self._codes = self._plan(kept)
            last = len(self._frames) < most
            self._decided = len(self._frames) if last else kept + 1 + self._ahead // 3
        assert self._codes is not None
        self._frames, self._codes = self._frames[kept:], self._codes[kept:]
        self._decided -= kept
        self._done += 1
        found: NDArray[np.uint16] = self._codes[0]
        return found

    @property
    def frame(self) -> Frame:
        """The frame that was returned last."""
        return self._frames[0]

    def state(self) -> dict[str, Any]:
        """Return the data from which a later solve can continue after this frame."""
        return {"codes": self._codes, "decided": self._decided}

    def _plan(self, kept: int) -> NDArray[np.uint16]:
        points, targets = _table(self._frames)
        if self._codes is None:
            return self._tracks.find(points, targets)
        if not targets[0].any():
            # A silent frame does not limit the phases of the next one, so the rest is solved independently.
            rest = self._tracks.find(points[kept:], targets[kept:], first=self._done)
            return np.concatenate([self._codes[:kept], rest])
        missing = len(points) - len(self._codes)
        start = np.concatenate([self._codes, np.repeat(self._codes[-1:], missing, axis=0)])
        return self._tracks.find(points, targets, start=start, first=self._done - kept)


def _table(frames: list[Frame]) -> Frame:
    """Return points (T, M, 3) and targets (T, M) of frames with at most M points; others have target 0."""
    count = max(len(points) for points, _ in frames)
    points, targets = np.zeros((len(frames), count, 3)), np.zeros((len(frames), count))
    for frame, (places, requested) in enumerate(frames):
        points[frame, : len(places)], targets[frame, : len(places)] = places, requested
    return points, targets


def streamed(
    array: Array, frames: Iterable[Any], change: float, ahead: int, aim: str | None, options: dict[str, Any]
) -> Iterator[NDArray[np.complex64]]:
    """Yield the drive (N,) of each frame of a stream: points (M, 3) or pairs (points, pressures (M,))."""
    air = {name: options[name] for name in AIR if name in options}
    given = options.get("quantization")
    board = board_of(array.quantization if given is None else given)
    coming = (_read(array, air, frame, count) for count, frame in enumerate(frames))
    for first in coming:
        tracks = Tracks(Scene(array, first[0], **air), change, board, lowered=aim != "max", coded=False)
        horizon = Horizon(tracks, chain([first], coming), ahead)
        for codes in horizon:
            points, targets = horizon.frame
            yield tracks.played(points[None], targets[None], codes[None])[0]


def _read(array: Array, air: dict[str, Any], frame: Any, count: int) -> Frame:
    """Return points and targets of a frame. Missing pressures become the balanced level of its points."""
    with numbered(count):
        points, pressures = read_frame(frame)
        if pressures is None:
            return points, np.full(len(points), Scene(array, points, **air).reach().level)
        return points, pressures


@contextmanager
def numbered(count: int) -> Iterator[None]:
    """Name frame number `count` of a stream in errors about it."""
    try:
        yield
    except SceneError as error:
        place, item = f"frames[{count}]", error.item
        if item == "frame":
            raise restated(error, item=place, index=count) from None
        # A solver counts the frames of one call, which is one frame.
        raise restated(error, place=place, index=count) from None


def read_frame(frame: Any) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return points (M, 3) and pressures (M,) or None of a frame of a stream."""
    given, pressures = frame if isinstance(frame, tuple) and len(frame) == 2 else (frame, None)
    cure = "give points x 3 numbers in m, and pressures if any as the second of a pair"
    # The scene checks the coordinates. A copy, because a caller may write the next frame into the same array.
    points = np.array(numbers("frame", given, [(-1, 3)], cure, copy=False), np.float64)
    return points, None if pressures is None else changing_pressures(pressures, 1, len(points))[0]


#: Names of a solver's state after its last frame.
REMEMBERED = ("drives", "weights", "unevenness", "motion")


class Found(Protocol):
    """Protocol of objects that solve frames in order.

    Attributes
    ----------
    board
        Quantization of the drives; None for that of the array.
    """

    board: dict[str, Any] | None

    def block(self, frames: slice) -> NDArray[Any]:
        """Return drives or codes (frames, N) of `frames`, which follow those of the last call."""

    def state(self) -> dict[str, Any]:
        """Return the state needed to continue after the last block."""

    def restore(self, done: int, state: dict[str, Any]) -> None:
        """Continue after frame number `done` - 1."""


class Followed:
    """Solves each frame from the last one. `exact` is True for glide, whose phases are those of the board."""

    def __init__(self, requested: Request, solver: Solver, exact: bool) -> None:
        self.board: dict[str, Any] | None = requested.options.get("quantization")
        self._requested = requested
        self._solver = solver
        self._phases = requested.board.get("phases") if exact and requested.full else None
        self._stiff = exact and requested.stiff

    def block(self, frames: slice) -> NDArray[Any]:
        requested = self._requested
        targets = None if self._stiff else requested.targets[frames]
        # Traps need the points before and after, for the acceleration. Outside an open sequence the points
        # stand still.
        margin = look(requested.rate) if self._stiff else 0
        first, last, _ = frames.indices(len(requested.points))
        around = np.arange(first - margin, last + margin)
        mode: Literal["wrap", "clip"] = "wrap" if requested.closed else "clip"
        points = np.take(requested.points, around, axis=0, mode=mode)
        drives = self._solver.follow(points, targets, margin)
        return drives if self._phases is None else coded(drives, self._phases)

    def state(self) -> dict[str, Any]:
        last = self._solver.last()
        return {} if last is None else dict(zip(REMEMBERED, last, strict=True))

    def restore(self, done: int, state: dict[str, Any]) -> None:
        if state:
            drives, weights, unevenness, motion = (state[name] for name in REMEMBERED)
            self._solver.restore(drives, weights, float(unevenness), motion)


class Foreseen:
    """Solves frames by `Tracks`, when some of the later frames are known."""

    def __init__(self, requested: Request, tracks: Tracks, ahead: int) -> None:
        self.board: dict[str, Any] | None = tracks.board
        self._requested = requested
        self._tracks = tracks
        self._ahead = ahead
        self._horizon = Horizon(tracks, zip(requested.points, requested.targets, strict=True), ahead)

    def block(self, frames: slice) -> NDArray[Any]:
        points, targets = self._requested.points[frames], self._requested.targets[frames]
        return self._tracks.played(points, targets, np.stack(list(islice(self._horizon, len(points)))))

    def state(self) -> dict[str, Any]:
        return self._horizon.state()

    def restore(self, done: int, state: dict[str, Any]) -> None:
        rest = zip(self._requested.points[done - 1 :], self._requested.targets[done - 1 :], strict=True)
        self._horizon = Horizon(self._tracks, rest, self._ahead, done, state)
