"""Ears: a small box of quiet points, and the sound pressure level in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Scene, Solution, field
from .._support.arguments import number, refused, vector

#: Quiet points this far apart, in m, leave nothing loud between them: a quarter of the wavelength at 40 kHz.
STEP = 2e-3

#: The reference of the level, in Pa (root mean square): ISO 1683.
REFERENCE = 20e-6

#: Quiet points at most: more than any array silences.
MOST_POINTS = 100_000


@dataclass(frozen=True, eq=False)
class Ear:
    """A box of quiet points, from `midair.ear`.

    points : (M, 3) in m

    >>> import midair
    >>> scene = midair.Scene(midair.Array.grid(20, 20, 10e-3), [[0, 0, 0.15]], pressures=500)
    >>> ear = midair.ear([0.0, 0.1, 0.15])
    >>> before, after = midair.solve(scene), midair.solve(ear.quieten(scene))
    >>> bool(ear.spl(scene, after) < ear.spl(scene, before) - 20)
    True
    """

    points: NDArray[np.float64]

    def quieten(self, scene: Scene) -> Scene:
        """The scene with the box's points added, quiet: 0 Pa and weight 1.

        Where its pressures were left out, they become the balanced level (`scene.reach().level`).

        Raises SceneError for a point nearer than lambda/100 to a transducer; TypeError for what is no scene.
        """
        if not isinstance(scene, Scene):
            raise TypeError(f"expected a midair.Scene first, not {type(scene).__qualname__}")
        own = scene.reach().level if scene.pressures is None else scene.pressures
        silence = np.zeros(len(self.points))
        weights = None if scene.weights is None else np.r_[scene.weights, silence + 1.0]
        points = np.r_[scene.points, self.points]
        return scene.replace(points=points, pressures=np.r_[own, silence], weights=weights)

    def spl(self, scene: Scene, drive: ArrayLike | Solution) -> float:
        """The highest sound pressure level at the box's points: 20 log10(|p|/sqrt(2)/20 uPa) in dB.

        `drive` (N,), or a solution of the scene with or without the box. -inf in silence.

        Raises SceneError for a drive of another shape or not finite.
        """
        loudest = float(np.abs(field(scene, drive, self.points).pressure).max())
        return -np.inf if loudest == 0.0 else float(20 * np.log10(loudest / np.sqrt(2) / REFERENCE))


def ear(position: Any, *, size: float = 0.01, step: float = STEP) -> Ear:
    """A cube of quiet points around a position (3,) in m.

    size : its side in m
    step : between neighbouring points at most, in m: a quarter of a wavelength
        leaves nothing loud between them

    Solvers that hold quiet points to a tolerance (`quiet=` of `uniform` and `best`) silence it to that part
    of the loudest point. The level says what is left, not what an ear bears.

    Raises SceneError for a position, size or step that is not in order, and for too many points.
    """
    middle = vector("position", position)
    size, step = number("size", size, above=0), number("step", step, above=0)
    count = int(np.ceil(size / step * (1 - 1e-9))) + 1
    if count**3 > MOST_POINTS:
        raise refused("step", step, f"that makes {count**3} points, give at least {size / 45:.2g}")
    along = np.linspace(-size / 2, size / 2, count)
    return Ear(middle + np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3))
