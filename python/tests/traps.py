"""Traps in double precision: the force of sound on a sphere, arrays whose boards face each other, and a
direct optimisation of the stiffness.

Written from the definitions, without the core: partial waves of a sphere of fluid (Anderson, J. Acoust. Soc.
Am. 22, 426, 1950), up to the quadrupole.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import spherical_jn, spherical_yn

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


def pairs(radius: float = 1e-3, density: float = 29.0, sound_speed: float = 900.0, orders: int = 3) -> Complex:
    """Returns s_n + s_(n+1)* + 2 s_n s_(n+1)* of the partial waves s_n, for the first orders n."""
    k, inside, n = 2 * np.pi / WAVELENGTH, 2 * np.pi * FREQUENCY / sound_speed, np.arange(orders + 1)
    gain = DENSITY * inside / (density * k) * spherical_jn(n, inside * radius, derivative=True)
    gain /= spherical_jn(n, inside * radius)
    regular = spherical_jn(n, k * radius, derivative=True) - gain * spherical_jn(n, k * radius)
    other = spherical_yn(n, k * radius, derivative=True) - gain * spherical_yn(n, k * radius)
    s = -regular / (regular + 1j * other)
    return s[:-1] + s[1:].conj() + 2 * s[:-1] * s[1:].conj()


@cache
def response(**particle: float) -> Complex:
    """Returns C (3,) in F_i = Re[C_0 p* p_i + C_1 p_j* p_ij + C_2 p_jk* p_ijk], p_i = dp/dx_i."""
    k = 2 * np.pi / WAVELENGTH
    w = 1j * pairs(**particle).conj()
    c = np.array([w[0] + w[1].conj() - 1.5 * w[2], 3 * (w[1] + w[2].conj()) / k**2, 7.5 * w[2] / k**4])
    return c * 2 * np.pi / (DENSITY * SOUND_SPEED**2 * k**3)


def force(waves: Complex, ways: Real, **particle: float) -> Real:
    """Returns the force (..., 3) of waves of amplitudes (N,) from point sources, at distances (..., N, 3)."""
    r, one = np.linalg.norm(ways, axis=-1), np.eye(3)
    v = 2j * np.pi / WAVELENGTH * r
    p = waves * np.exp(v) / r
    p1, p2 = p * (v - 1) / r**2, p * (v**2 - 3 * v + 3) / r**4
    p3 = p * (v**3 - 6 * v**2 + 15 * v - 15) / r**6
    both = (ways[..., :, None] * ways[..., None, :]).reshape(*ways.shape[:-1], 9)
    slope, square, bend = ((p[..., None, :] @ to)[..., 0, :] for p, to in ((p1, ways), (p2, ways), (p2, both)))
    cube = ((p3[..., None] * ways).swapaxes(-1, -2) @ both).reshape(*slope.shape, 3, 3)
    bend = bend.reshape(*slope.shape, 3) + p1.sum(axis=-1)[..., None, None] * one
    for sides in ("...a,bc->...abc", "...b,ac->...abc", "...c,ab->...abc"):
        cube = cube + np.einsum(sides, square, one)
    c = response(**particle)
    felt = c[0] * p.sum(axis=-1)[..., None].conj() * slope
    felt = felt + c[1] * np.einsum("...b,...ab->...a", slope.conj(), bend)
    return (felt + c[2] * np.einsum("...bc,...abc->...a", bend.conj(), cube)).real


def along(function: Callable[[Real], NDArray[Any]], points: Real) -> NDArray[Any]:
    """Returns the derivatives along x, y, z of a function of points (..., 3); they replace the last axis."""
    shifts = np.eye(3)[:, None] * SAMPLES[:, None] * STEP
    return np.tensordot(function(points[..., None, None, :] + shifts), FIRST, (points.ndim, 0))


class Drag:
    """The drag of still air in steps of length h: Stokes' friction, Schiller and Naumann's addition for the
    velocity of the wake, w' = |u|/(2 a) (u - w), and the whole of Basset's integral, with a constant
    acceleration in each earlier step.
    """

    def __init__(self, radius: float, viscosity: float, speed: Real, step: float, steps: int) -> None:
        self.radius, self.step, self.wake = radius, step, np.array(speed, float)
        self.friction = 6 * np.pi * viscosity * radius
        self.reynolds = 2 * radius * DENSITY / viscosity
        self.history = 6 * radius**2 * np.sqrt(np.pi * DENSITY * viscosity)
        self.gains = np.zeros((steps, *np.shape(speed)))
        self.done = 0

    def acceleration(self, force: Real, speed: Real, mass: float, part: float) -> Real:
        """Returns u' at a part of the step, by a force (..., 3) in addition to the drag."""
        size = np.linalg.norm(self.wake, axis=-1, keepdims=True)
        drag = self.friction * (speed + 0.15 * (self.reynolds * size) ** 0.687 * self.wake)
        ages = (self.done - np.arange(self.done + 1) + part) * self.step
        roots = np.sqrt(ages)
        past = 2 * np.tensordot(roots[:-1] - roots[1:], self.gains[: self.done], 1)
        return (force - drag - self.history * past) / (mass + 2 * self.history * roots[-1])

    def passed(self, before: Real, speed: Real) -> None:
        """Ends a step in which the velocity changes from `before` to `speed`."""
        self.gains[self.done] = (speed - before) / self.step
        self.done += 1
        size = np.linalg.norm(speed, axis=-1, keepdims=True)
        self.wake = speed + (self.wake - speed) * np.exp(-size * self.step / (2 * self.radius))


def felt(pressure: Callable[[Real], Complex], points: Real, **particle: float) -> tuple[Real, Real, Real]:
    """Returns the potential (P,), the force (P, 3) and the symmetric part of its slope (P, 3, 3), by
    differences of a pressure.
    """
    c = response(**particle)

    def first(at: Real) -> Complex:
        return along(pressure, at)

    def second(at: Real) -> Complex:
        return along(first, at)

    def push(at: Real) -> Real:
        p, slope, bend, cube = pressure(at)[..., None], first(at), second(at), along(second, at)
        own = c[0] * p.conj() * slope + c[1] * (slope.conj()[..., None, :] * bend).sum(axis=-1)
        return (own + c[2] * np.einsum("...bc,...bca->...a", bend.conj(), cube)).real

    sizes = [abs(pressure(points)) ** 2, (abs(first(points)) ** 2).sum(axis=-1)]
    sizes.append((abs(second(points)) ** 2).sum(axis=(-1, -2)))
    slope = np.array([along(push, point) for point in points])
    return -c.real @ sizes / 2, push(points), -(slope + slope.swapaxes(1, 2)) / 2


def direct(positions: Real, points: Real, starts: list[Real]) -> Complex:
    """Returns the drive (N,) with |q| = 1 whose least stiffness is the largest that L-BFGS finds, for point
    sources.

    The least over M points and three axes is smoothed, with a decreasing width. U is quadratic in p
    and its derivatives, and the stiffness is a second difference of U, so the gradient by the phases is
    exact.
    """
    c = -response().real / 2
    h = WAVELENGTH / 50
    shifts = h * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    way = (points[:, None] + shifts)[:, :, None] - positions
    r = np.linalg.norm(way, axis=-1)
    k = 2 * np.pi / WAVELENGTH
    p = 4.386 / r * np.exp(1j * k * r)
    p1, p2 = p * (1j * k - 1 / r) / r, p * (3 / r**2 - 3j * k / r - k**2) / r**2
    bends = [p2 * way[..., a] * way[..., b] + p1 * (a == b) for a in range(3) for b in range(3)]
    rows = np.stack([p, *np.moveaxis(p1[..., None] * way, -1, 0), *bends], axis=-2)
    scales = np.repeat(c, [1, 3, 9])
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
            phases = minimize(smooth, phases, (sharpness, unit), jac=True, method="L-BFGS-B", options=options).x
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
