"""Ears: a small box of quiet points, and the sound pressure level in it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Scene, Solution, field
from .._support.arguments import number, refused, vector

#: Default distance in m between quiet points: a quarter of the wavelength at 40 kHz, so that none is loud in
#: between.
STEP = 2e-3

#: Reference pressure of the level in Pa (rms): ISO 1683.
REFERENCE = 20e-6

#: Largest number of quiet points; no array can silence that many.
MOST_POINTS = 100_000


@dataclass(frozen=True, eq=False)
class Ear:
    """Box of quiet points; from `midair.ear`.

    Attributes
    ----------
    points : (M, 3) ndarray
        Points in m.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.grid(20, 20, 10e-3), [[0, 0, 0.15]], pressures=500)
    >>> ear = midair.ear([0.0, 0.1, 0.15])
    >>> before, after = midair.solve(scene), midair.solve(ear.quieten(scene))
    >>> bool(ear.spl(scene, after) < ear.spl(scene, before) - 20)
    True
    """

    points: NDArray[np.float64]

    def quieten(self, scene: Scene) -> Scene:
        """Return a scene with the box's points added, quiet: 0 Pa and weight 1.

        Parameters
        ----------
        scene : midair.Scene
            A scene. Missing pressures become the balanced level (`scene.reach().level`).

        Returns
        -------
        midair.Scene
            The scene with the box.

        Raises
        ------
        SceneError
            For a point nearer than lambda/100 to a transducer.
        TypeError
            If `scene` has another type.
        """
        if not isinstance(scene, Scene):
            raise TypeError(f"expected a midair.Scene first, not {type(scene).__qualname__}")
        own = scene.reach().level if scene.pressures is None else scene.pressures
        silence = np.zeros(len(self.points))
        weights = None if scene.weights is None else np.r_[scene.weights, silence + 1.0]
        points = np.r_[scene.points, self.points]
        return scene.replace(points=points, pressures=np.r_[own, silence], weights=weights)

    def spl(self, scene: Scene, drive: ArrayLike | Solution) -> float:
        """Return the highest sound pressure level at the box's points: 20 log10(|p|/sqrt(2)/20 uPa).

        Parameters
        ----------
        scene : midair.Scene
            Array, air and obstacles.
        drive : (N,) array_like or midair.Solution
            A drive, or a solution of the scene with or without the box.

        Returns
        -------
        float
            Level in dB; -inf in silence.

        Raises
        ------
        SceneError
            For a drive of another shape or not finite.
        """
        loudest = float(np.abs(field(scene, drive, self.points).pressure).max())
        return -np.inf if loudest == 0.0 else float(20 * np.log10(loudest / np.sqrt(2) / REFERENCE))


def ear(position: Any, *, size: float = 0.01, step: float = STEP) -> Ear:
    """Make a cube of quiet points around a position.

    Parameters
    ----------
    position : (3,) array_like
        Middle of the cube in m.
    size : float, optional
        Its side in m.
    step : float, optional
        Largest distance in m between neighbouring points: a quarter of a wavelength leaves nothing loud
        between them.

    Returns
    -------
    midair.Ear
        The points.

    Raises
    ------
    SceneError
        For a wrong position, size or step, and for too many points.

    See Also
    --------
    midair.exposure : levels at places, beside a limit.

    Notes
    -----
    Solvers with a tolerance of quiet points (`quiet=` of `uniform` and `best`) silence the cube to that part
    of the loudest point. The level is that of the remaining sound; what an ear can bear is another question.

    Examples
    --------
    >>> import midair
    >>> len(midair.ear([0.0, 0.1, 0.15], size=0.01, step=0.005).points)
    27
    """
    middle = vector("position", position)
    size, step = number("size", size, above=0), number("step", step, above=0)
    count = int(np.ceil(size / step * (1 - 1e-9))) + 1
    if count**3 > MOST_POINTS:
        raise refused("step", step, f"that makes {count**3} points, give at least {size / 45:.2g}")
    along = np.linspace(-size / 2, size / 2, count)
    return Ear(middle + np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3))
