"""Picture of a solution: target and pressure of each point, beside the field."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .._midair import Field, Plane, Solution, field
from .colours import Quantity, beyond, colours, loud, of_pressures
from .panel import add_bar, frame, grid, paint, shape, sides
from .plot import HEADROOM, picture, title
from .words import heading, marks, number, place, reported, solver

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure, SubFigure

    from .colours import Map
    from .figures import Size

#: Number of points for which the distance to the nearest other point is computed.
SAMPLE = 200

#: The scale of differences extends at least to this fraction of the pressures' scale; otherwise tiny errors
#: would look large.
LEAST = 0.1


def is_drawing(field: Field, quantity: Quantity, least: int) -> bool:
    """Return whether a field shows a drawing: more than `least` points, all in its plane."""
    assert field.shown is not None
    return quantity in ("pressure", "radiation") and len(field.shown) > least and bool(field.shown.all())


def wanted_made_difference(
    figure: Figure | SubFigure, field: Field, solution: Solution, quantity: Quantity
) -> None:
    """Draw three panels: targets, field, and their difference at the points.

    Targets and difference exist only at the points. Each point is a square as wide as the distance of
    neighbours; the rest is grey.
    """
    largest = float(solution.targets.max())
    top = max(largest, min(loud(field), HEADROOM * largest))
    scale = colours([field], quantity, loudest=top)
    wanted = of_pressures(field, solution.targets, scale)
    made = of_pressures(field, np.abs(solution.pressures).astype(np.float64), scale)
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    ends = (scale.bottom, scale.top)
    at_points(field, axes[0], wanted, scale.map, ends)
    image = paint(field, axes[1], scale.values(field), scale.map, ends)
    apart = made - wanted
    end = min(max(float(np.abs(apart).max()), LEAST * scale.top), scale.top)
    difference = at_points(field, axes[2], apart, "RdBu_r", (-end, end))
    for ax, name in zip(axes, ("wanted", f"made, {place(field)}", "made - wanted"), strict=True):
        ax.set_title(name, fontsize="medium")
    for ax in axes[1:]:
        ax.set_ylabel("")
        ax.tick_params(labelleft=False)
    add_bar(image, axes[1:2], scale)
    extend = beyond(bool((apart > end).any()), bool((apart < -end).any()))
    figure.colorbar(difference, ax=axes[2], fraction=0.046, pad=0.03, label=scale.label, extend=extend)


def at_points(
    field: Field, ax: Axes, values: NDArray[np.float64], colour_map: Map, ends: tuple[float, float]
) -> PolyCollection:
    """Draw values (M,) of the points in the plane of a field, each as a square of at least a sample."""
    from matplotlib.collections import PolyCollection

    left, right, *_ = frame(field, ax)
    places = 1e3 * field.scene.points[:, sides(field)]
    reach = max(_pitch(places), (right - left) / len(field.pressure)) / 2
    corners = places[:, None] + reach * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    drawn = PolyCollection(list(corners), array=values, cmap=colour_map, clim=ends)
    ax.add_collection(drawn)
    return drawn


def _pitch(points: NDArray[np.float64]) -> float:
    """Return the median distance of points (M, 2) to their nearest neighbours."""
    nearest = []
    for point in points[:: max(len(points) // SAMPLE, 1)]:
        away = np.hypot(*(points - point).T)
        nearest.append(away[away > 0].min(initial=np.inf))
    return float(np.median(nearest))


#: The panels of a solution's picture.
Panel = Literal["field", "points"]
PANELS = get_args(Panel)

#: More points than this are drawn as dots, because bars would overlap.
MOST_BARS = 40


def answer(
    solution: Solution,
    ax: Axes | None = None,
    *,
    plane: Plane | None = None,
    quantity: Quantity = "pressure",
    cmap: Map | None = None,
    panels: Panel | Iterable[Panel] | None = None,
    size: Size | None = None,
) -> Figure:
    """Draw targets and pressures of each point, in Pa, and the field in the planes through the points.

    Parameters
    ----------
    solution : midair.Solution
        The solution. With more than 40 points in a plane, the field has 3 panels: wanted, made, difference.
    ax : matplotlib.axes.Axes, optional
        Axes of your own for one panel, that of the field in the first plane if `panels` is left out.
    plane : midair.Plane, optional
        Plane of the field in place of those through the points.
    quantity : {"pressure", "radiation", "spl", "phase"}, optional
        Quantity in the field's picture.
    cmap : str or Colormap, optional
        A colour map of matplotlib; by default the quantity's own.
    panels : {"field", "points"} or list of them, optional
        The panels to draw; by default both, or the field alone for a single point.
    size : float or (float, float), optional
        Size of the figure in inches: its width, or (width, height).

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    SceneError
        If the quantity, the colour map, a panel or the size is invalid.
    """
    from .figures import chosen, head, new_figure, whole

    scene, metrics = solution.scene, solution.metrics
    known = PANELS if scene is not None else PANELS[1:]
    drawn = chosen(panels, known, ax)
    fields = [] if scene is None or "field" not in drawn else field(scene, solution, plane).panels
    if ax is not None:
        if fields:
            picture(fields[:1], [ax], quantity, cmap=cmap)
            title(ax, fields[0], heading(fields[:1]))
        else:
            requested_and_got(solution, ax)
        return whole(ax)
    drawing = len(fields) == 1 and is_drawing(fields[0], quantity, MOST_BARS)
    # For a single point the heading already contains the numbers of the bar.
    bars = ("points" in drawn and (panels is not None or len(solution.pressures) > 1)) or not fields
    if drawing:
        figure = new_figure(12.6, 7.2, size)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(4.4, 2.4)).flat
    elif not bars:
        columns, rows = shape(fields)
        figure = new_figure(3.8 * columns + 1.2, 3.6 * rows + 1.0, size)
        upper = figure
    elif len(fields) > 1:
        columns, rows = shape(fields)
        figure = new_figure(max(3.4 * columns + 0.9, 8.0), 3.6 * rows + 4.0, size)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(3.6 * rows + 0.3, 3.2)).flat
    elif fields:
        figure = new_figure(11.0, 4.9, size)
        upper, lower = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.0, 1.1)).flat
    else:
        figure = new_figure(6.4, 4.4, size)
        lower = figure
    if drawing:
        wanted_made_difference(upper, fields[0], solution, quantity)
    elif fields:
        axes = grid(upper, fields)
        picture(fields, axes, quantity, cmap=cmap)
        for panel, panel_ax in zip(fields, axes, strict=True):
            title(panel_ax, panel)
    if bars:
        requested_and_got(solution, lower.subplots())
    numbers = f"accuracy {number(metrics.accuracy)}, sigma {number(metrics.sigma)}"
    shown = marks(fields) if fields and not drawing else ""
    head(figure, solver(solution), f"{reported(solution, scene)}, {numbers}", shown)
    return figure


def requested_and_got(solution: Solution, ax: Axes) -> None:
    """Draw |p| and the target of each point, as bars, or as dots if there are many."""
    from matplotlib.ticker import MaxNLocator

    got, targets = np.abs(solution.pressures), solution.targets
    # Points are numbered from 1 in pictures and tables.
    index = np.arange(len(got)) + 1
    quiet = targets == 0
    for chosen, colour, label in ((~quiet, "tab:blue", "got"), (quiet, "tab:orange", "got at a quiet point")):
        if not chosen.any():
            continue
        if len(got) <= MOST_BARS:
            ax.bar(index[chosen], got[chosen], 0.7, color=colour, label=label)
        else:
            ax.plot(index[chosen], got[chosen], ".", color=colour, markersize=4, label=label)
    ax.hlines(targets, index - 0.5, index + 0.5, color="black", linewidth=1.2, label="target")
    scene = solution.scene
    unit = " in the paper's unit" if scene is not None and scene.in_paper_unit else " / Pa"
    ax.set(
        xlabel="point",
        ylabel=f"|p| of the focus that is a trap{unit}"
        if scene and scene.signature is not None
        else f"|p|{unit}",
        xlim=(0.4, len(got) + 0.6),
        ylim=(0, 1.18 * max(got.max(), targets.max()) or 1.0),
    )
    ax.xaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    ax.grid(axis="y", alpha=0.3)
    ax.set_axisbelow(True)
    ax.legend(loc="upper right", ncols=3)
