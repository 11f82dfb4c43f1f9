"""The paper's scenes, in its unit: eq. (5) in millimetres."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from .._midair import Array, solvers

Options = dict[str, Any]


@dataclass(frozen=True)
class Method:
    """A curve or a panel. Its label names the rule that limits a drive to |q| <= 1, which decides most."""

    key: str
    label: str
    solver: str
    options: Options
    colour: str
    #: Whether the paper compares it; the others are drawn dashed and take no part in its statements.
    in_paper: bool = True


#: Every method's default is the setting of the authors' code; balancing was not known.
PAPER = (
    Method("greedy", "greedy, K=1 L=16, |q|=1", "greedy", {"balance": False}, "#d62728"),
    Method("lm", "LM, |q|=1", "lm", {"balance": False}, "#1f77b4"),
    Method("evd", "EVD, clamp", "evd", {"balance": False}, "#2ca02c"),
    Method("sdp", "SDP+BCD, raw moduli, normalize", "sdp", {"balance": False}, "#9467bd"),
    Method("gspat", "GS-PAT, clamp", "gspat", {"balance": False}, "#ff7f0e"),
)

GS = Method("gs", "GS, |q|=1", "gs", {"balance": False}, "#8c564b", False)

#: The finest grid that the paper mentions.
FINE = Method(
    "greedy-fine",
    "greedy, K=16 L=256, |q|≤1",
    "greedy",
    {"balance": False, "amplitudes": 16, "phases": 256},
    "#7f0000",
    False,
)

#: The objective that the authors' code minimises instead of eq. (7).
L1 = Method(
    "greedy-l1",
    "greedy, l1, K=1 L=16, |q|=1",
    "greedy",
    {"balance": False, "objective": "l1"},
    "#ff9896",
    False,
)


def even() -> tuple[Method, ...]:
    """Our methods for even fields at the highest level, as far as this build has them."""
    ours = (
        Method("uniform", "uniform, |q|≤1", "uniform", {"aim": "max"}, "black", False),
        Method("best", "best, |q|≤1", "best", {"aim": "max"}, "dimgray", False),
    )
    return tuple(method for method in ours if method.solver in solvers())


def curves() -> tuple[Method, ...]:
    """Figs. 3 and 4."""
    return (*PAPER, FINE, L1, GS, *even())


def panels() -> tuple[Method, ...]:
    """Fig. 2: the paper's six, then ours."""
    return (*PAPER, GS, *even())


def timed() -> tuple[Method, ...]:
    """Figs. 5 and 6: greedy in fixed order, and by plain brute force, as for absolute errors."""
    fixed = {"balance": False, "order": "columns"}
    first, *others = PAPER
    greedy = Method(first.key, first.label, "greedy", fixed, first.colour)
    brute = Method(
        "greedy-brute", "greedy, plain brute force", "greedy", {**fixed, "objective": "l1"}, "#ff9896", False
    )
    return (greedy, brute, *others, GS, *even())


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
    """p1: the pressure at (0, 0, Z) with all transducers in phase, 2.36066 for 20 and 6.40341 for 36."""
    array = Array.grid(side, side, PITCH, source_pressure=1e-3)
    return sum(array.source_pressure / math.dist(place, (0, 0, Z)) for place in array.positions.tolist())


def random_points(side: int, count: int) -> dict[str, Any]:
    """Random points over an array, each with the target p1/sqrt(M): settings of midair.sweep's blocks."""
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
