"""The paper's scenes and methods. Pressures are in the paper's unit: eq. (5) with lengths in millimetres."""

import math
from dataclasses import dataclass, replace
from typing import Any

from .._midair import Array

Options = dict[str, Any]


@dataclass(frozen=True)
class Method:
    """A method, drawn as a curve or a panel.

    Its label names the rule that limits |q| to 1, because this rule has the largest effect.
    """

    key: str
    label: str
    solver: str
    options: Options
    colour: str
    #: Whether the paper compares this method. Others are drawn dashed and do not count in the verdicts.
    in_paper: bool = True


#: The paper's methods. Other options have defaults equal to the authors' settings; their code has no
#: balancing.
PAPER = (
    Method("greedy", "greedy, K=1 L=16, |q|=1", "greedy", {"balance": False}, "#d62728"),
    Method("lm", "LM, |q|=1", "lm", {"balance": False}, "#1f77b4"),
    Method("evd", "EVD, clamp", "evd", {"balance": False}, "#2ca02c"),
    Method("sdp", "SDP+BCD, raw moduli, normalize", "sdp", {"balance": False}, "#9467bd"),
    Method("gspat", "GS-PAT, clamp", "gspat", {"balance": False}, "#ff7f0e"),
)

GS = Method("gs", "GS, |q|=1", "gs", {"balance": False}, "#8c564b", False)

#: Greedy on the finest grid of phases and amplitudes that the paper mentions.
FINE = Method(
    "greedy-fine",
    "greedy, K=16 L=256, |q|≤1",
    "greedy",
    {"balance": False, "amplitudes": 16, "phases": 256},
    "#7f0000",
    False,
)

#: Greedy with the objective that the authors' code minimises instead of eq. (7).
L1 = Method(
    "greedy-l1",
    "greedy, l1, K=1 L=16, |q|=1",
    "greedy",
    {"balance": False, "objective": "l1"},
    "#ff9896",
    False,
)


#: midair's methods for even fields at the highest level.
EVEN = (
    Method("uniform", "uniform, |q|≤1", "uniform", {"aim": "max"}, "black", False),
    Method("best", "best, |q|≤1", "best", {"aim": "max"}, "dimgray", False),
)

#: The methods of figs. 3 and 4; of fig. 2: the paper's six, then midair's.
CURVES = (*PAPER, FINE, L1, GS, *EVEN)
PANELS = (*PAPER, GS, *EVEN)

#: The methods of figs. 5 and 6: greedy in fixed order, greedy by brute force, and the others.
FIXED: Options = {"balance": False, "order": "columns"}
TIMED = (
    replace(PAPER[0], options=FIXED),
    Method(
        "greedy-brute", "greedy, plain brute force", "greedy", {**FIXED, "objective": "l1"}, "#ff9896", False
    ),
    *PAPER[1:],
    GS,
    *EVEN,
)

#: Height of the points in m.
Z = 0.15

#: Numbers of points of figs. 3 and 4, and of fig. 5.
COUNTS = (2, 4, 8, 16, 32, 64)
MANY = (*COUNTS, 128, 256)

#: Transducers per side of the array of figs. 3 to 5.
SIDE = 20

#: Transducers per side of the arrays in fig. 6, and the number of points in fig. 6.
SIDES = (12, 16, 20, 24, 28, 32)
FIXED_COUNT = 64

PITCH = 0.01


def grid(side: int) -> dict[str, Any]:
    """Return a square array as the table of a scene file."""
    return {"grid": {"nx": side, "ny": side, "pitch": PITCH}, "source_pressure": 1e-3}


def reach(side: int) -> float:
    """Return p1, the pressure at (0, 0, Z) with all transducers in phase.

    It is 2.36066 for side 20 and 6.40341 for side 36.
    """
    array = Array.grid(side, side, PITCH, source_pressure=1e-3)
    return sum(array.source_pressure / math.dist(place, (0, 0, Z)) for place in array.positions.tolist())


def random_points(side: int, count: int) -> dict[str, Any]:
    """Return settings of a sweep's block: random points over an array, each with the target p1/sqrt(M)."""
    half = side * PITCH / 2
    target = reach(side) / math.sqrt(count)
    return {
        "array": grid(side),
        "medium": {},
        "count": count,
        "region": [[-half, half], [-half, half], [Z, Z]],
        "pressure": [target, target],
    }


def block(method: Method, count: int, seed: int, *, side: int = SIDE, drives: bool = False) -> dict[str, Any]:
    """Return the settings of a sweep's block: a method on random points."""
    own = {"solver": method.solver, "options": method.options, "seed": seed, "seeds": None, "drives": drives}
    return {**random_points(side, count), **own}


def smiley() -> list[list[float]]:
    """Return the points of fig. 2: 38 points on a circle, two eyes and a mouth."""
    circle = [(0.045, 2 * math.pi * i / 30) for i in range(30)]
    mouth = [(0.027, -math.pi * i / 7) for i in range(1, 7)]
    round_points = [[r * math.cos(angle), r * math.sin(angle), Z] for r, angle in circle + mouth]
    return [*round_points[:30], [-0.0135, 0.0135, Z], [0.0135, 0.0135, Z], *round_points[30:]]
