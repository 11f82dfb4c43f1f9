"""Lines, circles and polylines."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from .._support.arguments import flag, number, refused, vector, vectors
from ._contour import STEP, Points, count, few, points_along, spaced


def line(start: ArrayLike, end: ArrayLike, *, step: float = STEP) -> Points:
    """Points (M, 3) in m from start to end, both included.

    start, end : (3,) in m
    step : between neighbours, in m

    Raises SceneError for an end that is the start, for numbers that are not in order, and for more points
    than 100000.
    """
    step = number("step", step, above=0)
    ends = np.stack([vector("start", start), vector("end", end)])
    if (ends[0] == ends[1]).all():
        raise refused("end", ends[1], "it is where the start is, give another point")
    return points_along([(ends, False)], step)


def circle(
    center: ArrayLike, radius: float, *, step: float = STEP, normal: ArrayLike = (0.0, 0.0, 1.0)
) -> Points:
    """Points (M, 3) in m of a circle around `center`, in the plane normal to `normal`.

    center : (3,) in m
    radius : in m
    step : between neighbours, in m
    normal : (3,), of any length

    The first lies along x, as far as the plane allows (else along y); the others follow counterclockwise,
    seen against the normal.

    Raises SceneError for a radius or step not above 0, a normal of no length, and for more points than
    100000.
    """
    step, radius = number("step", step, above=0), number("radius", radius, above=0)
    center, normal = vector("center", center), vector("normal", normal)
    across, up = axes(normal)
    few(2 * math.pi * radius, step)
    steps = count(2 * math.pi * radius, step)
    angles = 2 * math.pi * np.arange(steps) / steps
    ring = np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * up
    return spaced(center + radius * ring, step)


def axes(normal: Points) -> tuple[Points, Points]:
    """Unit vectors normal to `normal`: along x as far as it allows (else along y), and to the left."""
    size = math.hypot(*normal)
    if not 0 < size < math.inf:
        raise refused("normal", normal, "give a direction such as [0, 0, 1]")
    normal = normal / size
    # A normal along x leaves no direction along x in its plane.
    axis = np.eye(3)[0 if abs(normal[0]) < 0.999 else 1]
    across = axis - normal * (axis @ normal)
    across /= math.hypot(*across)
    return across, np.cross(normal, across)


def polyline(points: ArrayLike, *, step: float = STEP, closed: bool = False) -> Points:
    """Points (M, 3) in m along straight lines between `points` (K, 3), closed or not.

    points : (K, 3) in m
    step : between neighbours, in m
    closed : whether a line leads from the last back to the first

    The first of `points` is among them, and the last if they do not close; steps run on around corners.

    Raises SceneError for points that are all in one place, for numbers that are not in order, and for more
    points than 100000.
    """
    step, closed = number("step", step, above=0), flag("closed", closed)
    vertices = vectors("points", points)
    if (vertices == vertices[0]).all():
        raise refused("points", vertices, "they are all in one place, give different ones")
    return points_along([(vertices, closed)], step)
