"""Figures as PNG and SVG files, byte for byte the same for the same numbers."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure

from .._pictures.sheet import FONTS
from .._support import output
from . import tables
from .scenes import Method

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Pixels per inch of the PNG.
RESOLUTION = 120


def save(figure: Figure, folder: Path, name: str) -> None:
    """NAME.png and NAME.svg; no date and no random identifiers in them."""
    for ending, metadata in (("png", {"Software": None}), ("svg", {"Date": None})):
        content = io.BytesIO()
        with mpl.rc_context({**FONTS, "svg.hashsalt": "midair"}):
            figure.savefig(content, format=ending, dpi=RESOLUTION, metadata=metadata)
        output.write(folder / f"{name}.{ending}", content.getvalue())


def lines(axes: Axes, rows: tables.Rows, methods: tuple[Method, ...], x: str, y: str) -> None:
    """A curve for each method that the rows have; error bars where they have an interval."""
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
