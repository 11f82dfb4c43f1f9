"""Contours of text and drawings, brought to their place; the core makes points along them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._midair import along

#: Coordinates (M, 3), or (K, 2) of a plane.
Points: TypeAlias = NDArray[np.float64]

#: Vertices of straight lines, and whether the last is joined to the first.
Contour: TypeAlias = tuple[Points, bool]

#: A curve becomes as many straight pieces: an arc of a whole turn strays by 3e-4 of its radius.
PIECES = 128


def points_along(contours: Iterable[Contour], step: float) -> Points:
    """Points (M, 3) along contours of vertices (K, 3)."""
    return along([np.concatenate([way, way[:1]]) if closed else way for way, closed in contours], step)


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
