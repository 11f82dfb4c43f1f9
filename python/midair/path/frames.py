"""Frames of a path, or of an array of points, for whoever solves them one after the other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._midair import SceneError
from ..shape.arguments import number
from .arguments import changing_pressures, point_sets
from .path import Path
from .piece import Numbers


class Frames(NamedTuple):
    """Points (T, M, 3) in m, targets (T, M) or None, and whether the last frame goes on to the first."""

    points: Numbers
    targets: Numbers | None
    closed: bool


def read(path: Path | ArrayLike, rate: float, pressures: ArrayLike | None = None) -> Frames:
    """Frames of a path at a rate in Hz; or those of an array (T, M, 3), or of a list of frames, as they are.

    Targets are in Pa where the path has pressures, or where `pressures` (one number, (M,) or (T, M)) are
    given, times what modulation and fades of the path leave of them. Without either they are relative to
    full, and None where all are 1.

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
