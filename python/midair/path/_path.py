"""Path: control points and their targets as functions of time, and combinations of paths."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from .._support.arguments import number, real, refused, word
from ._joined import beside, then
from ._piece import ROUNDING, Numbers, Piece, instants

Shape: TypeAlias = Literal["sqrt", "cosine", "square"]

#: Shapes by periods since the start; each begins at 1.
SHAPES: dict[str, Callable[[Numbers], Numbers]] = {
    "sqrt": lambda periods: np.sqrt((1 + np.cos(2 * math.pi * periods)) / 2),
    "cosine": lambda periods: (1 + np.cos(2 * math.pi * periods)) / 2,
    "square": lambda periods: ((periods + ROUNDING) % 1 < 0.5).astype(np.float64),
}


@dataclass(frozen=True, eq=False)
class Wave:
    """A modulation: factors of the targets that repeat.

    frequency : in Hz
    finest : the highest frequency that frames must follow, in Hz
    depth : 1 - depth + depth s
    shape : of s, without samples
    samples : (S,) of s in a period
    """

    frequency: float
    finest: float
    depth: float
    shape: str
    samples: Numbers | None = None

    def factors(self, periods: Numbers) -> Numbers:
        """Factors by periods since the start."""
        if self.samples is None:
            s = SHAPES[self.shape](periods)
        else:
            count = len(self.samples)
            s = self.samples[np.floor(count * (periods + ROUNDING)).astype(np.int64) % count]
        return 1 - self.depth + self.depth * s


def wave(given: float | ArrayLike, shape: str, depth: float, samples_rate: float | None) -> Wave:
    """1 - depth + depth s, s a shape at a frequency in Hz, or samples (S,) of 0 to 1 that repeat."""
    depth = number("depth", depth, least=0)
    if depth > 1:
        raise refused("depth", depth, "give a number from 0 to 1")
    if word("shape", shape) not in SHAPES:
        raise refused("shape", shape, f"give one of {', '.join(SHAPES)}")
    if samples_rate is None and np.ndim(given) == 0:
        frequency = number("frequency", given, above=0)
        return Wave(frequency, frequency, depth, shape)
    cure = "give samples (S,) from 0 to 1, and samples_rate in Hz"
    samples = real("samples", given, cure)
    if samples.ndim != 1 or not samples.size or not ((samples >= 0) & (samples <= 1)).all():
        raise refused("samples", given, cure)
    rate = number("samples_rate", samples_rate, above=0)
    return Wave(rate / len(samples), rate / 2, depth, shape, samples)


@dataclass(frozen=True, eq=False, kw_only=True)
class Modulated(Piece):
    """A piece whose targets are multiplied by the factors of a wave."""

    piece: Piece
    wave: Wave

    def place(self, times: Numbers) -> Numbers:
        """Places of the piece."""
        return self.piece.place(times)

    def pace(self, times: Numbers) -> Numbers:
        """Speeds of the piece."""
        return self.piece.pace(times)

    def level(self, times: Numbers) -> Numbers:
        """Targets of the piece, modulated."""
        return self.wave.factors(self.wave.frequency * times)[:, None] * self.piece.level(times)


def modulated(piece: Piece, by: Wave) -> Piece:
    """The piece, modulated; a closed one must have a whole number of periods."""
    periods = by.frequency * piece.duration
    if piece.closed and abs(periods - round(periods)) > ROUNDING * max(periods, 1):
        near = " or ".join(
            f"{n / piece.duration:.10g}" for n in (math.floor(periods), math.ceil(periods)) if n
        )
        lasts = (
            f"the closed path of {piece.duration:.6g} s would hold {periods:.6g} periods and jump at its seam"
        )
        raise refused("frequency", by.frequency, f"{lasts}, give {near} Hz")
    return Modulated(
        points=piece.points,
        duration=piece.duration,
        closed=piece.closed,
        pascals=piece.pascals,
        modulation=max(piece.modulation, by.finest),
        piece=piece,
        wave=by,
    )


#: Frames times points of one answer; 10^8 are 3.2 GB.
MOST_FRAMES = 100_000_000


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """M control points that move for a time, with a target for each; immutable.

    Targets are in Pa (peak) if `pressures` were given, and then `pascals` is true. Otherwise targets are
    relative to full: 1, times modulation and fades, for a solver that balances. A point whose target is 0
    is absent: leave it out of that frame's scene.

    `a & b` are the points of both at the same time, `a.then(b)` those of b after those of a.
    """

    _piece: Piece

    @property
    def points(self) -> int:
        """M, the number of points, the same at all times."""
        return self._piece.points

    @property
    def duration(self) -> float:
        """Duration in s."""
        return self._piece.duration

    @property
    def closed(self) -> bool:
        """Whether the end joins the start, so that the path can repeat for ever."""
        return self._piece.closed

    @property
    def pascals(self) -> bool:
        """Whether targets are in Pa (pressures were given), or relative to full."""
        return self._piece.pascals

    def at(self, times: ArrayLike) -> Numbers:
        """Places (T, M, 3) in m at times (T,) in s.

        A closed path repeats; an open one stands still before its start and after its end.

        Raises SceneError for times that are no finite numbers.
        """
        return self._piece.place(self._piece.within(instants(times)))

    def targets(self, times: ArrayLike) -> Numbers:
        """Targets (T, M) at times (T,) in s: in Pa if pressures were given, else relative to full.

        Raises SceneError for times that are no finite numbers.
        """
        return self._piece.level(self._piece.within(instants(times)))

    def speed(self, times: ArrayLike) -> Numbers:
        """Speeds (T, M) in m/s at times (T,) in s within the path; at a corner, the speed after it.

        Raises SceneError for times that are no finite numbers.
        """
        return self._piece.pace(self._piece.within(instants(times)))

    def frames(self, rate: float) -> tuple[Numbers, Numbers]:
        """Places (T, M, 3) and targets (T, M) at i / rate, i = 0, 1, ..., of round(duration rate) frames.

        An open path has one more, its end. The step over the seam of a closed path is like any other if
        duration times rate is whole.

        Raises SceneError for a rate that gives less than two frames, too many for one answer, or too few for
        the modulation.
        """
        rate = number("rate", rate, above=0)
        # The end of an open path is a frame, that of a closed one the first.
        count = np.rint(self.duration * rate) + (not self.closed)
        if count < 2:
            raise refused(
                "rate", rate, f"that is {count:g} frames in {self.duration:.6g} s, give a larger one"
            )
        if count * self.points > MOST_FRAMES:
            large = f"{count:g} frames of {self.points} points are too many for one answer"
            raise refused("rate", rate, f"{large}, take them in parts by at(times) and targets(times)")
        if rate < 2 * self._piece.modulation * (1 - ROUNDING):
            least = 2 * self._piece.modulation
            raise refused(
                "rate", rate, f"the modulation needs {least:g} frames a second at least, give as many"
            )
        times = np.arange(int(count)) / rate
        return self.at(times), self.targets(times)

    def beside(self, other: Path) -> Path:
        """The points of both at the same time: this path's first; also `path & other`.

        Both have the same duration; or both are closed, with durations in a ratio of whole numbers, and
        repeat until both are at their start again.

        Raises SceneError for paths of other durations, or of which one has pressures and one has none.
        """
        return Path(beside(self._piece, _piece("other", other)))

    def __and__(self, other: Any) -> Path:
        """Both at the same time, like `beside`."""
        return self.beside(other)

    def then(self, other: Path, fade: float | None = None) -> Path:
        """The other path after this one.

        fade : in s, for paths whose end and start differ in points, places or targets. During the fade all
            points stand still, and targets change from one value to the other (to and from 0 for points
            that vanish and appear) along a raised cosine. Without a fade such paths are rejected.

        The new path is closed if its end joins its start.

        Raises SceneError for paths that do not join without a fade, or of which one has pressures and one has
        none.
        """
        seconds = None if fade is None else number("fade", fade, above=0)
        return Path(then(self._piece, _piece("other", other), seconds))

    def with_am(self, frequency: float, shape: Shape = "sqrt", depth: float = 1.0) -> Path:
        """The path with its targets times 1 - depth + depth s(t): amplitude modulation at a frequency in Hz.

        With c = cos(2 pi frequency t), s is sqrt((1 + c) / 2) for "sqrt", whose force on a hand has one line
        in its spectrum and the mean 1/2; (1 + c) / 2 for "cosine", of mean force 3/8; 1, then 0 for "square".
        A closed path needs a whole number of periods.

        Raises SceneError for an unknown shape, a depth beyond 0 to 1, and a frequency that does not fit a
        closed path.
        """
        return self.modulated(frequency, shape, depth)

    def modulated(
        self,
        frequency: float | ArrayLike,
        shape: Shape = "sqrt",
        depth: float = 1.0,
        *,
        samples_rate: float | None = None,
    ) -> Path:
        """The same by a frequency in Hz and a shape, or by any samples (S,) from 0 to 1 that repeat.

        samples_rate : samples a second; `shape` is not used then

        Raises the errors of `with_am`, and SceneError for wrong samples or a wrong rate.
        """
        return Path(modulated(self._piece, wave(frequency, shape, depth, samples_rate)))

    def __repr__(self) -> str:
        """Points, duration and whether it closes."""
        return f"Path(points={self.points}, duration={self.duration:.6g}, closed={self.closed})"


def _piece(item: str, path: Any) -> Piece:
    if not isinstance(path, Path):
        raise refused(item, path, "give a path, such as midair.path.circle(...)")
    return path._piece
