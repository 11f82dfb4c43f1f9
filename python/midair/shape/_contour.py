"""Contours as points: even steps along each, and no two points nearer than half a step."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError

#: Coordinates (M, 3), or (K, 2) of a plane.
Points: TypeAlias = NDArray[np.float64]

#: Vertices of straight lines, and whether the last is joined to the first.
Contour: TypeAlias = tuple[Points, bool]

STEP = 340.0 / 40e3 / 4
"""The distance of neighbours where none is given, in m: a quarter of the wavelength at 40 kHz and 340 m/s."""

MOST_POINTS = 100_000
"""The most points of a shape or picture: more are a slip of the pen, or of its unit."""

#: A curve becomes as many straight pieces: an arc of a whole turn strays by 3e-4 of its radius.
PIECES = 128

#: Rounding of coordinates never decides whether two points are half a step apart.
ROUNDING = 1e-9


def points_along(contours: Iterable[Contour], step: float) -> Points:
    """Points (M, 3) along contours of vertices (K, 3)."""
    found = [(*measured(*contour), contour[1]) for contour in contours]
    few(sum(along[-1] for _, along, _ in found), step)
    return spaced(np.concatenate([_even(*contour, step) for contour in found]), step)


def few(length: float, step: float) -> None:
    """Refuse a length of so many steps that nobody means it."""
    if length / step > MOST_POINTS:
        cure = f"{length:.4g} m of contours would be more than {MOST_POINTS} points, give a larger one"
        raise SceneError(f"step is {step:.4g}: {cure}")


def count(length: float, step: float) -> int:
    """How many equal steps, as near to `step` as can be, make up a length."""
    return max(round(length / step), 1)


def spaced(points: Points, step: float) -> Points:
    """The points in their order, without those nearer than half a step to one before them."""
    least = step / 2 * (1 - ROUNDING)
    # Nearer than a cell's side are only points of this cell and of those around it.
    around = list(product((-1, 0, 1), repeat=3))
    cells: dict[tuple[int, int, int], list[Sequence[float]]] = {}
    kept = []
    places = zip(points.tolist(), np.floor(points / least).astype(np.int64).tolist(), strict=True)
    for index, (point, (x, y, z)) in enumerate(places):
        near = (other for i, j, k in around for other in cells.get((x + i, y + j, z + k), ()))
        if all(sum((a - b) ** 2 for a, b in zip(point, other, strict=True)) >= least**2 for other in near):
            cells.setdefault((x, y, z), []).append(point)
            kept.append(index)
    return points[kept]


def placed(contours: Iterable[Contour], scale: tuple[float, float], z: float) -> list[Contour]:
    """Contours (K, 2) of a plane, stretched and brought to a height, the middle of them all at x = y = 0."""
    contours = list(contours)
    least, most = box(contours)
    flat = [((vertices - (least + most) / 2) * scale, closed) for vertices, closed in contours]
    return [(np.column_stack([vertices, np.full(len(vertices), z)]), closed) for vertices, closed in flat]


def box(contours: Iterable[Contour]) -> tuple[Points, Points]:
    """The least and the largest coordinates of contours."""
    every = np.concatenate([vertices for vertices, _ in contours])
    return every.min(axis=0), every.max(axis=0)


def ways(straight: bool) -> Points:
    """Where on a straight or curved segment, from 0 to 1, its vertices are taken."""
    return np.linspace(0.0, 1.0, 2 if straight else PIECES + 1)


def measured(vertices: Points, closed: bool) -> tuple[Points, Points]:
    """The vertices, the first once more where the contour closes, and the way along it to each."""
    vertices = np.concatenate([vertices, vertices[:1]]) if closed else vertices
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(vertices, axis=0), axis=1))])
    return vertices, along


def reached(vertices: Points, along: Points, ways: Points) -> Points:
    """Where one is on a contour after each of `ways` (...) along it: (..., 3)."""
    return np.stack([np.interp(ways, along, axis) for axis in vertices.T], axis=-1)


def _even(vertices: Points, along: Points, closed: bool, step: float) -> Points:
    """Points at equal steps along a contour; the end of one that closes is its beginning."""
    steps = count(along[-1], step)
    at = along[-1] * np.arange(steps if closed else steps + 1) / steps
    return reached(vertices, along, at)
