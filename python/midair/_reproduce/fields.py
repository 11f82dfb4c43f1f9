"""Fields of single scenes, for figs. 2 and 7."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Plane, Scene
from .._support.kept import Arrays
from .scenes import PITCH, Options, Z
from .tables import Rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

#: The array of figs. 2 and 7: 36 x 36.
SIDE = 36


def scene(points: list[list[float]], target: float) -> Scene:
    """Points over the paper's large array, each asked for the same."""
    return Scene(Array.grid(SIDE, SIDE, PITCH, source_pressure=1e-3), points, target)


def settings(points: list[list[float]], target: float, solver: str, options: Options, size: float) -> Options:
    """Settings of `solve_field`: a picture of size m in steps of 0.5 mm."""
    return {
        "points": points,
        "target": target,
        "solver": solver,
        "options": options,
        "size": size,
        "pixels": round(size / 0.5e-3) + 1,
    }


def solve_field(settings: Mapping[str, Any], start: int, stop: int) -> Arrays:
    """|p|^2 on the plane (1, pixels, pixels), |p| at the points (1, M), metrics (1,)."""
    asked = scene(settings["points"], settings["target"])
    solution = _midair.solve(asked, settings["solver"], **settings["options"])
    plane = Plane(Z, settings["size"], settings["pixels"])
    pressure = _midair.field(asked, solution.drive, plane).pressure
    names = ("accuracy", "sigma", "uniformity", "residual")
    return {
        "field": np.abs(pressure)[None].astype(np.float64) ** 2,
        "pressures": np.abs(solution.pressures)[None].astype(np.float64),
        **{name: np.array([getattr(solution.metrics, name)]) for name in names},
    }


def picture(axes: Axes, field: NDArray[np.float64], size: float, top: float) -> AxesImage:
    """|p|^2 in colours from 0 to top, lengths in mm."""
    edge = size * 500 * (1 + 1 / (len(field) - 1))
    axes.set(xlabel="x / mm", ylabel="y / mm")
    extent = (-edge, edge, -edge, edge)
    return axes.imshow(field, origin="lower", extent=extent, cmap="magma", vmin=0.0, vmax=top)


def pixels(fields: Mapping[str, NDArray[np.float64]]) -> Rows:
    """A row for each place: ix and iy in steps of 0.5 mm from the middle, and |p|^2 by each panel."""
    half = len(next(iter(fields.values()))) // 2
    indices = range(-half, half + 1)
    return [
        {"ix": x, "iy": y, **{name: float(field[y + half, x + half]) for name, field in fields.items()}}
        for y in indices
        for x in indices
    ]
