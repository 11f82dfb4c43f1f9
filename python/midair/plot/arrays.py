"""Arrays drawn: where their transducers are, in which order they are counted."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .._midair import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Panels of a row.
COLUMNS = 4


def arrays(named: Mapping[str, Array]) -> Figure:
    """A panel for each array, flat ones from above, others in perspective; colours go along the order."""
    from matplotlib.figure import Figure

    columns = min(len(named), COLUMNS)
    rows = -(-len(named) // columns)
    figure = Figure(figsize=(3.3 * columns + 0.9, 3.4 * rows + 0.4), layout="constrained")
    axes = []
    shades: Any = None
    for k, (name, array) in enumerate(named.items(), 1):
        places = array.positions * 1e3
        flat = bool(np.ptp(places[:, 2]) < 1e-6)
        ax: Any = figure.add_subplot(rows, columns, k, projection=None if flat else "3d")
        order = np.arange(len(places)) / max(len(places) - 1, 1)
        shown = places[:, :2] if flat else places
        size = 3e3 / max(len(places), 60)
        shade = {} if flat else {"depthshade": False}
        shades = ax.scatter(*shown.T, c=order, s=size, cmap="viridis", vmin=0, vmax=1, linewidths=0, **shade)
        ax.set_title(f"{name}\n{len(places)} transducers", fontsize="medium")
        ax.set_aspect("equal")
        ax.tick_params(labelsize="x-small")
        if flat:
            ax.margins(0.06)
        else:
            ax.locator_params(nbins=4)
        axes.append(ax)
    bar = figure.colorbar(shades, ax=axes, ticks=[0, 1], shrink=0.6, pad=0.02)
    bar.set_ticklabels(["first", "last"])
    figure.supxlabel("x, y (and z) in mm", fontsize="small")
    return figure
