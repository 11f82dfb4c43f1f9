"""The paper's scenes and methods, and their pictures: PNG and SVG files, identical for identical numbers.

Pressures are in the paper's unit: eq. (5) with lengths in millimetres.
"""

import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Plane, Scene, Solution
from .._pictures.figures import FONTS
from .._support import output
from .._support.arguments import without_warnings
from . import tables

Options = dict[str, Any]


class Method(NamedTuple):
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
    PAPER[0]._replace(options=FIXED),
    Method("greedy-brute", "greedy, plain brute force", "greedy", {**FIXED, "objective": "l1"}, "#ff9896", False),
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

#: Transducers per side of the array of figs. 2 and 7.
LARGE = 36

PITCH = 0.01

#: Pixels per inch of a PNG.
RESOLUTION = 120


def reach(side: int) -> float:
    """Return p1, the pressure at (0, 0, Z) with all transducers in phase.

    It is 2.36066 for side 20 and 6.40341 for side 36.
    """
    array = Array.grid(side, side, PITCH, source_pressure=1e-3)
    return sum(array.source_pressure / math.dist(place, (0, 0, Z)) for place in array.positions.tolist())


def block(method: Method, count: int, seed: int, *, drives: bool = False) -> dict[str, Any]:
    """Return the settings of a sweep's block: a method on random points, each with the target p1/sqrt(M)."""
    half, target = SIDE * PITCH / 2, reach(SIDE) / math.sqrt(count)
    own = {"solver": method.solver, "options": method.options, "seed": seed, "seeds": None, "drives": drives}
    return own | {
        "array": {"grid": {"nx": SIDE, "ny": SIDE, "pitch": PITCH}, "source_pressure": 1e-3},
        "medium": {},
        "count": count,
        "region": [[-half, half], [-half, half], [Z, Z]],
        "pressure": [target, target],
    }


def smiley() -> list[list[float]]:
    """Return the points of fig. 2: 38 points on a circle, two eyes and a mouth."""
    circle = [(0.045, 2 * math.pi * i / 30) for i in range(30)]
    mouth = [(0.027, -math.pi * i / 7) for i in range(1, 7)]
    round_points = [[r * math.cos(angle), r * math.sin(angle), Z] for r, angle in circle + mouth]
    return [*round_points[:30], [-0.0135, 0.0135, Z], [0.0135, 0.0135, Z], *round_points[30:]]


def save(figure: Figure, folder: Path, name: str) -> None:
    """Write NAME.png and NAME.svg without a date or random identifiers."""
    for ending, metadata in (("png", {"Software": None}), ("svg", {"Date": None})):
        content = io.BytesIO()
        with mpl.rc_context({**FONTS, "svg.hashsalt": "midair"}):
            figure.savefig(content, format=ending, dpi=RESOLUTION, metadata=metadata)
        output.write(folder / f"{name}.{ending}", content.getvalue())


def lines(axes: Axes, rows: tables.Rows, methods: tuple[Method, ...], x: str, y: str) -> None:
    """Draw a curve for each method in the rows, with error bars if the rows have intervals."""
    for method in methods:
        mine = tables.pick(rows, method=method.key)
        if not mine:
            continue
        height = tables.column(mine, y)
        bars = [height - tables.column(mine, "low"), tables.column(mine, "high") - height]
        axes.errorbar(
            tables.column(mine, x),
            height,
            bars,
            label=method.label,
            color=method.colour,
            linestyle="-" if method.in_paper else "--",
            linewidth=1.6 if method.in_paper else 1.1,
            marker="o" if method.in_paper else ".",
            markersize=4,
            capsize=2.5,
        )
    ticks = sorted({row[x] for row in rows})
    axes.set_xscale("log")
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.grid(alpha=0.3)


def scene(points: list[list[float]], target: float) -> Scene:
    """Return a scene with points over the paper's large array and equal targets."""
    return Scene(Array.grid(LARGE, LARGE, PITCH, source_pressure=1e-3), points, target)


def solved(
    points: list[list[float]], target: float, solver: str, options: Options, size: float
) -> tuple[Solution, NDArray[np.float64]]:
    """Solve a scene; return the solution, and |p|^2 in a plane of `size` m in steps of 0.5 mm."""
    requested, plane = scene(points, target), Plane(Z, size, round(size / 0.5e-3) + 1)
    with without_warnings():
        solution = _midair.solve(requested, solver, **options)
        pressure = _midair.field(requested, solution.drive, plane).pressure
    return solution, np.abs(pressure).astype(np.float64) ** 2


def picture(axes: Axes, field: NDArray[np.float64], size: float, top: float) -> AxesImage:
    """Draw |p|^2 in colours from 0 to `top`, with lengths in mm."""
    edge = size * 500 * (1 + 1 / (len(field) - 1))
    axes.set(xlabel="x / mm", ylabel="y / mm")
    extent = (-edge, edge, -edge, edge)
    return axes.imshow(field, origin="lower", extent=extent, cmap="magma", vmin=0.0, vmax=top)


def pixels(fields: Mapping[str, NDArray[np.float64]]) -> tables.Rows:
    """Return a row for each place: ix and iy in steps of 0.5 mm from the centre, and |p|^2 of each panel."""
    half = len(next(iter(fields.values()))) // 2
    indices = range(-half, half + 1)
    return [
        {"ix": x, "iy": y, **{name: float(field[y + half, x + half]) for name, field in fields.items()}}
        for y in indices
        for x in indices
    ]
