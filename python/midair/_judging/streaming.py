"""`midair.streaming`: the force per volume by which sound drives a flow of air (acoustic streaming)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Field, Plane, Scene, Solution, about, field, stated
from .._pictures.colours import MAPS, Axes, Map, Size
from .._pictures.panel import paint, sides, squares
from .._pictures.words import place
from .._support.arguments import number

#: Arrows per side, and the fraction of the largest force below which no arrow is drawn.
ARROWS, FAINT = 20, 0.05


#: Absorption of air in Np/m (1.3 dB/m), used if the scene has none, and the frequency range in Hz for which
#: it holds.
AIR, NEAR = 0.15, (35e3, 45e3)

#: Step of central differences, in wavelengths: the gradient has an error of 0.3 %.
PART = 0.02


@dataclass(frozen=True, eq=False)
class Streaming:
    """Body force of the sound on the air; from `midair.streaming`.

    Attributes
    ----------
    force : (pixels, pixels) or (P,) ndarray
        alpha |p|^2/(rho c^2) in N/m^3, in a plane or at points.
    direction : (..., 3) ndarray
        Unit vectors of the active intensity, along which the force acts; 0 where the intensity is 0.
    absorption : float
        The absorption alpha used, in Np/m.
    field : midair.Field
        The field from which the force is computed.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> midair.solve(scene).streaming(midair.Plane(z=0.15, size=0.1, pixels=20)).force.shape
    (20, 20)
    """

    force: NDArray[np.float64]
    direction: NDArray[np.float64]
    absorption: float
    field: Field

    def plot(self, ax: Axes | None = None, *, cmap: Map | None = None, size: Size | None = None) -> Axes:
        """Draw a map of the force in its plane, with arrows along it.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            The axes to draw in; by default matplotlib's present ones.
        cmap : str or Colormap, optional
            A colour map of matplotlib.
        size : float or (float, float), optional
            Size of a new figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        SceneError
            If the colour map or the size is invalid, and for forces at single points.
        """
        from .._pictures.figures import colour_map, new_figure

        field = self.field
        if field.plane is None:
            raise stated("the force", "is at single points", "a picture needs a midair.Plane")
        if ax is None:
            import matplotlib.pyplot as plt

            empty = size is None and plt.get_fignums() and not plt.gca().has_data()
            ax = plt.gca() if empty else new_figure(6.4, 4.8, size, plt.figure).subplots()
        top = float(self.force.max())
        image = paint(field, ax, self.force, colour_map(cmap, MAPS["pressure"]), (0.0, top or 1.0))
        image.set_interpolation("bicubic")
        across, up = sides(field)
        every = max(field.plane.pixels // ARROWS, 1)
        here = (slice(every // 2, None, every),) * 2
        names = field.x, field.y, field.z
        u, v = np.meshgrid(names[across], names[up])  # type: ignore[arg-type]
        strong = self.force[here] > FAINT * top
        ax.quiver(
            1e3 * u[here][strong],
            1e3 * v[here][strong],
            self.direction[here][strong][:, across],
            self.direction[here][strong][:, up],
            color="white",
            alpha=0.8,
            scale=1.3 * ARROWS,
            width=0.004,
        )
        ax.set_title(place(field), fontsize="medium")
        label = f"force / (N/m³), absorption {self.absorption:.3g} Np/m"
        ax.figure.colorbar(image, ax=ax, fraction=0.046, pad=0.03, label=label)
        return ax


def streaming(
    scene: Scene | Solution,
    drive: Any = None,
    plane: Plane | ArrayLike | None = None,
    *,
    absorption: float | None = None,
) -> Streaming:
    """Compute the force per volume that a wave leaves in the air that absorbs it.

    Parameters
    ----------
    scene : midair.Scene or midair.Solution
        A solution gives its scene and its drive: then `plane` comes second, or `solution.streaming(plane)`.
    drive : (N,) array_like or midair.Solution, optional
        The drive that plays.
    plane : midair.Plane or (P, 3) array_like, optional
        Places of the force; points are in m. By default the scene's plane, or one through its points.
    absorption : float, optional
        alpha in Np/m; by default the scene's, or 0.15 (air at 40 kHz, 1.3 dB/m) where it has none.

    Returns
    -------
    midair.Streaming
        The force in N/m^3 and its direction.

    Raises
    ------
    SceneError
        For a drive or points of another shape.
    TypeError
        If `scene` has another type.

    Notes
    -----
    F = alpha |p|^2/(rho c^2), which is 2 alpha I/c of a plane wave (Nyborg 1965), and only nearly that where
    waves cross at large angles. Its direction is that of the active intensity Im(conj(p) grad p), by central
    differences over lambda/25. Forces compare drives; the speed of the air is not computed here.

    Examples
    --------
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
    points = found.points if found.plane is None else squares(found.plane).reshape(*pressure.shape, 3)
    assert points is not None
    step = PART * scene.wavelength
    flow = np.empty(points.shape)
    for axis, aside in enumerate(step * np.eye(3)):
        ahead, behind = (
            field(scene, drive, (points + way * aside).reshape(-1, 3)).pressure.reshape(pressure.shape)
            for way in (1, -1)
        )
        flow[..., axis] = (pressure.conj() * (ahead.astype(complex) - behind)).imag
    length = np.linalg.norm(flow, axis=-1, keepdims=True)
    direction = np.divide(flow, length, out=np.zeros_like(flow), where=length > 0)
    return Streaming(force, direction, alpha, found)


def _absorption(scene: Scene, requested: float | None) -> float:
    if requested is not None:
        return number("absorption", requested, above=0)
    if scene.absorption > 0:
        return scene.absorption
    if not NEAR[0] <= scene.frequency <= NEAR[1]:
        cure = f"give that of the air in Np/m; {AIR:g} is for about 40 kHz"
        raise stated("absorption", f"is left out at {scene.frequency / 1e3:g} kHz", cure, code="missing")
    return AIR
