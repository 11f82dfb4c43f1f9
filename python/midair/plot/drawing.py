"""What was drawn: wanted field, made field and their difference, for shapes and pictures of many points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .._midair import Field, Solution
from .colours import Quantity, colours, loud, of_pressures
from .panel import add_bar, paint, sides
from .sheet import HEADROOM
from .words import place

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure

#: Of so many points the distance to the nearest is looked for.
SAMPLE = 200

#: How many times as fine as the field the points are drawn.
FINER = 4

#: A scale of differences does not end below this part of that of pressures, or trifles would glare.
LEAST = 0.1


def is_drawing(field: Field, quantity: Quantity, least: int) -> bool:
    """Whether a picture tells more than marks: more points than `least`, all in the plane of the field."""
    assert field.shown is not None
    return quantity in ("pressure", "radiation") and len(field.shown) > least and bool(field.shown.all())


def wanted_made_difference(
    figure: Figure | SubFigure, field: Field, solution: Solution, quantity: Quantity
) -> None:
    """Three panels: targets, field, and what was made minus what was wanted at the points.

    Wanted and difference are known at the points alone: each is a square as wide as neighbours are apart,
    and all else is grey.
    """
    largest = float(solution.targets.max())
    top = max(largest, min(loud(field), HEADROOM * largest))
    scale = colours([field], quantity, loudest=top)
    wanted = of_pressures(field, solution.targets, scale)
    made = of_pressures(field, np.abs(solution.pressures).astype(np.float64), scale)
    nearest = nearest_points(field)
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    ends = (scale.bottom, scale.top)
    paint(field, axes[0], at_points(wanted, nearest), scale.map, ends)
    image = paint(field, axes[1], scale.values(field), scale.map, ends)
    apart = made - wanted
    end = min(max(float(np.abs(apart).max()), LEAST * scale.top), scale.top)
    difference = paint(field, axes[2], at_points(apart, nearest), "RdBu_r", (-end, end))
    for ax, title in zip(axes, ("wanted", f"made, {place(field)}", "made - wanted"), strict=True):
        ax.set_title(title, fontsize="medium")
    for ax in axes[1:]:
        ax.set_ylabel("")
        ax.tick_params(labelleft=False)
    add_bar(image, axes[1:2], scale)
    over, under = bool((apart > end).any()), bool((apart < -end).any())
    extend = {(True, True): "both", (True, False): "max", (False, True): "min"}.get((over, under), "neither")
    figure.colorbar(difference, ax=axes[2], fraction=0.046, pad=0.03, label=scale.label, extend=extend)


def at_points(values: NDArray[np.float64], nearest: NDArray[np.int64]) -> NDArray[np.float64]:
    """Values (M,) of the points where they are, masked where there is none near."""
    shown: NDArray[np.float64] = np.ma.masked_where(nearest < 0, values[nearest])
    return shown


def nearest_points(field: Field) -> NDArray[np.int64]:
    """The index of the point at each pixel of a picture finer than the field, -1 where there is none."""
    axes = sides(field)
    u, v = (_finer(getattr(field, "xyz"[axis])) for axis in axes)
    points = field.scene.points[:, axes]
    reach = max(_pitch(points) / 2, 2 * (u[1] - u[0]))
    found = np.full((len(v), len(u)), -1, dtype=np.int64)
    least = np.full(found.shape, np.inf)
    for index, (x, y) in enumerate(points.tolist()):
        columns = slice(*np.searchsorted(u, [x - reach, x + reach]).tolist())
        rows = slice(*np.searchsorted(v, [y - reach, y + reach]).tolist())
        away = (u[columns] - x) ** 2 + (v[rows, None] - y) ** 2
        nearer = away < least[rows, columns]
        least[rows, columns][nearer] = away[nearer]
        found[rows, columns][nearer] = index
    return found


def _finer(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """The middles of finer pixels over the same length."""
    step = samples[1] - samples[0]
    edge, count = samples[0] - step / 2, FINER * len(samples)
    middles: NDArray[np.float64] = edge + (np.arange(count) + 0.5) * step / FINER
    return middles


def _pitch(points: NDArray[np.float64]) -> float:
    """The median distance of points (M, 2) to the nearest other."""
    nearest = []
    for point in points[:: max(len(points) // SAMPLE, 1)]:
        away = np.hypot(*(points - point).T)
        nearest.append(away[away > 0].min(initial=np.inf))
    return float(np.median(nearest))
