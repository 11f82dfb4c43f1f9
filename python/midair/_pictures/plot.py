"""Pictures of fields, of a solution's points beside its field, and of several solutions side by side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from inspect import signature
from typing import TYPE_CHECKING, Any, Literal, Protocol, get_args, overload

import numpy as np
from numpy.typing import NDArray

from .._midair import Field, Plane, Solution, field, stated
from . import words
from .colours import KILO, MAPS, Axes, Figure, Map, Quantity, Size, SubFigure, beyond, colours, loud, of_pressures
from .panel import add_bar, draw, frame, grid, paint, shape, sides

if TYPE_CHECKING:
    from matplotlib.collections import PolyCollection


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
            cure = "a field needs a Scene, give midair.field(scene, solution)"
            raise stated("solution", "is of a matrix", cure)
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
        title(axes[0], what, words.heading(panels))
    else:
        for panel, place_ax in zip(panels, axes, strict=True):
            title(place_ax, panel)
        head(whole(axes[0]), *words.heading(panels))
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
    from .figures import check_axes, colour_map

    for ax in axes:
        check_axes(ax)
    scale = colours(panels, quantity, vmax=vmax, loudest=loudest)
    scale = scale.by(colour_map(cmap, MAPS[quantity]))
    images = [draw(panel, ax, scale) for panel, ax in zip(panels, axes, strict=True)]
    add_bar(images[0], axes, scale)


def title(ax: Axes, field: Field, lines: Sequence[str] = ()) -> None:
    """Write the plane's name above a panel, below the lines of a heading. Journal styles have no heading."""
    from .figures import holding

    above = lines if holding() is None else []
    ax.set_title("\n".join([*above, words.place(field)]), fontsize="medium", wrap=True)


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
            above = f"{above}\n{words.place(panel)}" if above else words.place(panel)
        panel_ax.set_title(above, fontsize="medium")
    first = fields[0]
    targets = [] if first.solution is None else [words.requested(first.solution.targets, first.scene)]
    if ax is None:
        reported = ", ".join([*targets, words.place(first)] if width == 1 else targets)
        head(figure, reported, words.marks(rows[0]))
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
    level = words.number(solution.metrics.level)
    return f"{name}{words.scale(solution)}\n{words.numbers(solution)}, level {level}"


#: Number of points for which the distance to the nearest other point is computed.
SAMPLE = 200

#: The scale of differences extends at least to this fraction of the pressures' scale; otherwise tiny errors
#: would look large.
LEAST = 0.1


def wanted_made_difference(figure: Figure | SubFigure, field: Field, solution: Solution, quantity: Quantity) -> None:
    """Draw three panels: targets, field, and their difference at the points.

    Targets and difference exist only at the points. Each point is a square as wide as the distance of
    neighbours; the rest is grey.
    """
    # Without requested pressures, the level that was found is the wanted one.
    targets = solution.targets * (1.0 if words.is_requested(solution) else solution.metrics.level)
    largest = float(targets.max())
    top = max(largest, min(loud(field), HEADROOM * largest))
    scale = colours([field], quantity, loudest=top)
    wanted = of_pressures(field, targets, scale)
    made = of_pressures(field, np.abs(solution.pressures).astype(np.float64), scale)
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    ends = (scale.bottom, scale.top)
    at_points(field, axes[0], wanted, scale.map, ends)
    image = paint(field, axes[1], scale.values(field), scale.map, ends)
    apart = made - wanted
    end = min(max(float(np.abs(apart).max()), LEAST * scale.top), scale.top)
    difference = at_points(field, axes[2], apart, "RdBu_r", (-end, end))
    for ax, name in zip(axes, ("wanted", f"made, {words.place(field)}", "made - wanted"), strict=True):
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

#: Largest deviation of |p| from the targets at which a request counts as met in a picture.
MET = 0.02

#: Most points whose numbers are written beside them, and their least distance as a part of the picture.
MOST_NAMES, NAME_ROOM = 8, 0.12

#: Colours of points and of quiet ones.
TEAL, AMBER = "#2b6f6b", "#c77d0a"


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
    """Draw the field in the planes through the points, and targets and pressures where the request is missed.

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
        The panels to draw; by default both. If each point is within 2 % of its target, the field alone: its
        plane z, with |p| at the points, and the upright plane through most of them.
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

    scene = solution.scene
    known = PANELS if scene is not None else PANELS[1:]
    drawn = chosen(panels, known, ax)
    fields = [] if scene is None or "field" not in drawn else field(scene, solution, plane).panels
    if ax is not None:
        if fields:
            picture(fields[:1], [ax], quantity, cmap=cmap)
            title(ax, fields[0], words.heading(fields[:1]))
        else:
            requested_and_got(solution, ax)
        return whole(ax)
    # A drawing: many points, all in one plane.
    inside = fields[0].shown if len(fields) == 1 else None
    many = inside is not None and len(inside) > MOST_BARS and bool(inside.all())
    drawing = many and quantity in ("pressure", "radiation")
    # If the request is met, the points' panel would show equal values: they are written beside the points.
    met = bool((solution.targets > 0).all()) and words.off(solution) < MET
    bars = ("points" in drawn and (panels is not None or not met)) or not fields
    if not bars and not drawing and panels is None and plane is None and len(fields) == 1:
        fields += upright(fields[0], solution)
    columns, rows = (3, 1) if drawing or not fields else shape(fields)
    width, height = 3.8 * columns + 1.2, 3.6 * rows + 1.0
    if not bars:
        figure = upper = new_figure(width, height, size)
    elif not fields:
        figure = lower = new_figure(6.4, 4.4, size)
    elif len(fields) == 1 and not drawing:
        figure = new_figure(11.0, 4.9, size)
        upper, lower = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.0, 1.1)).flat
    else:
        figure = new_figure(max(width, 8.0), height + 2.8, size)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(height, 2.8)).flat
    if drawing:
        wanted_made_difference(upper, fields[0], solution, quantity)
    elif fields:
        axes = grid(upper, fields)
        picture(fields, axes, quantity, cmap=cmap)
        named = np.zeros(len(solution.pressures), np.bool_)
        for panel, panel_ax in zip(fields, axes, strict=True):
            title(panel_ax, panel)
            named = name_points(panel_ax, panel, named)
        if quantity != "phase":
            wavelength_bar(axes[0], fields[0])
    if bars:
        requested_and_got(solution, lower.subplots())
    shown = words.marks(fields) if fields and not drawing else ""
    first, by = words.sentence(solution), words.solver(solution)
    lines = [first, f"{by}, {words.reported(solution)}, {words.numbers(solution)}"]
    head(figure, *(lines if bars else [f"{first}, {by}{words.scale(solution)}"]), shown)
    return figure


def upright(plan: Field, solution: Solution) -> list[Field]:
    """Return the field in the upright plane y through most points of a plane z, as large as that one."""
    plane, scene = plan.plane, plan.scene
    assert plane is not None
    if plane.axis != "z":
        return []
    rows, counts = np.unique(scene.points[:, 1].round(6), return_counts=True)
    # Beside the transducers |p| is larger than in every focus.
    top = float(scene.array.positions[:, 2].max())
    lowest = top + plane.size / 2 + scene.wavelength / 2
    z = max(plane.at, lowest) if plane.at > top else plane.at
    center = (float(plane.center[0]), z)
    at = float(rows[counts.argmax()])
    shown = Plane(axis="y", at=at, size=plane.size, pixels=plane.pixels, center=center)
    return [field(scene, solution, shown)]


def name_points(ax: Axes, field: Field, named: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Write the number of each point in the plane beside it, and |p| unless `named`, if there is room.

    Returns the points that are named now.
    """
    from matplotlib.patheffects import withStroke

    from .figures import holding

    assert field.plane is not None
    assert field.shown is not None
    solution, places = field.solution, 1e3 * field.scene.points[:, sides(field)]
    room = 1e3 * field.plane.size * NAME_ROOM
    if solution is None or (len(places) > 1 and _pitch(places) < room) or len(places) > MOST_NAMES:
        return named
    unmeant = named | field.scene.in_paper_unit | (field.scene.signature is not None)
    style: dict[str, Any] = {"color": "white", "textcoords": "offset points"}
    style["fontsize"] = "small" if holding() is None else "medium"
    style["path_effects"] = [withStroke(linewidth=2.2, foreground="black", alpha=0.8)]
    for k in np.flatnonzero(field.shown):
        number = str(k + 1) if len(places) > 1 else ""
        value = "" if unmeant[k] else words.pascals(float(abs(solution.pressures[k])))
        side, shift = ("right", -6) if places[k, 0] > np.mean(ax.get_xlim()) + room else ("left", 6)
        ax.annotate(f"{number}  {value}".strip(), places[k], (shift, 6), ha=side, **style)
    return named | field.shown


def wavelength_bar(ax: Axes, field: Field) -> None:
    """Draw a line of one wavelength in the lower right corner."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    length, x, y = 1e3 * field.scene.wavelength, right - 0.05 * (right - left), bottom + 0.05 * (top - bottom)
    ax.plot([x - length, x], [y, y], color="white", linewidth=2, solid_capstyle="butt")
    ax.text(x - length / 2, y + 0.01 * (top - bottom), "\u03bb", color="white", ha="center", va="bottom")


def requested_and_got(solution: Solution, ax: Axes) -> None:
    """Draw |p| of each point as a dot, with a stem from its target, which is a short line."""
    from matplotlib.ticker import MaxNLocator

    scene, got, targets = solution.scene, np.abs(solution.pressures), solution.targets
    # Points are numbered from 1 in pictures and tables.
    index, quiet = np.arange(len(got)) + 1, targets == 0
    top = float(max(got.max(), targets.max())) or 1.0
    unit = " in the paper's unit" if scene and scene.in_paper_unit else " / Pa"
    if top >= KILO and unit == " / Pa":
        got, targets, top, unit = got / 1e3, targets / 1e3, top / 1e3, " / kPa"
    size = 5.0 if len(got) <= MOST_BARS else 2.5
    for chosen, colour, marker, label in ((~quiet, TEAL, "o", "got"), (quiet, AMBER, "s", "got at a quiet point")):
        if chosen.any():
            ax.vlines(index[chosen], targets[chosen], got[chosen], color=colour, linewidth=1.1)
            ax.plot(index[chosen], got[chosen], marker, color=colour, markersize=size, label=label)
    # Without requested pressures, only the ratios of the targets are meant.
    if words.is_requested(solution) or scene is None:
        ax.hlines(targets, index - 0.3, index + 0.3, color="black", linewidth=1.2, label="target")
    ax.set(
        xlabel="point",
        ylabel=f"|p|{' of the focus that is a trap' if scene and scene.signature is not None else ''}{unit}",
        xlim=(0.4, len(got) + 0.6),
        ylim=(0, 1.25 * top),
    )
    ax.xaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    ax.grid(axis="y", alpha=0.3)
    ax.set_axisbelow(True)
    ax.legend(loc="upper right", ncols=3)
