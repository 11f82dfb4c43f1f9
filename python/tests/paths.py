"""Paths that several tests use."""

from typing import Any

import numpy as np

from midair import path

Numbers = np.ndarray
#: Height of the points, in m.
Z = 0.15
SQUARE = [[0, 0, Z], [0.03, 0, Z], [0.03, 0.03, Z], [0, 0.03, Z]]


def steps(points: Numbers, *, closed: bool = False) -> Numbers:
    """Returns the distances (T, M) between consecutive frames;
    with `closed`, also from the last to the first.
    """
    every = np.concatenate([points, points[:1]]) if closed else points
    return np.linalg.norm(np.diff(every, axis=0), axis=2)


def ring(**keywords: Any) -> path.Path:
    return path.circle([0.01, -0.02, Z], 0.02, **{"frequency": 50, **keywords})


def still(*places: float, pressures: Any = None, seconds: float = 0.1) -> path.Path:
    """Returns a path of points at rest on the x axis, at z = 0.15 m."""
    points = [[x, 0, Z] for x in places]
    return path.morph(points, points, duration=seconds, pressures=pressures)


HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">'
