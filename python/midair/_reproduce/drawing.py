"""Figures as PNG and SVG files, which are identical for identical numbers; fields of single scenes."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Plane, Scene, Solution
from .._pictures.figures import FONTS
from .._support import output
from .._support.arguments import without_warnings
from . import tables
from .scenes import PITCH, Method, Options, Z

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

#: Pixels per inch of a PNG.
RESOLUTION = 120

#: Transducers per side of the array of figs. 2 and 7.
SIDE = 36


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
    return Scene(Array.grid(SIDE, SIDE, PITCH, source_pressure=1e-3), points, target)


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
