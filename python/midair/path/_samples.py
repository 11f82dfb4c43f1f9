"""Paths through points that are given frame by frame, with linear interpolation between frames."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._midair import Curve, numbers, stated
from .._support.arguments import flag, number, refused, vectors
from ..shape._vector_graphics import outlines
from ._figures import lasting, walk
from ._path import Path
from ._piece import (
    FARTHEST,
    ROUNDING,
    Numbers,
    Piece,
    changing_pressures,
    constant_pressures,
    mixed,
    point_sets,
)


def svg(
    path: str | PathLike[str],
    *,
    size: float,
    z: float,
    speed: float | None = None,
    frequency: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point along the outline of an SVG drawing, its middle at (0, 0, z), y up.

    Parameters
    ----------
    path : str or path
        An SVG file, or SVG text. A drawing of several outlines is rejected.
    size : float
        Longer side of the drawing, in m.
    z : float
        Height of its plane in m.
    speed : float, optional
        Speed in m/s; alternatively give `frequency`.
    frequency : float, optional
        Runs per second along the outline.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path, closed if the outline is.

    Raises
    ------
    SceneError
        For a missing file or one that draws more than one outline, and unless either a speed or a frequency
        above 0 is given.

    Examples
    --------
    >>> import midair
    >>> drawing = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 H10 V10 H0 Z"/></svg>'
    >>> midair.path.svg(drawing, size=0.02, z=0.15, frequency=5)
    Path(points=1, duration=0.2, closed=True)
    """
    contours = outlines("path.svg", path, size, z)
    if len(contours) > 1:
        cure = "leave one in each drawing, and put paths together by & or .then(..., fade=)"
        raise stated("the drawing", f"has {len(contours)} outlines, of which a point walks one", cure)
    return walk(Curve.lines("outline", *contours[0]), speed=speed, frequency=frequency, pressures=pressures)


class Frames(NamedTuple):
    """Points (T, M, 3) in m, targets (T, M) or None, and whether the last frame continues to the first."""

    points: Numbers
    targets: Numbers | None
    closed: bool


def read(path: Path | ArrayLike, rate: float, pressures: ArrayLike | None = None) -> Frames:
    """Return frames of a path at a rate; or those of an array, or of a list of frames, unchanged.

    Parameters
    ----------
    path : Path or (T, M, 3) array_like
        A path, or points in m.
    rate : float
        Frames per second.
    pressures : float, (M,) or (T, M) array_like, optional
        Peak pressures in Pa.

    Returns
    -------
    Frames
        `points` and `targets`. Targets are in Pa if there are pressures, times modulation and fades of the
        path. Otherwise they are factors from 0 to 1, and None if all are 1.

    Raises
    ------
    SceneError
        For points that are no frames, a rate that is not above 0, and pressures given twice.

    Examples
    --------
    >>> import midair
    >>> ring = midair.path.circle([0, 0, 0.15], 0.02, frequency=50)
    >>> midair.path.read(ring, 1000, pressures=500).points.shape
    (20, 1, 3)
    """
    rate = number("rate", rate, above=0)
    if isinstance(path, Path):
        points, targets = path.frames(rate)
        if pressures is not None and path.pascals:
            raise stated(
                "pressures", "are given with the path, too", "give them in one place", code="conflict"
            )
        if pressures is not None:
            targets = targets * changing_pressures(pressures, *targets.shape)
        plain = pressures is None and not path.pascals and bool((targets == 1).all())
        return Frames(points, None if plain else targets, path.closed)
    points = point_sets("path", path)
    given = None if pressures is None else changing_pressures(pressures, *points.shape[:2])
    return Frames(points, given, False)


@dataclass(frozen=True, eq=False, kw_only=True)
class Samples(Piece):
    """K frames at a rate. A closed piece continues from the last frame to the first."""

    rate: float
    #: Places (K, M, 3) in m.
    frames: Numbers
    #: Targets (K, M).
    targets: Numbers

    def place(self, times: Numbers) -> Numbers:
        """Return the places, interpolated between two frames."""
        before, after, share = self._between(times)
        return mixed(self.frames[before], self.frames[after], share[:, None, None])

    def pace(self, times: Numbers) -> Numbers:
        """Return the speeds: distance between two frames, times their rate."""
        before, after, _ = self._between(times)
        apart: Numbers = np.linalg.norm(self.frames[after] - self.frames[before], axis=2)
        return self.rate * apart

    def level(self, times: Numbers) -> Numbers:
        """Return the targets, interpolated between two frames."""
        before, after, share = self._between(times)
        return mixed(self.targets[before], self.targets[after], share[:, None])

    def _between(self, times: Numbers) -> tuple[np.ndarray, np.ndarray, Numbers]:
        """Return the frames before and after each time, and the fraction of the way between them."""
        ways = times * self.rate
        ways = np.where(np.abs(ways - np.rint(ways)) < ROUNDING * (1 + ways), np.rint(ways), ways)
        count = len(self.frames)
        before = np.floor(ways).astype(np.int64).clip(0, count - 1 if self.closed else count - 2)
        return before, (before + 1) % count, ways - before


def from_array(
    points: ArrayLike, *, rate: float, pressures: ArrayLike | None = None, closed: bool = False
) -> Path:
    """Make a path through frames of points, with linear interpolation between them.

    Parameters
    ----------
    points : (T, M, 3) array_like
        Places in m.
    rate : float
        Frames per second.
    pressures : float, (M,) or (T, M) array_like, optional
        Peak pressures in Pa, interpolated like the points; by default the balanced level.
    closed : bool, optional
        Whether the last frame continues to the first.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    SceneError
        For wrong points, pressures or rate, and for fewer than two frames.

    Examples
    --------
    >>> import midair
    >>> midair.path.from_array([[[0, 0, 0.15]], [[0.01, 0, 0.15]], [[0.02, 0, 0.15]]], rate=10)
    Path(points=1, duration=0.2, closed=False)
    """
    rate, closed = number("rate", rate, above=0), flag("closed", closed)
    frames = point_sets("points", points)
    if not len(frames) / rate < np.inf:
        raise refused("rate", rate, f"the path would last {len(frames) / rate:g} s, give another")
    return _sampled(frames, len(frames) - (not closed), rate, closed, pressures)


def morph(
    from_points: ArrayLike,
    to_points: ArrayLike,
    *,
    duration: float | None = None,
    speed: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move points to as many others, each straight and at constant speed.

    Parameters
    ----------
    from_points, to_points : (M, 3) array_like
        Places in m at the start and at the end.
    duration : float, optional
        Duration in s; alternatively give `speed`.
    speed : float, optional
        Speed in m/s of the point with the longest way.
    pressures : float or (M,) array_like, optional
        Peak pressures in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    SceneError
        For sets of different numbers of points, and unless either a duration or a speed above 0 is given.

    Examples
    --------
    >>> import midair
    >>> midair.path.morph([[0, 0, 0.15]], [[0, 0, 0.2]], duration=1).at([0.5]).tolist()
    [[[0.0, 0.0, 0.175]]]
    """
    if duration is not None and speed is not None:
        raise stated(
            "duration", f"is {duration} and speed is {speed}", "give one of them, leave out the other"
        )
    if duration is None and speed is None:
        raise stated(
            "duration and speed", "are left out", "give duration in s, or speed in m/s", code="missing"
        )
    ends = [_set(item, value) for item, value in (("from_points", from_points), ("to_points", to_points))]
    counts = [len(end) for end in ends]
    if counts[0] != counts[1]:
        reported = f"M changes from {counts[0]} to {counts[1]} between from_points and to_points"
        raise stated("", reported, "give as many, or join paths with a fade, a.then(b, fade=)")
    if pressures is not None:
        pressures = constant_pressures(pressures, counts[0])
    if duration is None:
        furthest = float(np.linalg.norm(ends[1] - ends[0], axis=1).max())
        duration = lasting(furthest, 1, speed=speed, frequency=None)
    else:
        duration = number("duration", duration, above=0)
    if not 1 / duration < np.inf:
        raise refused("duration", duration, "give a longer one")
    return _sampled(np.stack(ends), 1, 1 / duration, False, pressures)


def still(places: ArrayLike, *, duration: float, pressures: ArrayLike | None = None) -> Path:
    """Keep points at rest, for a modulated or joined focus.

    Parameters
    ----------
    places : (3,) or (M, 3) array_like
        Places in m.
    duration : float
        Duration in s of a period: the path is closed and repeats.
    pressures : float or (M,) array_like, optional
        Peak pressures in Pa; by default the balanced level.

    Returns
    -------
    Path
        The closed path.

    Raises
    ------
    SceneError
        For wrong places, duration or pressures.

    Examples
    --------
    >>> import midair
    >>> midair.path.still([0, 0, 0.15], duration=0.1).with_am(200)
    Path(points=1, duration=0.1, closed=True)
    """
    points = numbers("places", places, [(3,), (-1, 3)], "give (3,) or (M, 3) in m", most=FARTHEST)
    points = points.reshape(-1, 3)
    lasts = number("duration", duration, above=0)
    if pressures is not None:
        pressures = constant_pressures(pressures, len(points))
    return _sampled(np.stack([points, points]), 2, 2 / lasts, True, pressures)


def _set(item: str, value: ArrayLike) -> Numbers:
    return vectors(item, value, least=1, most=FARTHEST)


def _sampled(frames: Numbers, steps: int, rate: float, closed: bool, pressures: ArrayLike | None) -> Path:
    count, points, _ = frames.shape
    return Path(
        Samples(
            points=points,
            duration=steps / rate,
            closed=closed,
            pascals=pressures is not None,
            rate=rate,
            frames=frames,
            targets=changing_pressures(pressures, count, points),
        )
    )
