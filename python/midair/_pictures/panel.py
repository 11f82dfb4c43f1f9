"""One panel: the image of a field in its plane, with marks at the points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Field, Mesh, Plane, Sphere, Wall
from . import words
from .colours import Axes, AxesImage, Colours, Figure, Map, SubFigure, loud

#: A wall and a plane are parallel if the sine of their angle is below this.
PARALLEL = 1e-9

#: Force arrows around a trap: range to each side in wavelengths, and number of arrows per side.
ARROWS, ACROSS = 0.6, 9

#: Edge colour of the points' marks.
POINT = "deepskyblue"

#: Lines of obstacles: styles of rigid and soft surfaces, colour, and width in points.
STYLES = {"rigid": "-", "soft": "--"}
COLOUR = "orange"
WIDTH = 1.5


def outline(field: Field, ax: Axes, axes: tuple[int, int]) -> None:
    """Draw a line where an obstacle cuts the plane: solid for a rigid one, dashed for a soft one."""
    plane = field.plane
    assert plane is not None
    for obstacle in field.scene.obstacles:
        draw = OUTLINES.get(type(obstacle))
        if draw is not None:
            draw(obstacle, plane, ax, axes)


def _wall(wall: Wall, plane: Plane, ax: Axes, axes: tuple[int, int]) -> None:
    normal = np.asarray(wall.normal) / np.linalg.norm(wall.normal)
    across = normal[list(axes)]
    steep = float(across @ across)
    if steep < PARALLEL**2:
        return
    # Nearest place to the plane's origin on the line n . (x - point) = 0.
    away = float(normal @ wall.point) - normal["xyz".index(plane.axis)] * plane.at
    foot = across * away / steep * 1e3
    along = foot + np.array([-across[1], across[0]]) / np.sqrt(steep)
    style = STYLES[wall.kind]
    ax.axline((foot[0], foot[1]), (along[0], along[1]), color=COLOUR, linewidth=WIDTH, linestyle=style)


def _sphere(sphere: Sphere, plane: Plane, ax: Axes, axes: tuple[int, int]) -> None:
    from matplotlib.patches import Circle

    away = sphere.center["xyz".index(plane.axis)] - plane.at
    if abs(away) < sphere.radius:
        middle = (1e3 * sphere.center[axes[0]], 1e3 * sphere.center[axes[1]])
        radius = 1e3 * np.sqrt(sphere.radius**2 - away**2)
        style = STYLES[sphere.kind]
        ax.add_patch(Circle(middle, radius, fill=False, edgecolor=COLOUR, linewidth=WIDTH, linestyle=style))


def _mesh(mesh: Mesh, plane: Plane, ax: Axes, axes: tuple[int, int]) -> None:
    from matplotlib.collections import LineCollection

    corners = mesh.vertices[mesh.faces]
    heights = corners[..., "xyz".index(plane.axis)] - plane.at
    above = heights >= 0
    cut = above.any(1) & ~above.all(1)
    corners, heights, above = corners[cut], heights[cut], above[cut]
    # Each face that is cut has one corner alone on one side of the plane.
    alone = np.where(above.sum(1) == 1, above.argmax(1), (~above).argmax(1))
    faces = np.arange(len(corners))
    ends = []
    for step in (1, 2):
        other = (alone + step) % 3
        part = heights[faces, alone] / (heights[faces, alone] - heights[faces, other])
        start = corners[faces, alone]
        ends.append(start + part[:, None] * (corners[faces, other] - start))
    lines = 1e3 * np.stack(ends, axis=1)[..., list(axes)]
    style = STYLES[mesh.kind]
    ax.add_collection(LineCollection(list(lines), colors=COLOUR, linewidths=WIDTH, linestyles=style))


#: The function that draws each kind of obstacle; other kinds are not drawn.
OUTLINES: dict[type, Callable[..., None]] = {Wall: _wall, Sphere: _sphere, Mesh: _mesh}


def is_shared(fields: Sequence[Field]) -> bool:
    """Return whether all fields have one plane, so that axis labels appear once per row and column."""
    planes = [field.plane for field in fields if field.plane]
    return len({(plane.axis, plane.size, plane.center) for plane in planes}) < 2


def shape(fields: Sequence[Field]) -> tuple[int, int]:
    """Return the columns and rows of the panels. Each trap has a column of its own."""
    count = len(fields)
    traps = count > 2 and not is_shared(fields) and fields[0].scene.signature is not None
    columns = count // 2 if traps else min(count, 4)
    return columns, -(-count // columns)


def grid(figure: Figure | SubFigure, fields: Sequence[Field], columns: int | None = None) -> list[Axes]:
    """Return axes for the panel of each field."""
    count, shared = len(fields), is_shared(fields)
    columns = columns or shape(fields)[0]
    rows = -(-count // columns)
    axes = figure.subplots(rows, columns, sharex=shared, sharey=shared, squeeze=False).flatten()
    for k, ax in enumerate(axes):
        ax.set_visible(k < count)
        # The lowest panel of a column may be in the last row but one.
        ax.tick_params(labelbottom=not shared or k + columns >= count)
    return list(axes[:count])


def draw(field: Field, ax: Axes, colours: Colours) -> AxesImage:
    """Draw the image and the points of a field."""
    ends = colours.bottom, colours.top
    if colours.quantity == "phase":
        # A phase jumps by 2 pi between samples, the pressure is smooth. It fades out where it is faint.
        pressure = _finer(_finer(field.pressure).T).T
        image = paint(field, ax, np.angle(pressure).astype(np.float64), colours.map, ends)
        image.set_alpha(np.sqrt(np.clip(np.abs(pressure) / max(loud(field), 1e-30), 0, 1)))
        ax.set_facecolor("white")
        _mark(ax, field, sides(field))
        return image
    image = paint(field, ax, colours.values(field), colours.map, ends)
    image.set_interpolation("bicubic")
    _mark(ax, field, sides(field))
    _push(ax, field, sides(field))
    return image


def _finer(rows: NDArray[np.complex64], times: int = 4) -> NDArray[np.complex64]:
    """Return rows with this many samples in place of each, linear between the middles of the old ones."""
    at = (np.arange(times * len(rows)) + 0.5) / times - 0.5
    at = np.clip(at, 0, len(rows) - 1)
    first = np.minimum(at.astype(np.intp), len(rows) - 2)
    part = (at - first)[:, None].astype(np.float32)
    finer: NDArray[np.complex64] = rows[first] * (1 - part) + rows[first + 1] * part
    return finer


def _push(ax: Axes, field: Field, axes: tuple[int, int]) -> None:
    """Draw the force on a bead around each trap in a vertical plane.

    The length of an arrow is the root of the force.
    """
    scene, solution = field.scene, field.solution
    if solution is None or not words.has_arrows(field):
        return
    reach = np.linspace(-ARROWS, ARROWS, ACROSS) * scene.wavelength
    places = np.zeros((ACROSS, ACROSS, 3))
    places[..., axes[0]], places[..., axes[1]] = np.meshgrid(reach, reach)
    for trap in scene.points[field.shown]:
        around = (trap + places).reshape(-1, 3)
        for wall in scene.obstacles:
            # Behind a wall is no sound.
            around = around[(around - wall.point) @ wall.normal * ((trap - wall.point) @ wall.normal) > 0]
        force = solution.gorkov(around).force[:, axes]
        size = np.linalg.norm(force, axis=1, keepdims=True)
        arrow = force / np.sqrt(np.maximum(size, 1e-30) * (size.max() or 1.0))
        ax.quiver(
            *(1e3 * around[:, axes]).T,
            *arrow.T,
            color="white",
            edgecolor="black",
            linewidth=0.3,
            angles="xy",
            scale_units="xy",
            scale=0.8e-3 / (reach[1] - reach[0]),
            width=0.007,
            pivot="mid",
        )


def sides(field: Field) -> tuple[int, int]:
    """Return the axes (0 to 2) that run across and up a field's plane."""
    assert field.plane is not None
    across, up = (axis for axis in range(3) if "xyz"[axis] != field.plane.axis)
    return across, up


def squares(plane: Plane) -> NDArray[np.float64]:
    """Return the places (pixels^2, 3) of a plane, row after row upwards."""
    axes = [plane.along(name) for name in "xyz"]
    across, up = (axis for axis in axes if axis is not None)
    first, second = (values.ravel() for values in np.meshgrid(across, up))
    columns = iter((first, second))
    parts = [np.full(len(first), plane.at) if axis is None else next(columns) for axis in axes]
    return np.stack(parts, axis=1)


def paint(field: Field, ax: Axes, values: NDArray[np.float64], colour_map: Map, ends: tuple[float, float]) -> AxesImage:
    """Draw values as an image in the plane of a field, with its obstacles.

    Parameters
    ----------
    values
        (pixels, pixels).
    ends
        Values at the two ends of the colour map.
    """
    return ax.imshow(
        values,
        origin="lower",
        extent=frame(field, ax),
        cmap=colour_map,
        vmin=ends[0],
        vmax=ends[1],
        interpolation="nearest",
    )


def frame(field: Field, ax: Axes) -> tuple[float, float, float, float]:
    """Prepare axes for the plane of a field, with its obstacles; return their left, right, bottom and top."""
    across, up = ("xyz"[axis] for axis in sides(field))
    u, v = (getattr(field, name) * 1e3 for name in (across, up))
    edge = (u[1] - u[0]) / 2
    ax.set_facecolor("lightgrey")
    ax.set(xlim=(u[0] - edge, u[-1] + edge), ylim=(v[0] - edge, v[-1] + edge), aspect="equal")
    outline(field, ax, sides(field))
    # Panels with shared axes are labelled only at the left and at the bottom.
    if ax.xaxis.get_tick_params()["labelbottom"]:
        ax.set_xlabel(f"{across} / mm")
    if ax.yaxis.get_tick_params()["labelleft"]:
        ax.set_ylabel(f"{up} / mm")
    return u[0] - edge, u[-1] + edge, v[0] - edge, v[-1] + edge


def add_bar(image: AxesImage, axes: Sequence[Axes], colours: Colours) -> None:
    """Add a colour bar for some panels."""
    one = len(axes) == 1
    bar = axes[0].figure.colorbar(
        image,
        ax=axes[0] if one else list(axes),
        fraction=0.046,
        pad=0.03 if one else 0.02,
        label=colours.label,
        extend=colours.extend,
    )
    if colours.quantity == "phase":
        bar.set_ticks([-np.pi, -np.pi / 2, 0, np.pi / 2, np.pi], labels=["-π", "-π/2", "0", "π/2", "π"])


def _mark(ax: Axes, field: Field, axes: tuple[int, int]) -> None:
    """Mark the points: dots in the plane, rings off it, crosses at quiet points; fainter off the plane."""
    points, shown = field.scene.points, field.shown
    assert shown is not None
    quiet = words.quiet(field)
    size = float(np.clip(400 / len(points), 3, 12))
    styles: list[tuple[NDArray[np.bool_], dict[str, Any]]] = [
        (shown & ~quiet, {"s": size, "facecolors": "white", "edgecolors": POINT}),
        (~shown & ~quiet, {"s": size, "facecolors": "none", "edgecolors": POINT}),
        (shown & quiet, {"s": 2 * size, "marker": "x", "color": "lime"}),
        (~shown & quiet, {"s": 2 * size, "marker": "x", "color": "lime", "alpha": 0.5}),
    ]
    for chosen, style in styles:
        if chosen.any():
            ax.scatter(*points[chosen][:, axes].T * 1e3, linewidths=0.9, **style)
