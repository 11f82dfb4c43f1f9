"""Obstacles in a picture: where they cut its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._midair import Field

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Sines of the angle between a wall and a plane below which they count as parallel.
PARALLEL = 1e-9


def outline(field: Field, ax: Axes, axes: tuple[int, int]) -> None:
    """A line where a wall cuts the plane, solid of a rigid one and dashed of a soft one."""
    plane = field.plane
    assert plane is not None
    for wall in field.scene.obstacles:
        normal = np.asarray(wall.normal) / np.linalg.norm(wall.normal)
        across = normal[list(axes)]
        steep = float(across @ across)
        if steep < PARALLEL**2:
            continue
        # The foot of the plane's origin on the line n . (x - point) = 0.
        away = float(normal @ wall.point) - normal["xyz".index(plane.axis)] * plane.at
        foot = across * away / steep * 1e3
        along = foot + np.array([-across[1], across[0]]) / np.sqrt(steep)
        style = "-" if wall.kind == "rigid" else "--"
        ax.axline((foot[0], foot[1]), (along[0], along[1]), color="orange", linewidth=1.5, linestyle=style)
