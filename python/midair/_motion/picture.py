"""A sequence's picture: waterfalls of |p| / target and of phase changes, and a spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .drives import blocks
from .felt import BANDS, rms, spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

    from .judged import JudgedFrames

#: Columns and rows of a waterfall: no screen shows more, and what lies between would be lost.
COLUMNS, ROWS = 1000, 250


def motion(sequence: JudgedFrames) -> Figure:
    """Waterfalls over time, of |p| / target at the points and of phase changes, and the spectrum of |p|^2.

    Where frames or transducers share a cell it shows the least |p| / target and the largest change.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 8.6), layout="constrained")
    upper, middle, lower = figure.subplots(3, 1, height_ratios=(1.0, 1.3, 1.2))
    middle.sharex(upper)
    upper.tick_params(labelbottom=False)
    edges = _edges(len(sequence), COLUMNS)
    _pressures(sequence, upper, edges)
    _changes(sequence, middle, edges)
    _spectrum(sequence, lower)
    figure.suptitle(_heading(sequence), fontsize="medium")
    return figure


def _edges(count: int, most: int) -> NDArray[np.intp]:
    """Ends of at most so many groups of neighbours."""
    return np.linspace(0, count, min(count, most) + 1).astype(np.intp)


def _heading(sequence: JudgedFrames) -> str:
    metrics = sequence.metrics
    frames, count = sequence.targets.shape
    by = f", {sequence.solver}" if sequence.solver else ""
    seam = "" if metrics.seam is None else f", seam {metrics.seam:.3f} rad"
    return (
        f"{frames} frame{'s' * (frames > 1)} at {sequence.rate:g} Hz, {count} point{'s' * (count > 1)}{by}\n"
        f"level {metrics.level:.3f}, uniformity {metrics.uniformity:.3f}, dip {metrics.dip:.3f}, "
        f"largest change {metrics.largest_change:.3f} rad{seam}, noise {metrics.noise:.0f} dB"
    )


def _pressures(sequence: JudgedFrames, ax: Axes, edges: NDArray[np.intp]) -> None:
    there = sequence.targets > 0
    ratio = np.divide(sequence.pressures, sequence.targets, out=np.full(there.shape, np.inf), where=there)
    least = np.minimum.reduceat(ratio, edges[:-1], axis=0)
    shown = np.ma.masked_invalid(least.T)
    image = _waterfall(ax, shown, sequence, "magma", (0.0, float(shown.max()) or 1.0), there.shape[1])
    ax.set(ylabel="point")
    _bar(ax, image, "|p| / target")


def _changes(sequence: JudgedFrames, ax: Axes, edges: NDArray[np.intp]) -> None:
    count = len(sequence.array)
    largest = np.zeros((len(edges) - 1, count), np.float32)
    column = np.searchsorted(edges, np.arange(len(sequence)), side="right") - 1
    for frames in blocks(len(sequence), count):
        np.maximum.at(largest, column[frames], sequence.each_change(frames.start, frames.stop))
    top = max(float(largest.max()), sequence.change or 0.0) or 1.0
    rows = np.maximum.reduceat(largest.T, _edges(count, ROWS)[:-1], axis=0)
    image = _waterfall(ax, rows, sequence, "viridis", (0.0, top), count)
    ax.set(xlabel="time / ms", ylabel="transducer")
    bound = "" if sequence.change is None else " (red: bound)"
    bar = _bar(ax, image, f"phase change / rad{bound}")
    if sequence.change is not None:
        bar.ax.axhline(sequence.change, color="red", linewidth=2)


def _waterfall(
    ax: Axes,
    values: NDArray[Any],
    sequence: JudgedFrames,
    colours: str,
    ends: tuple[float, float],
    count: int,
) -> AxesImage:
    """Values (rows, columns) of `count` points or transducers over time."""
    from matplotlib.ticker import MaxNLocator

    ax.set_facecolor("lightgrey")
    ax.yaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    return ax.imshow(
        values,
        aspect="auto",
        origin="lower",
        extent=(0.0, 1e3 * len(sequence) / sequence.rate, -0.5, count - 0.5),
        cmap=colours,
        vmin=ends[0],
        vmax=ends[1],
        interpolation="nearest",
    )


def _bar(ax: Axes, image: AxesImage, label: str) -> Any:
    return ax.figure.colorbar(image, ax=ax, pad=0.01, label=label)


def _spectrum(sequence: JudgedFrames, ax: Axes) -> None:
    """Lines of the radiation pressure, in the mean over the points that are there."""
    there = sequence.targets > 0
    values = (sequence.radiation * there).sum(axis=1) / np.maximum(there.sum(axis=1), 1)
    frequencies, lines = spectrum(values, sequence.rate)
    ax.plot(frequencies[1:], lines[1:], color="black", linewidth=0.9)
    for band, colour in zip(BANDS, ("tab:blue", "tab:orange"), strict=True):
        told = f"{band[0]:g} to {band[1]:g} Hz: {rms(frequencies, lines, band):.3g} Pa rms"
        ax.axvspan(*band, color=colour, alpha=0.15, linewidth=0, label=told)
    ax.axhline(lines[0], color="grey", linestyle="--", linewidth=0.9, label=f"static: {lines[0]:.3g} Pa")
    if lines[1:].any():
        ax.set(xscale="log", yscale="log")
    ax.set(xlabel="frequency / Hz", ylabel="radiation pressure / Pa")
    ax.grid(alpha=0.3)
    ax.legend(loc="best", fontsize="small")
