"""Pictures of a sequence: |p| / target and phase changes over time, and the spectrum of the pressure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .._pictures.colours import MAPS
from .._support.text import counted
from .drives import blocks
from .felt import BANDS, rms, spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

    from .._pictures.colours import Map
    from .._pictures.figures import Size
    from .judged import JudgedFrames

#: The panels of a sequence's picture.
Panel = Literal["pressures", "changes", "spectrum"]
PANELS = get_args(Panel)

#: Largest numbers of columns and of rows of an image over time: about what a screen can show. Values are
#: combined, not skipped.
COLUMNS, ROWS = 1000, 250

#: Least range of the scale of |p| / target, relative to its top, so that an even sequence has nearly one
#: colour.
SPAN = 0.1


def motion(
    sequence: JudgedFrames,
    ax: Axes | None = None,
    *,
    cmap: Map | None = None,
    panels: Panel | Iterable[Panel] | None = None,
    size: Size | None = None,
) -> Figure:
    """Draw |p| / target of the points and phase changes over time, and the spectrum of |p|^2.

    Frames or transducers that share a cell show their least |p| / target and their largest change.
    """
    from .._pictures.figures import chosen, colour_map, head, new_figure, whole

    names = chosen(panels, PANELS, ax)
    colours = colour_map(cmap, MAPS["pressure"])
    if ax is not None:
        _draw(sequence, names[0], ax, colours)
        return whole(ax)
    heights = [HEIGHTS[name] for name in names]
    figure = new_figure(9.6, 0.6 + 2.3 * sum(heights), size)
    axes = figure.subplots(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
    for name, one in zip(names, axes, strict=True):
        _draw(sequence, name, one, colours)
    over_time = [one for name, one in zip(names, axes, strict=True) if name != "spectrum"]
    for one in over_time[:-1]:
        one.sharex(over_time[-1])
        one.tick_params(labelbottom=False)
        one.set_xlabel("")
    head(figure, *_heading(sequence))
    return figure


#: Heights of the panels, relative to each other.
HEIGHTS: dict[Panel, float] = {"pressures": 1.0, "changes": 1.3, "spectrum": 1.2}


def _draw(sequence: JudgedFrames, panel: Panel, ax: Axes, colours: Map) -> None:
    if panel == "pressures":
        _pressures(sequence, ax, colours)
    elif panel == "changes":
        _changes(sequence, ax, colours)
    else:
        _spectrum(sequence, ax)


def _edges(count: int, most: int) -> NDArray[np.intp]:
    """Return the boundaries of at most `most` groups of neighbours among `count` items."""
    return np.linspace(0, count, min(count, most) + 1).astype(np.intp)


def _heading(sequence: JudgedFrames) -> list[str]:
    metrics = sequence.metrics
    frames, count = sequence.targets.shape
    by = f", {sequence.solver}" if sequence.solver else ""
    seam = "" if metrics.seam is None else f", seam {metrics.seam:.3f} rad"
    return [
        f"{counted(frames, 'frame')} at {sequence.rate:g} Hz, {counted(count, 'point')}{by}",
        f"level {metrics.level:.3f}, uniformity {metrics.uniformity:.3f}, dip {metrics.dip:.3f}, "
        f"largest change {metrics.largest_change:.3f} rad{seam}, noise {metrics.noise:.0f} dB",
    ]


def _pressures(sequence: JudgedFrames, ax: Axes, colours: Map) -> None:
    edges = _edges(len(sequence), COLUMNS)
    there = sequence.targets > 0
    ratio = np.divide(sequence.pressures, sequence.targets, out=np.full(there.shape, np.inf), where=there)
    least = np.minimum.reduceat(ratio, edges[:-1], axis=0)
    shown = np.ma.masked_invalid(least.T)
    top = float(shown.max()) or 1.0
    bottom = min(float(shown.min()), (1 - SPAN) * top)
    # Points are numbered from 1 in pictures and tables.
    image = _waterfall(ax, shown, sequence, colours, (bottom, top), first=1)
    ax.set(ylabel="point")
    _bar(ax, image, "|p| / target")


def _changes(sequence: JudgedFrames, ax: Axes, colours: Map) -> None:
    count, edges = len(sequence.array), _edges(len(sequence), COLUMNS)
    largest = np.zeros((len(edges) - 1, count), np.float32)
    column = np.searchsorted(edges, np.arange(len(sequence)), side="right") - 1
    for frames in blocks(len(sequence), count):
        np.maximum.at(largest, column[frames], sequence.each_change(frames.start, frames.stop))
    # The red line of the bound must lie within the colour bar.
    top = max(float(largest.max()), 1.1 * (sequence.change or 0.0)) or 1.0
    rows = np.maximum.reduceat(largest.T, _edges(count, ROWS)[:-1], axis=0)
    image = _waterfall(ax, rows, sequence, colours, (0.0, top), count=count)
    ax.set(ylabel="transducer")
    bound = "" if sequence.change is None else " (red: bound)"
    bar = _bar(ax, image, f"phase change / rad{bound}")
    if sequence.change is not None:
        bar.ax.axhline(sequence.change, color="red", linewidth=2.5)


def _waterfall(
    ax: Axes,
    values: NDArray[Any],
    sequence: JudgedFrames,
    colours: Map,
    ends: tuple[float, float],
    *,
    first: int = 0,
    count: int | None = None,
) -> AxesImage:
    """Draw values (rows, columns) over time, for `count` items (default: rows) numbered from `first`."""
    from matplotlib.ticker import MaxNLocator

    ax.set_facecolor("lightgrey")
    ax.set_xlabel("time / ms")
    ax.yaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    low = first - 0.5
    return ax.imshow(
        values,
        aspect="auto",
        origin="lower",
        extent=(0.0, 1e3 * len(sequence) / sequence.rate, low, low + (count or len(values))),
        cmap=colours,
        vmin=ends[0],
        vmax=ends[1],
        interpolation="nearest",
    )


def _bar(ax: Axes, image: AxesImage, label: str) -> Any:
    return ax.figure.colorbar(image, ax=ax, pad=0.01, label=label)


def _spectrum(sequence: JudgedFrames, ax: Axes) -> None:
    """Draw the spectrum of the radiation pressure, averaged over the points that are present."""
    there = sequence.targets > 0
    values = (sequence.radiation * there).sum(axis=1) / np.maximum(there.sum(axis=1), 1)
    frequencies, lines = spectrum(values, sequence.rate)
    ax.plot(frequencies[1:], lines[1:], color="black", linewidth=0.9)
    for band, colour in zip(BANDS, ("tab:blue", "tab:orange"), strict=True):
        reported = f"{band[0]:g} to {band[1]:g} Hz: {rms(frequencies, lines, band):.3g} Pa rms"
        ax.axvspan(*band, color=colour, alpha=0.15, linewidth=0, label=reported)
    ax.axhline(lines[0], color="grey", linestyle="--", linewidth=0.9, label=f"static: {lines[0]:.3g} Pa")
    if lines[1:].any():
        ax.set(xscale="log", yscale="log")
    ax.set(xlabel="frequency / Hz", ylabel="radiation pressure / Pa")
    ax.grid(alpha=0.3)
    ax.legend(loc="best")
