"""Gradients of the field at points, by a hand-written pass back through eq. (5), in double precision.

Each function takes a cotangent, dL/dvalue of a scalar L at each point, and returns the value and the
gradients of L, a `Gradient`. All else is constant: frequency, source pressure, directivity, responses,
absorption, density.

A complex number z has the gradient dL/dRe z + j dL/dIm z, the direction in which L rises, and so do
cotangents. PyTorch has the same convention, JAX the conjugate.

Examples
--------
>>> import midair
>>> array, points = midair.Array.preset("paper20"), [[0, 0, 0.15], [0.02, 0, 0.15]]
>>> drive = midair.solve(midair.Scene(array, points)).drive
>>> by = midair.grad.amplitude(array, drive, points, cotangent=[1, -1])
>>> by.drive.shape, by.points.shape, by.positions.shape
((400,), (2, 3), (400, 3))
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _midair
from ._midair import Array, Bead, Scene, Solution
from ._support import slips
from ._support.arguments import refused

__all__ = ["Gradient", "amplitude", "force", "gorkov", "pressure", "radiation", "stiffness"]

#: Names of the gradients, in the order in which the extension returns them.
NAMES = ("drive", "points", "positions", "normals", "sound_speed")

#: Types of the arguments.
_Subject = Scene | Array | Solution
_Drive = ArrayLike | Solution | None
_Points = ArrayLike | None
_Bead = Bead | Mapping[str, Any] | None


class Gradient(NamedTuple):
    """Value at M points, and the gradients of L = Re(sum of conj(cotangent) value).

    Attributes
    ----------
    value : (M,) or (M, 3) ndarray
        The quantity at the points.
    drive : (N,) ndarray of complex
        dL/dRe q + j dL/dIm q.
    points : (M, 3) ndarray
        dL by each point, per m.
    positions : (N, 3) ndarray
        dL by each transducer's position, per m.
    normals : (N, 3) ndarray
        dL by each unit normal along the sphere of directions; 0 of point sources.
    sound_speed : float
        dL by the sound speed, per m/s, at constant frequency.

    Examples
    --------
    >>> import midair
    >>> midair.grad.pressure(midair.Array([[0, 0, 0]]), [1], [[0, 0, 0.1]])._fields
    ('value', 'drive', 'points', 'positions', 'normals', 'sound_speed')
    """

    value: NDArray[np.complex128] | NDArray[np.float64]
    drive: NDArray[np.complex128]
    points: NDArray[np.float64]
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    sound_speed: float


def pressure(scene: _Subject, drive: _Drive = None, points: _Points = None, cotangent: ArrayLike = 1.0) -> Gradient:
    """Compute the complex pressure p in Pa of a drive at points, and its gradients.

    Parameters
    ----------
    scene : midair.Scene, midair.Array or midair.Solution
        A scene, an array in its own air, or a solution alone, which gives its drive, too.
    drive : (N,) array_like or midair.Solution, optional
        Complex drive of any modulus.
    points : (M, 3) array_like, optional
        Points in m; by default the scene's.
    cotangent : (M,) array_like, optional
        dL/dRe p + j dL/dIm p, complex, or one number for all points.

    Returns
    -------
    Gradient
        The pressures (M,) and the gradients of L.

    Raises
    ------
    SceneError
        For numbers of another shape or not finite, for spheres and meshes. For a point behind a wall, on a
        transducer, or in the plane of a transducer whose directivity breaks off there.

    Notes
    -----
    p_j = sum_i G_ji q_i: eq. (5) of Suzuki et al., IEEE Trans. Haptics 14, 914 (2021).

    Examples
    --------
    >>> import midair
    >>> by = midair.grad.pressure(midair.Array([[0, 0, 0]]), [1], [[0, 0, 0.1]], cotangent=1j)
    >>> bool(abs(by.drive[0]) == abs(by.value[0]))
    True
    """
    return _gradient("pressure", scene, drive, points, cotangent)


def amplitude(scene: _Subject, drive: _Drive = None, points: _Points = None, cotangent: ArrayLike = 1.0) -> Gradient:
    """Compute the amplitude |p| in Pa (peak) of a drive at points, and its gradients, 0 where p is 0.

    Parameters
    ----------
    scene, drive, points
        As for `pressure`.
    cotangent : (M,) array_like, optional
        dL/d|p|, real, or one number for all points.

    Returns
    -------
    Gradient
        The amplitudes (M,) and the gradients of L.

    Raises
    ------
    SceneError
        As for `pressure`.

    Examples
    --------
    >>> import midair
    >>> by = midair.grad.amplitude(midair.Array([[0, 0, 0]]), [1], [[0, 0, 0.1]])
    >>> round(float(by.value[0]), 6), round(float(by.points[0, 2]), 6)
    (43.86, -438.6)
    """
    return _gradient("amplitude", scene, drive, points, cotangent)


def radiation(scene: _Subject, drive: _Drive = None, points: _Points = None, cotangent: ArrayLike = 1.0) -> Gradient:
    """Compute the radiation pressure in Pa on a wall at normal incidence, and its gradients.

    Parameters
    ----------
    scene, drive, points
        As for `pressure`.
    cotangent : (M,) array_like, optional
        dL by the radiation pressure, real, or one number for all points.

    Returns
    -------
    Gradient
        The radiation pressures |p|^2/(rho c^2) (M,) and the gradients of L.

    Raises
    ------
    SceneError
        As for `pressure`.

    Examples
    --------
    >>> import midair
    >>> by = midair.grad.radiation(midair.Array([[0, 0, 0]]), [1], [[0, 0, 0.1]])
    >>> round(float(by.value[0] / (43.86**2 / (1.223 * 340**2))), 6)
    1.0
    """
    return _gradient("radiation", scene, drive, points, cotangent)


def gorkov(
    scene: _Subject, drive: _Drive = None, points: _Points = None, cotangent: ArrayLike = 1.0, *, bead: _Bead = None
) -> Gradient:
    """Compute the potential U in J of the force on a sphere at points, without the push of travelling waves.

    Parameters
    ----------
    scene, drive, points
        As for `pressure`.
    cotangent : (M,) array_like, optional
        dL/dU, real, or one number for all points.
    bead : midair.Bead or mapping, optional
        The sphere; by default the scene's. The gradient `sound_speed` is that of the air.

    Returns
    -------
    Gradient
        The potentials (M,) and the gradients of L.

    Raises
    ------
    SceneError
        As for `pressure`, and if the sphere's radius is 0.

    Examples
    --------
    >>> import midair
    >>> array, points = midair.Array.preset("paper20"), [[0, 0, 0.1]]
    >>> drive = midair.solve(midair.Scene(array, [[0.01, 0, 0.1]])).drive
    >>> by = midair.grad.gorkov(array, drive, points, bead={"radius": 2e-5})
    >>> force = midair.gorkov(midair.Scene(array, points), drive, bead={"radius": 2e-5}).force
    >>> bool(abs(by.points + force).max() < 0.01 * abs(force).max())
    True
    """
    return _gradient("gorkov", scene, drive, points, cotangent, bead)


def force(
    scene: _Subject, drive: _Drive = None, points: _Points = None, cotangent: ArrayLike = 1.0, *, bead: _Bead = None
) -> Gradient:
    """Compute the force of sound in N on a sphere at points, without its weight, and its gradients.

    Parameters
    ----------
    scene, drive, points
        As for `pressure`.
    cotangent : (M, 3) array_like, optional
        dL by the force, real, or one number for all points.
    bead : midair.Bead or mapping, optional
        The sphere, as for `gorkov`.

    Returns
    -------
    Gradient
        The forces (M, 3) and the gradients of L.

    Raises
    ------
    SceneError
        As for `gorkov`.

    Examples
    --------
    >>> import midair
    >>> by = midair.grad.force(midair.Array([[0, 0, 0]]), [1], [[0, 0, 0.1]], [[0, 0, 1]])
    >>> by.value.shape, by.points.shape
    ((1, 3), (1, 3))
    """
    return _gradient("force", scene, drive, points, cotangent, bead)


def stiffness(
    scene: _Subject, drive: _Drive = None, points: _Points = None, cotangent: ArrayLike = 1.0, *, bead: _Bead = None
) -> Gradient:
    """Compute the stiffness -dF/ds in N/m of a small sphere at points along x, y and z, and its gradients.

    Parameters
    ----------
    scene, drive, points
        As for `pressure`.
    cotangent : (M, 3) array_like, optional
        dL by the stiffness, real, or one number for all points.
    bead : midair.Bead or mapping, optional
        The sphere, as for `gorkov`.

    Returns
    -------
    Gradient
        The stiffnesses (M, 3) and the gradients of L.

    Raises
    ------
    SceneError
        As for `gorkov`.

    Examples
    --------
    >>> import midair
    >>> by = midair.grad.stiffness(midair.Array([[0, 0, 0]]), [1], [[0, 0, 0.1]], [[0, 0, 1]])
    >>> by.value.shape, by.drive.shape
    ((1, 3), (1,))
    """
    return _gradient("stiffness", scene, drive, points, cotangent, bead)


def _gradient(*call: Any) -> Gradient:
    """Return value and gradients; the arguments are those of the extension, the fifth is the cotangent."""
    if call[4] is None:
        raise refused("cotangent", None, "give dL by the value at each point, or one number for all")
    return Gradient(*_midair.gradient(*call))


def run(
    quantity: str, scene: _Subject, given: Mapping[str, Any], bead: _Bead, cotangent: ArrayLike | None = None
) -> tuple[Any, ...]:
    """Return the value of a quantity and, with a cotangent, its gradients.

    Parameters
    ----------
    given
        Drive and points; also positions, normals and sound_speed if they replace those of the scene.
    """
    points = np.asarray(given["points"], float)
    subject = scene
    if given.keys() - {"drive", "points"}:
        own: Any = scene.scene if isinstance(scene, Solution) else scene
        array: Any = own if isinstance(own, Array) else own.array
        air = dict(own.medium)
        if "sound_speed" in given:
            air["sound_speed"] = float(given["sound_speed"])
        if given.keys() & {"positions", "normals"}:
            places = (given.get("positions", array.positions), given.get("normals", array.normals))
            parts = {name: getattr(array, name) for name in _midair.array_parts()}
            array = Array(*(np.asarray(place, float) for place in places), **parts)
        bare = isinstance(own, Array)
        around: dict[str, Any] = {} if bare else {"obstacles": own.obstacles, "bead": own.bead}
        subject = Scene(array, points, **around, **air)
    drive = np.asarray(given["drive"])
    found = _midair.gradient(quantity, subject, drive, points, cotangent, bead)
    if len(found) > 1 and "normals" in given:
        # `Array` normalises the normals, so the gradient is divided by their lengths.
        length = np.linalg.norm(np.asarray(given["normals"], float), axis=1, keepdims=True)
        return (*found[:4], found[4] / length, found[5])
    return found


slips.attach(__name__)
