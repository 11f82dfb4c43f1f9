"""The paper's scenes, in its unit: eq. (5) in millimetres."""

from __future__ import annotations

import math
from typing import Any

from .._midair import Array

#: Height of the points, m.
Z = 0.15

#: Numbers of points of figs. 3 and 4, and of fig. 5.
COUNTS = (2, 4, 8, 16, 32, 64)
MANY = (*COUNTS, 128, 256)

#: Transducers along a side in fig. 6, and its number of points.
SIDES = (12, 16, 20, 24, 28, 32)
FIXED_COUNT = 64

PITCH = 0.01


def grid(side: int) -> dict[str, Any]:
    """A square array as in a scene file."""
    return {"grid": {"nx": side, "ny": side, "pitch": PITCH}, "source_pressure": 1e-3}


def reach(side: int) -> float:
    """p1: what the array makes at (0, 0, Z) with all in phase, 2.36066 for 20 and 6.40341 for 36."""
    array = Array.grid(side, side, PITCH, source_pressure=1e-3)
    return sum(array.source_pressure / math.dist(place, (0, 0, Z)) for place in array.positions.tolist())


def random_points(side: int, count: int) -> dict[str, Any]:
    """Random points over an array, each asked for p1/sqrt(M): settings of midair.sweep's blocks."""
    half = side * PITCH / 2
    target = reach(side) / math.sqrt(count)
    return {
        "array": grid(side),
        "medium": {},
        "count": count,
        "region": [[-half, half], [-half, half], [Z, Z]],
        "pressure": [target, target],
    }


def smiley() -> list[list[float]]:
    """Fig. 2: 38 points on a circle, two eyes and a mouth."""
    circle = [(0.045, 2 * math.pi * i / 30) for i in range(30)]
    mouth = [(0.027, -math.pi * i / 7) for i in range(1, 7)]
    round_points = [[r * math.cos(angle), r * math.sin(angle), Z] for r, angle in circle + mouth]
    return [*round_points[:30], [-0.0135, 0.0135, Z], [0.0135, 0.0135, Z], *round_points[30:]]
