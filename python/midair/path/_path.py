"""`midair.path.Path`: control points and their targets as functions of time; combinations of paths."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from .._midair import numbers
from .._support.arguments import is_array, number, refused, word
from ._joined import beside, then
from ._piece import ROUNDING, Numbers, Piece, instants

Shape: TypeAlias = Literal["sqrt", "cosine", "square"]

#: Shapes of a modulation as functions of the periods since the start. Each begins at 1.
SHAPES: dict[str, Callable[[Numbers], Numbers]] = {
    "sqrt": lambda periods: np.sqrt((1 + np.cos(2 * math.pi * periods)) / 2),
    "cosine": lambda periods: (1 + np.cos(2 * math.pi * periods)) / 2,
    "square": lambda periods: ((periods + ROUNDING) % 1 < 0.5).astype(np.float64),
}


@dataclass(frozen=True, eq=False)
class Wave:
    """A modulation: factors of the targets, which repeat.

    Attributes
    ----------
    frequency
        Frequency of the modulation in Hz.
    finest
        The highest frequency that the frames must be able to represent, in Hz.
    depth
        d in the factor 1 - d + d s, where s(t) is the shape or the samples.
    shape
        Name of s, used if there are no samples.
    samples
        (S,): values of s in a period.
    """

    frequency: float
    finest: float
    depth: float
    shape: str
    samples: Numbers | None = None

    def factors(self, periods: Numbers) -> Numbers:
        """Return the factors after these numbers of periods since the start."""
        if self.samples is None:
            s = SHAPES[self.shape](periods)
        else:
            count = len(self.samples)
            s = self.samples[np.floor(count * (periods + ROUNDING)).astype(np.int64) % count]
        return 1 - self.depth + self.depth * s


def wave(given: float | ArrayLike, shape: str, depth: float, samples_rate: float | None) -> Wave:
    """Return the modulation 1 - depth + depth s(t), where s has a shape and a frequency, or samples (S,)."""
    depth = number("depth", depth, least=0)
    if depth > 1:
        raise refused("depth", depth, "give a number from 0 to 1")
    if word("shape", shape) not in SHAPES:
        raise refused("shape", shape, f"give one of {', '.join(SHAPES)}")
    if samples_rate is None and not isinstance(given, list | tuple) and not is_array(given):
        frequency = number("frequency", given, above=0)
        return Wave(frequency, frequency, depth, shape)
    cure = "give samples (S,) from 0 to 1, and samples_rate in Hz"
    samples = numbers("samples", given, [(-1,)], cure, least=0, most=1)
    rate = number("samples_rate", samples_rate, above=0)
    return Wave(rate / len(samples), rate / 2, depth, shape, samples)


@dataclass(frozen=True, eq=False, kw_only=True)
class Modulated(Piece):
    """A piece whose targets are multiplied by a modulation."""

    piece: Piece
    wave: Wave

    def place(self, times: Numbers) -> Numbers:
        """Return the places of the piece."""
        return self.piece.place(times)

    def pace(self, times: Numbers) -> Numbers:
        """Return the speeds of the piece."""
        return self.piece.pace(times)

    def level(self, times: Numbers) -> Numbers:
        """Return the targets of the piece, modulated."""
        return self.wave.factors(self.wave.frequency * times)[:, None] * self.piece.level(times)


def modulated(piece: Piece, by: Wave) -> Piece:
    """Return the modulated piece. Rejects a closed piece without a whole number of periods."""
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


#: Largest number of frames, times points, in one call; 10^8 take 3.2 GB.
MOST_FRAMES = 100_000_000


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """Path of M control points for a time, with a target for each; immutable.

    The functions of `midair.path` make paths. `a & b` are the points of both at the same time, `a.then(b)`
    those of b after those of a.

    Notes
    -----
    Targets are in Pa (peak) if `pressures` were given, and then `pascals` is true. Otherwise targets are
    factors: 1, times modulation and fades, for a solver that finds the level. A point whose target is 0
    is absent: leave it out of that frame's scene.

    Examples
    --------
    >>> import midair
    >>> there = midair.path.line([-0.02, 0, 0.15], [0.02, 0, 0.15], speed=0.1)
    >>> back = midair.path.line([0.02, 0, 0.15], [-0.02, 0, 0.15], speed=0.2)
    >>> there.then(back)
    Path(points=1, duration=0.6, closed=True)
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
        """Whether targets are in Pa (pressures were given); otherwise they are factors from 0 to 1."""
        return self._piece.pascals

    def at(self, times: ArrayLike) -> Numbers:
        """Return places at some times; a closed path repeats, an open one rests before and after.

        Parameters
        ----------
        times : (T,) array_like
            Times in s.

        Returns
        -------
        (T, M, 3) ndarray
            Places in m.

        Raises
        ------
        SceneError
            For times that are no finite numbers.
        """
        return self._piece.place(self._piece.within(instants(times)))

    def targets(self, times: ArrayLike) -> Numbers:
        """Return targets at some times: in Pa if pressures were given, else factors from 0 to 1.

        Parameters
        ----------
        times : (T,) array_like
            Times in s.

        Returns
        -------
        (T, M) ndarray
            Targets.

        Raises
        ------
        SceneError
            For times that are no finite numbers.
        """
        return self._piece.level(self._piece.within(instants(times)))

    def speed(self, times: ArrayLike) -> Numbers:
        """Return speeds at some times within the path; at a corner, the speed after it.

        Parameters
        ----------
        times : (T,) array_like
            Times in s.

        Returns
        -------
        (T, M) ndarray
            Speeds in m/s.

        Raises
        ------
        SceneError
            For times that are no finite numbers.
        """
        return self._piece.pace(self._piece.within(instants(times)))

    def frames(self, rate: float) -> tuple[Numbers, Numbers]:
        """Return places and targets of round(duration * rate) frames at the times i / rate, i = 0, 1, ...

        Parameters
        ----------
        rate : float
            Frames per second. The step over the seam of a closed path is like any other if duration times
            rate is whole.

        Returns
        -------
        places : (T, M, 3) ndarray
            Places in m; an open path has one more, its end.
        targets : (T, M) ndarray
            Targets, as `targets` returns them.

        Raises
        ------
        SceneError
            For a rate that gives less than two frames, too many at once, or too few for the modulation.
        """
        rate = number("rate", rate, above=0)
        # The end of an open path is a frame of its own; the end of a closed path is its first frame.
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
        """Join two paths at the same time: this path's points first; also `path & other`.

        Parameters
        ----------
        other : Path
            A path of the same duration. Or both are closed, with durations in a ratio of whole numbers: they
            repeat until both are at their start again.

        Returns
        -------
        Path
            The points of both.

        Raises
        ------
        SceneError
            For paths of other durations, or of which one has pressures and one has none.
        """
        return Path(beside(self._piece, _piece("other", other)))

    def __and__(self, other: Any) -> Path:
        """Return both paths played at the same time, like `beside`."""
        return self.beside(other)

    def then(self, other: Path, fade: float | None = None) -> Path:
        """Join two paths, the other after this one.

        Parameters
        ----------
        other : Path
            The path that follows.
        fade : float, optional
            Time in s, for paths whose end and start differ in points, places or targets. During the fade all
            points stand still, and targets change from one value to the other along a raised cosine; points
            that vanish and appear change to and from 0. Without a fade such paths are rejected.

        Returns
        -------
        Path
            Both paths as one, which is closed if its end joins its start.

        Raises
        ------
        SceneError
            For paths that do not join without a fade, or of which one has pressures and one has none.
        """
        seconds = None if fade is None else number("fade", fade, above=0)
        return Path(then(self._piece, _piece("other", other), seconds))

    def with_am(self, frequency: float, shape: Shape = "sqrt", depth: float = 1.0) -> Path:
        """Modulate the amplitude: targets times 1 - depth + depth s(t).

        Parameters
        ----------
        frequency : float
            Frequency in Hz; a closed path needs a whole number of periods.
        shape : {"sqrt", "cosine", "square"}, optional
            Shape of s(t), below.
        depth : float, optional
            Depth of the modulation, from 0 (none) to 1.

        Returns
        -------
        Path
            The modulated path.

        Raises
        ------
        SceneError
            For an unknown shape, a depth beyond 0 to 1, and a frequency that does not fit a closed path.

        Notes
        -----
        With c = cos(2 pi frequency t), s is sqrt((1 + c) / 2) for "sqrt". Its force on a hand has one line in
        its spectrum and the mean 1/2. For "cosine" s is (1 + c) / 2, with a mean force of 3/8; for "square" s
        is 1, then 0.
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
        """Modulate the amplitude as `with_am` does, or by any samples that repeat.

        Parameters
        ----------
        frequency : float or (S,) array_like
            A frequency in Hz, or samples of s from 0 to 1.
        shape, depth
            As for `with_am`; `shape` is not used for samples.
        samples_rate : float, optional
            Samples per second.

        Returns
        -------
        Path
            The modulated path.

        Raises
        ------
        SceneError
            As for `with_am`, and for invalid samples or rates.
        """
        return Path(modulated(self._piece, wave(frequency, shape, depth, samples_rate)))

    def __repr__(self) -> str:
        """Return points, duration and closedness as text."""
        return f"Path(points={self.points}, duration={self.duration:.6g}, closed={self.closed})"


def _piece(item: str, path: Any) -> Piece:
    if not isinstance(path, Path):
        raise refused(item, path, "give a path, such as midair.path.circle(...)")
    return path._piece
