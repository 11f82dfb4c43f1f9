"""Trials of every fault: level and uniformity kept, a row a fault."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .table import PART, UNITS, Tolerance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: How far trials of one row lie apart, of the distance between rows: seen apart, not mixed up.
SPREAD = 0.3


def draw(tolerance: Tolerance) -> Figure:
    """A panel each for level and uniformity: every trial a dot, the mean a line, the 5 % quantile a tick."""
    from matplotlib.figure import Figure

    names = list(tolerance.rows)
    figure = Figure(figsize=(9, 1.8 + 0.5 * len(names)), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    aside = SPREAD * np.random.default_rng(0).uniform(-1, 1, tolerance.trials)
    for ax, what in zip(axes, ("level", "uniformity"), strict=True):
        for row, name in enumerate(names):
            values = getattr(tolerance.rows[name], what)
            ax.scatter(values, row + aside, s=6, alpha=0.35, linewidths=0, color="tab:blue")
            ax.vlines(values.mean(), row - 0.4, row + 0.4, color="black", label="" if row else "mean")
            worse = np.quantile(values, PART)
            ax.vlines(
                worse, row - 0.4, row + 0.4, color="tab:red", label="" if row else f"{PART:.0%} are worse"
            )
        ax.set(xlabel=f"{what} kept", xlim=(min(0.0, *ax.get_xlim()), None))
        ax.axvline(1, color="lightgrey", zorder=0)
        ax.grid(axis="x", alpha=0.3)
    labels = [
        f"{name}\n{UNITS[name].format(tolerance.faults[name])}" if name in UNITS else name for name in names
    ]
    axes[0].set_yticks(range(len(names)), labels)
    axes[0].invert_yaxis()
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    played = "a drive" if tolerance.solution is None else tolerance.solution.solver
    figure.suptitle(f"{played}, {tolerance.trials} trials a row", fontsize="medium")
    return figure
