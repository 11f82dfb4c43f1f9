"""Points given frame by frame, on straight lines between the frames."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._midair import Curve, SceneError
from .._support.arguments import flag, number, real, refused
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
    """A point that moves along the outline of an SVG file, or of SVG text, its middle at (0, 0, z), y up.

    size : the longer side of the drawing, in m
    speed : in m/s; or
    frequency : times a second along the outline
    pressures : in Pa; by default balanced

    The path is closed if the outline is. A drawing of several outlines is rejected.

    Raises SceneError for a missing file or one that draws more than one outline, and unless either a speed
    or a frequency above 0 is given.
    """
    contours = outlines("path.svg", path, size, z)
    if len(contours) > 1:
        cure = "leave one in each drawing, and put paths together by & or .then(..., fade=)"
        raise SceneError(f"the drawing has {len(contours)} outlines, of which a point walks one: {cure}")
    return walk(Curve.lines("outline", *contours[0]), speed=speed, frequency=frequency, pressures=pressures)


class Frames(NamedTuple):
    """Points (T, M, 3) in m, targets (T, M) or None, and whether the last frame continues to the first."""

    points: Numbers
    targets: Numbers | None
    closed: bool


def read(path: Path | ArrayLike, rate: float, pressures: ArrayLike | None = None) -> Frames:
    """Frames of a path at a rate in Hz; or those of an array (T, M, 3), or of a list of frames, unchanged.

    Targets are in Pa if the path has pressures, or if `pressures` (one number, (M,) or (T, M)) are given,
    times modulation and fades of the path. Without either they are relative to full, and None if all are 1.

    Raises SceneError for points that are no frames, a rate that is not above 0, and pressures given twice.
    """
    rate = number("rate", rate, above=0)
    if isinstance(path, Path):
        points, targets = path.frames(rate)
        if pressures is not None and path.pascals:
            raise SceneError("pressures are given with the path, too: give them in one place")
        if pressures is not None:
            targets = targets * changing_pressures(pressures, *targets.shape)
        plain = pressures is None and not path.pascals and bool((targets == 1).all())
        return Frames(points, None if plain else targets, path.closed)
    points = point_sets("path", path)
    given = None if pressures is None else np.array(changing_pressures(pressures, *points.shape[:2]))
    return Frames(points, given, False)


@dataclass(frozen=True, eq=False, kw_only=True)
class Samples(Piece):
    """K frames at a rate; a closed piece continues from the last to the first."""

    rate: float
    #: (K, M, 3) in m.
    frames: Numbers
    #: (K, M).
    targets: Numbers

    def place(self, times: Numbers) -> Numbers:
        """Places between two frames."""
        before, after, share = self._between(times)
        return mixed(self.frames[before], self.frames[after], share[:, None, None])

    def pace(self, times: Numbers) -> Numbers:
        """Distances of two frames by their time."""
        before, after, _ = self._between(times)
        apart: Numbers = np.linalg.norm(self.frames[after] - self.frames[before], axis=2)
        return self.rate * apart

    def level(self, times: Numbers) -> Numbers:
        """Targets between two frames."""
        before, after, share = self._between(times)
        return mixed(self.targets[before], self.targets[after], share[:, None])

    def _between(self, times: Numbers) -> tuple[np.ndarray, np.ndarray, Numbers]:
        """The frame before and the frame after each time, and the fraction between them."""
        ways = times * self.rate
        ways = np.where(np.abs(ways - np.rint(ways)) < ROUNDING * (1 + ways), np.rint(ways), ways)
        count = len(self.frames)
        before = np.floor(ways).astype(np.int64).clip(0, count - 1 if self.closed else count - 2)
        return before, (before + 1) % count, ways - before


def from_array(
    points: ArrayLike, *, rate: float, pressures: ArrayLike | None = None, closed: bool = False
) -> Path:
    """A path through frames of points (T, M, 3) in m, at `rate` frames a second, straight between them.

    pressures : in Pa, one number, (M,) or (T, M), straight between frames, too; by default balanced
    closed : whether the last frame continues to the first

    Raises SceneError for wrong points, pressures or rate, and for fewer than two frames.
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
    """A path from points (M, 3) to as many others in m, each straight and at constant speed.

    duration : in s; or
    speed : in m/s, of the point with the longest way
    pressures : in Pa, one number or (M,); by default balanced

    Raises SceneError for sets of different numbers of points, and unless either a duration or a speed above 0
    is given.
    """
    if duration is not None and speed is not None:
        raise SceneError(
            f"duration is {duration} and speed is {speed}: give one of them, leave out the other"
        )
    if duration is None and speed is None:
        raise SceneError("duration and speed are left out: give duration in s, or speed in m/s")
    ends = [_set(item, value) for item, value in (("from_points", from_points), ("to_points", to_points))]
    counts = [len(end) for end in ends]
    if counts[0] != counts[1]:
        reported = f"M changes from {counts[0]} to {counts[1]} between from_points and to_points"
        raise SceneError(f"{reported}: give as many, or join paths with a fade, a.then(b, fade=)")
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
    """Points (3,) or (M, 3) in m at rest, for a modulated or joined focus.

    duration : in s, after which it repeats: it is closed
    pressures : in Pa, one number or (M,); by default balanced

    Raises SceneError for wrong places, duration or pressures.
    """
    points = _set("places", np.atleast_2d(real("places", places, "give (3,) or (M, 3) in m")))
    lasts = number("duration", duration, above=0)
    if pressures is not None:
        pressures = constant_pressures(pressures, len(points))
    return _sampled(np.stack([points, points]), 2, 2 / lasts, True, pressures)


def _set(item: str, value: ArrayLike) -> Numbers:
    cure = f"give points x 3 finite numbers in m, at most {FARTHEST:g}"
    found = real(item, value, cure)
    if found.ndim != 2 or found.shape[1:] != (3,) or not len(found) or not (np.abs(found) <= FARTHEST).all():
        raise refused(item, value, cure)
    return found


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
