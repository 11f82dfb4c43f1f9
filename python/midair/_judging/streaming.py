"""`midair.streaming`: the body force of the sound on the air, which drives acoustic streaming."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Field, Plane, Scene, SceneError, Solution, about, field
from .._pictures.colours import MAPS
from .._pictures.panel import paint, sides
from .._pictures.words import place
from .._support.arguments import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._pictures.colours import Map
    from .._pictures.sheet import Size

#: Arrows along a side, and the part of the largest force below which none is drawn.
ARROWS, FAINT = 20, 0.05


def draw(streaming: Streaming, ax: Axes | None, cmap: Map | None, size: Size | None) -> Axes:
    """The map."""
    from .._pictures.sheet import colour_map, sheet

    field = streaming.field
    if field.plane is None:
        raise SceneError("the force is at single points: a picture needs a midair.Plane")
    if ax is None:
        import matplotlib.pyplot as plt

        empty = size is None and plt.get_fignums() and not plt.gca().has_data()
        ax = plt.gca() if empty else sheet(6.4, 4.8, size, plt.figure).subplots()
    top = float(streaming.force.max())
    image = paint(field, ax, streaming.force, colour_map(cmap, MAPS["pressure"]), (0.0, top or 1.0))
    image.set_interpolation("bicubic")
    across, up = sides(field)
    every = max(field.plane.pixels // ARROWS, 1)
    here = (slice(every // 2, None, every),) * 2
    names = field.x, field.y, field.z
    u, v = np.meshgrid(names[across], names[up])  # type: ignore[arg-type]
    strong = streaming.force[here] > FAINT * top
    ax.quiver(
        1e3 * u[here][strong],
        1e3 * v[here][strong],
        streaming.direction[here][strong][:, across],
        streaming.direction[here][strong][:, up],
        color="white",
        alpha=0.8,
        scale=1.3 * ARROWS,
        width=0.004,
    )
    ax.set_title(place(field), fontsize="medium")
    label = f"force / (N/m³), absorption {streaming.absorption:.3g} Np/m"
    ax.figure.colorbar(image, ax=ax, fraction=0.046, pad=0.03, label=label)
    return ax


#: Absorption of air's amplitude in Np/m, 1.3 dB/m, and the frequencies in Hz for which it is taken.
AIR, NEAR = 0.15, (35e3, 45e3)

#: Differences are taken over this part of a wavelength on either side: the gradient errs by 0.3 %.
PART = 0.02


@dataclass(frozen=True, eq=False)
class Streaming:
    """Body force of the sound on the air, from `midair.streaming`.

    force : alpha |p|^2/(rho c^2) in N/m^3, (pixels, pixels) in a plane or (P,) at points
    direction : unit vectors (..., 3) of the active intensity, along which it pushes; 0 where there is none
    absorption : the alpha that it was reckoned with, in Np/m
    field : the `midair.Field` that it comes from
    """

    force: NDArray[np.float64]
    direction: NDArray[np.float64]
    absorption: float
    field: Field

    def plot(self, ax: Axes | None = None, *, cmap: Map | None = None, size: Size | None = None) -> Axes:
        """A map of the force in its plane, with arrows along it. Returns the axes.

        ax : the axes to draw in; left out, matplotlib's present ones
        cmap : a colour map of matplotlib or its name
        size : of a new figure in inches, its width or (width, height)

        Raises SceneError for another colour map or size, and for forces at single points.
        """
        return draw(self, ax, cmap, size)


def streaming(
    scene: Scene | Solution,
    drive: Any = None,
    plane: Plane | ArrayLike | None = None,
    *,
    absorption: float | None = None,
) -> Streaming:
    """The force per volume F = alpha |p|^2/(rho c^2) that a wave leaves in the air that absorbs it.

    scene : a Scene; or a Solution, which stands for its scene and its drive: then `plane` comes second, or
        `solution.streaming(plane)`
    drive : (N,), or a Solution
    plane : a midair.Plane, or points (P, 3) in m; left out, the scene's own, or one through its points
    absorption : alpha in Np/m; left out, the scene's, or 0.15 (air at 40 kHz, 1.3 dB/m) where it has none

    F is 2 alpha I/c of a plane wave of |p| (Nyborg 1965), and only nearly that where waves cross at large
    angles. Its direction is that of the active intensity Im(conj(p) grad p), by central differences over
    lambda/25. Forces compare drives; the speed of the air is not computed here.

    Raises SceneError for a drive or points of another shape, TypeError where scene is neither.

    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], source_pressure=4.386)
    >>> force = midair.streaming(scene, midair.solve(scene), [[0, 0, 0.15]])
    >>> bool(force.direction[0, 2] > 0.99)
    True
    """
    scene, drive, plane = about(scene, drive, plane)
    alpha = _absorption(scene, absorption)
    found = field(scene, drive, plane)
    pressure = found.pressure.astype(np.complex128)
    force = alpha * np.abs(pressure) ** 2 / (scene.density * scene.sound_speed**2)
    points = places(found)
    step = PART * scene.wavelength
    flow = np.empty(points.shape)
    for axis in range(3):
        aside = np.zeros(3)
        aside[axis] = step
        ahead, behind = (
            field(scene, drive, (points + way * aside).reshape(-1, 3)).pressure.reshape(pressure.shape)
            for way in (1, -1)
        )
        flow[..., axis] = (pressure.conj() * (ahead.astype(complex) - behind)).imag
    length = np.linalg.norm(flow, axis=-1, keepdims=True)
    direction = np.divide(flow, length, out=np.zeros_like(flow), where=length > 0)
    return Streaming(force, direction, alpha, found)


def places(field: Field) -> NDArray[np.float64]:
    """Where a field is known: points (..., 3) in m, in the shape of its pressure."""
    plane = field.plane
    if plane is None:
        assert field.points is not None
        return field.points
    points = np.empty((*field.pressure.shape, 3))
    across, up = (axis for axis in range(3) if "xyz"[axis] != plane.axis)
    sides = field.x, field.y, field.z
    points[..., "xyz".index(plane.axis)] = plane.at
    points[..., across], points[..., up] = np.meshgrid(sides[across], sides[up])  # type: ignore[arg-type]
    return points


def _absorption(scene: Scene, requested: float | None) -> float:
    if requested is not None:
        return number("absorption", requested, above=0)
    if scene.absorption > 0:
        return scene.absorption
    if not NEAR[0] <= scene.frequency <= NEAR[1]:
        raise SceneError(
            f"absorption is left out at {scene.frequency / 1e3:g} kHz: give that of the air in Np/m;"
            f" {AIR:g} is for about 40 kHz"
        )
    return AIR
