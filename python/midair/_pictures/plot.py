"""Pictures of fields: in the planes through the points, and of several solutions side by side."""

from __future__ import annotations

from collections.abc import Sequence
from inspect import signature
from typing import TYPE_CHECKING, Any, Protocol, overload

import numpy as np

from .._midair import Field, Plane, Solution, field, stated
from .colours import MAPS, Quantity, colours, loud
from .panel import add_bar, draw, grid, shape
from .words import heading, level, marks, number, place, requested, scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .colours import Map
    from .figures import Size


class OwnPicture(Protocol):
    """Protocol of objects that draw their own figure, such as a `midair.Sequence`."""

    def plot(self, ax: Axes | None = None) -> Figure: ...


@overload
def plot(  # type: ignore[overload-overlap]
    what: Field | Solution,
    ax: Axes | None = None,
    *,
    plane: Plane | None = None,
    quantity: Quantity = "pressure",
    vmax: float | None = None,
    cmap: Map | None = None,
    size: Size | None = None,
) -> Axes: ...
@overload
def plot(
    what: OwnPicture,
    ax: Axes | None = None,
    *,
    plane: Plane | None = None,
    quantity: Quantity = "pressure",
    cmap: Map | None = None,
    size: Size | None = None,
) -> Figure: ...
def plot(
    what: Field | Solution | OwnPicture,
    ax: Axes | None = None,
    *,
    plane: Plane | None = None,
    quantity: Quantity = "pressure",
    vmax: float | None = None,
    cmap: Map | None = None,
    size: Size | None = None,
) -> Axes | Figure:
    """Draw a field on a plane, the field of a solution in the plane through its points, or a sequence.

    Parameters
    ----------
    what : midair.Field, midair.Solution, or anything with a method `plot`
        A `midair.Sequence` or a table of `midair.compare` is drawn by its own method `plot`, with the
        arguments that this method accepts.
    ax : matplotlib.axes.Axes, optional
        The axes to draw in; by default matplotlib's present ones.
    plane : midair.Plane, optional
        Plane of a solution's field, in place of those through its points.
    quantity : {"pressure", "radiation", "spl", "phase"}, optional
        |p| in Pa, the radiation pressure on a wall in Pa, the sound pressure level in dB, or the phase of p.
    vmax : float, optional
        Value at the top of the colour scale, in Pa or dB. By default the picture's largest value, without
        places (near transducers) twice as loud as all those within two wavelengths of the points.
    cmap : str or Colormap, optional
        A colour map of matplotlib; by default the quantity's own.
    size : float or (float, float), optional
        Size of a new figure in inches: its width, or (width, height).

    Returns
    -------
    matplotlib.axes.Axes or matplotlib.figure.Figure
        The (first) axes; the figure if `what` has a method `plot`.

    Raises
    ------
    SceneError
        If the quantity, the colour map or the size is invalid; for a field at points, or of a matrix.
    TypeError
        If `what` is of none of these types.

    Notes
    -----
    Points in the plane are dots, quiet ones crosses; rings are the projections of points outside of it. If
    the points lie in several planes, each plane has a panel if ax is left out.

    Examples
    --------
    >>> import midair
    >>> solution = midair.solve(midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]]))
    >>> axes = midair.plot(solution, quantity="spl")
    >>> axes.get_xlabel()
    'x / mm'
    """
    from .figures import head, whole

    if isinstance(what, Solution):
        if what.scene is None:
            raise stated(
                "solution", "is of a matrix", "a field needs a Scene, give midair.field(scene, solution)"
            )
        what = field(what.scene, what, plane)
    elif isinstance(what, Field) and plane is not None:
        raise stated("plane", "is for a solution", "a field has its own, leave it out")
    if not isinstance(what, Field):
        return _own(what, {"ax": ax, "plane": plane, "vmax": vmax, "cmap": cmap, "size": size}, quantity)
    if what.plane is None:
        raise stated("field", "is at single points", "a picture needs a midair.Plane")
    panels = what.panels
    axes = _window(panels, size) if ax is None else [ax]
    panels = panels[: len(axes)]
    picture(panels, axes, quantity, vmax=vmax, cmap=cmap)
    if len(axes) == 1:
        title(axes[0], what, heading(panels))
    else:
        for panel, place_ax in zip(panels, axes, strict=True):
            title(place_ax, panel)
        head(whole(axes[0]), *heading(panels))
    return axes[0]


def _own(what: Any, given: dict[str, Any], quantity: Quantity) -> Figure:
    """Return the figure that an object's own `plot` draws, with the arguments that the caller gave."""
    kind = type(what).__qualname__
    if not callable(getattr(what, "plot", None)):
        kinds = "a midair.Field, midair.Solution or midair.Sequence"
        raise TypeError(f"expected {kinds} first, not {kind}")
    given = {name: value for name, value in given.items() if value is not None}
    if quantity != "pressure":
        given["quantity"] = quantity
    known = signature(what.plot).parameters
    for name in given:
        if name not in known:
            raise stated("the picture", f"of a {kind} has no {name}", "leave it out")
    figure: Figure = what.plot(**given)
    return figure


def _window(panels: Sequence[Field], size: Size | None) -> list[Axes]:
    """Return pyplot's current axes if they are empty, else new ones for each panel."""
    import matplotlib.pyplot as plt

    from .figures import new_figure

    if plt.get_fignums() and size is None:
        figure = plt.gcf()
        if figure.axes and not plt.gca().has_data():
            return [plt.gca()]
        if not figure.axes:
            figure.set_layout_engine("constrained")
            return grid(figure, panels)
    columns, rows = shape(panels)
    sides = (6.4, 4.8) if len(panels) == 1 else (3.4 * columns + 0.9, 3.4 * rows + 1.0)
    return grid(new_figure(*sides, size, plt.figure), panels)


def picture(
    panels: Sequence[Field],
    axes: Sequence[Axes],
    quantity: Quantity,
    *,
    vmax: float | None = None,
    loudest: float | None = None,
    cmap: Map | None = None,
) -> None:
    """Draw fields of one scene into axes, with a common scale and one colour bar."""
    from .figures import colour_map

    if other := [ax for ax in axes if not hasattr(ax, "imshow")]:
        raise TypeError(
            f"ax is {other[0]!r}: give Axes of matplotlib; solution.plot().savefig(...) writes a file"
        )
    scale = colours(panels, quantity, vmax=vmax, loudest=loudest)
    scale = scale.by(colour_map(cmap, MAPS[quantity]))
    images = [draw(panel, ax, scale) for panel, ax in zip(panels, axes, strict=True)]
    add_bar(images[0], axes, scale)


def title(ax: Axes, field: Field, lines: Sequence[str] = ()) -> None:
    """Write the plane's name above a panel, below the lines of a heading. Journal styles have no heading."""
    from .figures import holding

    above = lines if holding() is None else []
    ax.set_title("\n".join([*above, place(field)]), fontsize="medium", wrap=True)


#: Largest ratio of the scale's top to the largest target; the colour bar has an arrow if values are higher.
HEADROOM = 1.5


def contact_sheet(
    fields: Sequence[Field],
    names: Sequence[str],
    quantity: Quantity = "pressure",
    *,
    ax: Axes | None = None,
    cmap: Map | None = None,
    size: Size | None = None,
) -> Figure:
    """Draw the field of each solution: one panel, or a row of panels if the points lie in several planes.

    Axes given by the caller get one panel: the first of the first field.
    """
    from .figures import head, holding, new_figure, whole

    rows = [field.panels for field in fields] if ax is None else [fields[0].panels[:1]]
    width = len(rows[0])
    columns = width if width > 1 else min(len(rows), 3)
    height = -(-len(rows) * width // columns)
    panels = [panel for row in rows for panel in row]
    figure = whole(ax) if ax else new_figure(3.6 * columns + 0.9, 3.7 * height + 0.6, size)
    axes = [ax] if ax else grid(figure, panels, columns)
    picture(panels, axes, quantity, loudest=common_top(rows), cmap=cmap)
    for k, (panel, panel_ax) in enumerate(zip(panels, axes, strict=True)):
        above = "" if k % width else names[k // width] if holding() else _title(panel, names[k // width])
        if width > 1:
            above = f"{above}\n{place(panel)}" if above else place(panel)
        panel_ax.set_title(above, fontsize="medium")
    first = fields[0]
    targets = [] if first.solution is None else [requested(first.solution.targets, first.scene)]
    if ax is None:
        reported = ", ".join([*targets, place(first)] if width == 1 else targets)
        head(figure, reported, marks(rows[0]))
    return figure


def common_top(rows: Sequence[Sequence[Field]]) -> float:
    """Return |p| at the top of the common scale, in Pa.

    It is the largest |p| of all methods, but at most HEADROOM times the largest target. Otherwise one method
    that overshoots would make all others black. If most methods overshoot, the median of all is the top.
    """
    tops = [max(map(loud, row)) for row in rows]
    targets = [solution.targets.max() for row in rows if (solution := row[0].solution) is not None]
    if not targets:
        return max(tops)
    return min(max(tops), max(HEADROOM * float(max(targets)), float(np.median(tops))))


def _title(field: Field, name: str) -> str:
    solution = field.solution
    if solution is None:
        return name
    metrics = solution.metrics
    numbers = f"accuracy {number(metrics.accuracy)}, sigma {number(metrics.sigma)}, {level(solution)}"
    return f"{name}{scale(solution)}\n{numbers}"
