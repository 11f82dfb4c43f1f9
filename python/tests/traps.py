"""Traps in double precision: Gor'kov's potential by finite differences, arrays whose boards face each other,
and a direct optimisation of the stiffness.

Written from the definitions, without the core: Bruus, Lab on a Chip 12, 1014 (2012).
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

import midair
from oracle import Complex, Real

FREQUENCY, SOUND_SPEED, DENSITY = 40e3, 340.0, 1.223
WAVELENGTH = SOUND_SPEED / FREQUENCY
# FIRST gives a first derivative from eight samples with the spacing h = STEP. Its error is of order (k h)^8,
# which is below rounding at k h = 0.06.
STEP = WAVELENGTH / 100
SAMPLES = np.array([-4, -3, -2, -1, 1, 2, 3, 4])
FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 4 / 5, -1 / 5, 4 / 105, -1 / 280]) / STEP


def openmpd() -> tuple[Real, Real]:
    """Returns positions and normals of two OpenMPD boards of 16 x 16 at 10.5 mm,
    which face each other at 236.5 mm.
    """
    x = (np.arange(16) - 7.5) * 10.5e-3
    flat = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((16, 16))], axis=-1).reshape(-1, 3)
    height = [0, 0, 0.2365 / 2]
    up = np.broadcast_to([0.0, 0.0, 1.0], flat.shape)
    return np.concatenate([flat - height, flat + height]), np.concatenate([up, -up])


def tinylev() -> tuple[Real, Real]:
    """Returns positions and normals of a TinyLev: two caps of 36 on a sphere of 60 mm, facing its centre."""
    cap = [
        [r * np.cos(angle), r * np.sin(angle), -np.sqrt(60**2 - r**2)]
        for count, r in ((6, 10.3), (12, 20.5), (18, 30.0))
        for angle in 2 * np.pi * np.arange(count) / count
    ]
    positions = np.concatenate([cap, np.array(cap) * [1, 1, -1]]) * 1e-3
    return positions, -positions / np.linalg.norm(positions, axis=1, keepdims=True)


def factors(radius: float = 1e-3, density: float = 29.0, sound_speed: float = 900.0) -> tuple[float, float]:
    """Returns the factors of |p|^2 and |grad p|^2 (peak values) in Gor'kov's potential U."""
    volume = 4 / 3 * np.pi * radius**3
    f1 = 1 - DENSITY * SOUND_SPEED**2 / (density * sound_speed**2)
    f2 = 2 * (density - DENSITY) / (2 * density + DENSITY)
    return (
        volume * f1 / (4 * DENSITY * SOUND_SPEED**2),
        -volume * 3 / 8 * f2 / (DENSITY * (2 * np.pi * FREQUENCY) ** 2),
    )


def along(function: Callable[[Real], NDArray[Any]], points: Real) -> NDArray[Any]:
    """Returns the derivatives along x, y, z of a function of points (..., 3); they replace the last axis."""
    shifts = np.eye(3)[:, None] * SAMPLES[:, None] * STEP
    return np.tensordot(function(points[..., None, None, :] + shifts), FIRST, (points.ndim, 0))


def gorkov(pressure: Callable[[Real], Complex], points: Real, **particle: float) -> tuple[Real, Real, Real]:
    """Returns U (P,), force (P, 3) and second derivatives of U (P, 3, 3),
    all by differences of a pressure.
    """
    compression, motion = factors(**particle)

    def potential(at: Real) -> Real:
        return compression * abs(pressure(at)) ** 2 + motion * (abs(along(pressure, at)) ** 2).sum(axis=-1)

    def slope(at: Real) -> Real:
        return along(potential, at)

    return potential(points), -slope(points), along(slope, points)


def direct(positions: Real, points: Real, starts: list[Real]) -> Complex:
    """Returns the drive (N,) with |q| = 1 whose least stiffness is the largest that L-BFGS finds, for point
    sources.

    The least over M points and three axes is smoothed, with a decreasing width. U is quadratic in p and
    grad p, and the stiffness is a second difference of U, so the gradient by the phases is exact.
    """
    compression, motion = factors()
    h = WAVELENGTH / 50
    shifts = h * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    way = (points[:, None] + shifts)[:, :, None] - positions
    r = np.linalg.norm(way, axis=-1)
    k = 2 * np.pi / WAVELENGTH
    p = 4.386 / r * np.exp(1j * k * r)
    rows = np.concatenate(
        [p[..., None, :], np.moveaxis((p * (1j * k - 1 / r) / r)[..., None] * way, -1, -2)], axis=-2
    )
    scales = np.array([compression, motion, motion, motion])
    # The weights of U at seven places that give the stiffness along each axis.
    differences = np.concatenate([np.full((3, 1), -2.0), np.eye(3), np.eye(3)], axis=1) / h**2

    def smooth(phases: Real, sharpness: float, unit: float) -> tuple[float, Real]:
        q = np.exp(1j * phases)
        field = rows @ q
        stiffness = ((abs(field) ** 2 * scales).sum(axis=-1) @ differences.T) / unit
        least = stiffness.min()
        weight = np.exp(-sharpness * (stiffness - least))
        value = least - np.log(weight.sum()) / sharpness
        weight /= weight.sum()
        back = ((weight @ differences)[..., None] * scales * field).conj()
        gradient = 2 * (1j * q * np.tensordot(back, rows, 3)).real / unit
        return -value, -gradient

    found = []
    for start in starts:
        phases = start
        for sharpness in (4.0, 16.0, 64.0, 256.0):
            field = rows @ np.exp(1j * phases)
            stiffness = (abs(field) ** 2 * scales).sum(axis=-1) @ differences.T
            unit = max(stiffness.min(), abs(stiffness).max() / 100)
            options = {"maxiter": 150, "maxcor": 20}
            phases = minimize(
                smooth, phases, (sharpness, unit), jac=True, method="L-BFGS-B", options=options
            ).x
        found.append((-smooth(phases, 1e6, 1.0)[0], phases))
    return np.exp(1j * max(found, key=lambda pair: pair[0])[1])


def scattered(count: int, box: list[float], apart: float, seed: int) -> Real:
    """Returns random points in a box around the origin, with distances above `apart`."""
    rng = np.random.default_rng(seed)
    while True:
        points = rng.uniform(-1, 1, (count, 3)) * box
        gaps = np.linalg.norm(points[:, None] - points, axis=2) + np.eye(count)
        if gaps.min() > apart:
            return points


def least(scene: midair.Scene, drive: Any) -> Real:
    """Returns the least stiffness of each point over x, y and z."""
    return midair.gorkov(scene, drive).stiffness.min(axis=1)
