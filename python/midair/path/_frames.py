"""Paths through frames of points, and the frames of a path."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import FARTHEST, Path, numbers, stated
from .._support.arguments import flag, frame_rate, vectors

Numbers = NDArray[np.float64]


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
    rate = frame_rate(rate)
    if isinstance(path, Path):
        points, targets = path.frames(rate)
        if pressures is not None and path.pascals:
            cure = "give them in one place"
            raise stated("pressures", "are given with the path, too", cure, code="conflict")
        if pressures is not None:
            targets = targets * changing_pressures(pressures, *targets.shape)
        plain = pressures is None and not path.pascals and bool((targets == 1).all())
        return Frames(points, None if plain else targets, path.closed)
    points = point_sets("path", path)
    given = None if pressures is None else np.array(changing_pressures(pressures, *points.shape[:2]))
    return Frames(points, given, False)


def from_array(points: ArrayLike, *, rate: float, pressures: ArrayLike | None = None, closed: bool = False) -> Path:
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
    frames = point_sets("points", points)
    if pressures is not None:
        pressures = changing_pressures(pressures, *frames.shape[:2])
    return Path._through(frames, frame_rate(rate), flag("closed", closed), pressures)


def changing_pressures(value: ArrayLike, frames: int, points: int) -> Numbers:
    """Return targets (T, M) in Pa: one value for all, per point, or per frame and point."""
    cure = f"give numbers of at least 0 in Pa: one number or {points} or {frames} x {points}"
    shapes = [(), (frames, points), (points,)]
    return np.broadcast_to(numbers("pressures", value, shapes, cure, least=0), (frames, points))


def point_sets(item: str, value: Any) -> Numbers:
    """Return frames (T, M, 3) of points: at least two frames, each with the same number of points."""
    cure = "give frames x points x 3 numbers in m, at least two frames of at least one point"
    if isinstance(value, list | tuple | Iterator):
        frames = [vectors(f"{item}[{index}]", frame, least=1) for index, frame in enumerate(value)]
        for index, frame in enumerate(frames):
            if len(frame) != len(frames[0]):
                change = f"M changes from {len(frames[0])} to {len(frame)} at frame {index}"
                raise stated("", change, "join paths with a fade, a.then(b, fade=)")
        value = np.array(frames)
    return numbers(item, value, [(-2, -1, 3)], cure, most=FARTHEST)
