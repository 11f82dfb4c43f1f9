"""Obstacles in a picture: where they cut its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._midair import Field, Mesh, Plane, Sphere, Wall

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Sines of the angle between a wall and a plane below which they count as parallel.
PARALLEL = 1e-9

#: Lines of rigid and soft surfaces.
STYLES = {"rigid": "-", "soft": "--"}
COLOUR = "orange"
WIDTH = 1.5


def outline(field: Field, ax: Axes, axes: tuple[int, int]) -> None:
    """A line where an obstacle cuts the plane, solid of a rigid one and dashed of a soft one."""
    plane = field.plane
    assert plane is not None
    for obstacle in field.scene.obstacles:
        if isinstance(obstacle, Wall):
            _wall(obstacle, plane, ax, axes)
        elif isinstance(obstacle, Sphere):
            _sphere(obstacle, plane, ax, axes)
        else:
            _mesh(obstacle, plane, ax, axes)


def _wall(wall: Wall, plane: Plane, ax: Axes, axes: tuple[int, int]) -> None:
    normal = np.asarray(wall.normal) / np.linalg.norm(wall.normal)
    across = normal[list(axes)]
    steep = float(across @ across)
    if steep < PARALLEL**2:
        return
    # The foot of the plane's origin on the line n . (x - point) = 0.
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
    # Of each face that is cut one corner lies alone on its side.
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
