"""One panel: the image of a field in its plane, with the points marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .._midair import Field
from . import words
from .colours import Colours
from .obstacles import outline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure
    from matplotlib.image import AxesImage
    from numpy.typing import NDArray


def grid(figure: Figure | SubFigure, count: int, columns: int = 4) -> list[Axes]:
    """Axes for `count` panels that share theirs, each row's and column's labels once."""
    columns = min(count, columns)
    rows = -(-count // columns)
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).flatten()
    for k, ax in enumerate(axes):
        ax.set_visible(k < count)
        # The lowest panel of a column need not be in the lowest row.
        ax.tick_params(labelbottom=k + columns >= count)
    return list(axes[:count])


def draw(field: Field, ax: Axes, colours: Colours) -> AxesImage:
    """The image and the points of a field."""
    image = paint(field, ax, colours.values(field), colours.map, (colours.bottom, colours.top))
    _mark(ax, field, sides(field))
    return image


def sides(field: Field) -> tuple[int, int]:
    """Which coordinates run across and up a field's plane."""
    assert field.plane is not None
    across, up = (axis for axis in range(3) if "xyz"[axis] != field.plane.axis)
    return across, up


def paint(
    field: Field, ax: Axes, values: NDArray[np.float64], colour_map: str, ends: tuple[float, float]
) -> AxesImage:
    """An image in the plane of a field, with its obstacles.

    values : (pixels, pixels)
    ends : those at the ends of the colour map
    """
    across, up = ("xyz"[axis] for axis in sides(field))
    u, v = (getattr(field, name) * 1e3 for name in (across, up))
    edge = (u[1] - u[0]) / 2
    image = ax.imshow(
        values,
        origin="lower",
        extent=(u[0] - edge, u[-1] + edge, v[0] - edge, v[-1] + edge),
        cmap=colour_map,
        vmin=ends[0],
        vmax=ends[1],
        interpolation="nearest",
    )
    # Seen where a phase means nothing.
    ax.set_facecolor("lightgrey")
    ax.set(xlim=(u[0] - edge, u[-1] + edge), ylim=(v[0] - edge, v[-1] + edge))
    outline(field, ax, sides(field))
    # Inside a row or column that shares its axes the neighbours' labels will do.
    if ax.xaxis.get_tick_params()["labelbottom"]:
        ax.set_xlabel(f"{across} / mm")
    if ax.yaxis.get_tick_params()["labelleft"]:
        ax.set_ylabel(f"{up} / mm")
    return image


def add_bar(image: AxesImage, axes: Sequence[Axes], colours: Colours) -> None:
    """The colour bar of some panels."""
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
    """Dots at the points of the plane, rings at those off it, crosses at quiet ones; fainter off it."""
    points, shown = field.scene.points, field.shown
    assert shown is not None
    quiet = words.quiet(field)
    size = float(np.clip(400 / len(points), 3, 12))
    styles: list[tuple[NDArray[np.bool_], dict[str, Any]]] = [
        (shown & ~quiet, {"s": size, "facecolors": "white", "edgecolors": "deepskyblue"}),
        (~shown & ~quiet, {"s": size, "facecolors": "none", "edgecolors": "deepskyblue"}),
        (shown & quiet, {"s": 2 * size, "marker": "x", "color": "lime"}),
        (~shown & quiet, {"s": 2 * size, "marker": "x", "color": "lime", "alpha": 0.5}),
    ]
    for chosen, style in styles:
        if chosen.any():
            ax.scatter(*points[chosen][:, axes].T * 1e3, linewidths=0.9, **style)
