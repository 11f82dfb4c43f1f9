"""A solution's picture: what was asked and got at each point, beside its field."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._midair import Solution, field
from .colours import Quantity, colours
from .drawing import is_drawing, wanted_made_difference
from .panel import add_bar, draw, grid
from .words import marks, number, place, solver, told

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: More points than this are dots: bars would run together.
MOST_BARS = 40


def answer(solution: Solution, *, quantity: Quantity = "pressure") -> Figure:
    """What was asked and got at each point, in Pa, and the field in the planes through the points.

    Of drawings, more than 40 points in one plane, the field has three panels: wanted, made, difference.

    quantity : what the field's picture shows: "pressure", "radiation", "spl" or "phase". Returns the figure.
    """
    from matplotlib.figure import Figure

    scene, metrics = solution.scene, solution.metrics
    panels = [] if scene is None else field(scene, solution).panels
    drawing = len(panels) == 1 and is_drawing(panels[0], quantity, MOST_BARS)
    if drawing:
        figure = Figure(figsize=(12.6, 7.2), layout="constrained")
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(4.4, 2.4)).flat
    elif len(panels) > 1:
        figure = Figure(figsize=(max(3.4 * len(panels) + 0.9, 8.0), 7.6), layout="constrained")
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(3.9, 3.2)).flat
    elif panels:
        figure = Figure(figsize=(11.0, 4.9), layout="constrained")
        upper, lower = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.0, 1.1)).flat
    else:
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        lower = figure
    if drawing:
        wanted_made_difference(upper, panels[0], solution, quantity)
    elif panels:
        axes = grid(upper, len(panels))
        paint = colours(panels, quantity)
        for panel, ax in zip(panels, axes, strict=True):
            image = draw(panel, ax, paint)
            ax.set_title(place(panel), fontsize="medium")
        add_bar(image, axes, paint)
    asked_and_got(solution, lower.subplots())
    numbers = f"accuracy {number(metrics.accuracy)}, sigma {number(metrics.sigma)}"
    lines = [
        solver(solution),
        f"{told(solution, scene)}, {numbers}",
        marks(panels) if panels and not drawing else "",
    ]
    figure.suptitle("\n".join(filter(None, lines)), fontsize="medium")
    return figure


def asked_and_got(solution: Solution, ax: Axes) -> None:
    """|p| at each point beside its target: bars, or dots where there are many."""
    from matplotlib.ticker import MaxNLocator

    got, targets = np.abs(solution.pressures), solution.targets
    index = np.arange(len(got))
    quiet = targets == 0
    for chosen, colour, label in ((~quiet, "tab:blue", "got"), (quiet, "tab:orange", "got at a quiet point")):
        if not chosen.any():
            continue
        if len(got) <= MOST_BARS:
            ax.bar(index[chosen], got[chosen], 0.7, color=colour, label=label)
        else:
            ax.plot(index[chosen], got[chosen], ".", color=colour, markersize=4, label=label)
    ax.hlines(targets, index - 0.5, index + 0.5, color="black", linewidth=1.2, label="asked")
    paper = solution.scene is not None and solution.scene.in_paper_unit
    ax.set(
        xlabel="point",
        ylabel="|p| in the paper's unit" if paper else "|p| / Pa",
        xlim=(-0.6, len(got) - 0.4),
        ylim=(0, 1.18 * max(got.max(), targets.max()) or 1.0),
    )
    ax.xaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    ax.grid(axis="y", alpha=0.3)
    ax.set_axisbelow(True)
    ax.legend(loc="upper right", ncols=3, fontsize="small")
