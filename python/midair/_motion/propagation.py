"""Propagation to moving points: rows of G, |p| of each frame's drive at its points, and forces around them.

In a ball without sources, sound is a sum of regular spherical waves of orders l, each of which is a sum of
plane waves in directions d:

    p(x) = sum_d e^{j k d . x} c_d
    c_d = w_d sum_s w_s p(R s) sum_l (2l + 1)/(4 pi)^2 (-j)^l P_l(d . s)/j_l(kR)

(NIST's Digital Library of Mathematical Functions, 10.60.7 and 14.30.9.) R is the ball's radius, k the
wavenumber; d and s are the directions of a quadrature rule with weights w. Orders up to 6 leave an error of
1e-5 of the pressure. Gor'kov's potential U = c1 |p|^2 - c2 |grad p|^2 gives the force at some places in a
smaller ball. A polynomial of degree 6 fitted to these forces is accurate to 1e-3.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from itertools import permutations, product
from math import ceil
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, SceneError, SceneWarning, field
from .._support.arguments import refused
from .drives import Drives, blocks
from .envelope import Envelope

#: Largest number of entries of G in one block behind obstacles or with a signature, where the core stores
#: them in double precision.
MOST_KEPT = 1 << 17


def rows(
    scene: Scene, points: NDArray[np.float64], name: str = "points", first: int = 0
) -> NDArray[np.complex64]:
    """Return rows of G (..., N) at points (..., 3) in a scene. Errors number the points from `first`."""
    shape, flat = points.shape[:-1], points.reshape(-1, 3)
    kept = scene.obstacles or scene.signature is not None
    part = max(MOST_KEPT // len(scene.array), 1) if kept else len(flat)
    # A list of signatures has one entry for each point of a frame.
    names = scene.signature if isinstance(scene.signature, list) else None
    blocks = []
    with warnings.catch_warnings():
        # The scene itself has already warned of probable mistakes.
        warnings.simplefilter("ignore", SceneWarning)
        for start in range(0, len(flat), part):
            try:
                changes: dict[str, Any] = {"points": flat[start : start + part]}
                if names is not None:
                    order = range(start, start + len(changes["points"]))
                    changes["signature"] = [names[k % len(names)] for k in order]
                blocks.append(scene.replace(**changes).propagation())
            except SceneError as error:
                found = re.match(r"points\[(\d+)\](.*)", str(error))
                if found is None:
                    raise
                index = list(np.unravel_index(start + int(found[1]), shape))
                index[0] += first
                raise SceneError(f"{name}[{', '.join(map(str, index))}]{found[2]}") from None
    return np.concatenate(blocks).reshape(*shape, -1)


def pressures(scene: Scene, points: NDArray[np.float64], drives: Drives) -> NDArray[np.float64]:
    """Return |p| (T, M) in Pa: p_j(t) = sum_i G_ji(t) q_i(t)."""
    frames, count, _ = points.shape
    found = np.empty((frames, count))
    for part in blocks(frames, count * len(scene.array)):
        found[part] = moduli(rows(scene, points[part], first=part.start), drives[part])
    return found


def moduli(matrices: NDArray[np.complex64], drives: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Return |p| (..., M) for matrices G (..., M, N) and drives (..., N)."""
    found: NDArray[np.float32] = np.abs(np.matmul(matrices, drives[..., None])[..., 0])
    return found


class Between(NamedTuple):
    """Pressures between frames: `times` (S,) in s and |p| `pressures` (S, M) in Pa, S = T substeps."""

    times: NDArray[np.float64]
    pressures: NDArray[np.float64]


def between(
    scene: Scene, points: NDArray[np.float64], targets: NDArray[np.float64], envelope: Envelope, substeps: int
) -> Between:
    """Return |p_j| = |sum_i G_ji y_i| at (t + k/substeps)/rate; points move linearly between frames.

    A point that is absent in the next frame does not move. Neither do the points after the end of an open
    sequence.
    """
    frames, count, _ = points.shape
    found = np.empty((frames, substeps, count))
    following = np.roll(points, -1, axis=0)
    gone = np.roll(targets, -1, axis=0) == 0
    if not envelope.closed:
        gone[-1] = True
    step = np.where(gone[..., None], 0.0, following - points)
    for part, steps, y in envelope.inside(substeps):
        shares = np.arange(steps.start, steps.stop) / substeps
        places = points[part, None] + shares[:, None, None] * step[part, None]
        # G has `count` times as many numbers as the drives, so it is computed in smaller blocks.
        for some in blocks(len(y), y[0].size * count):
            matrices = rows(scene, places[some], first=part.start + some.start)
            found[part.start + some.start : part.start + some.stop, steps] = moduli(matrices, y[some])
    times = np.arange(frames * substeps) / (substeps * envelope.rate)
    return Between(times, found.reshape(-1, count))


#: Largest distance between two knots: time in s, and movement of a point in wavelengths. Between such knots,
#: traps deviate by less than 0.1 % from linear interpolation.
LONGEST, WAY = 1e-3, 1 / 16

#: Longer frames are divided into parts of this many seconds, shorter than the transducers' settling time.
SETTLED = 0.25e-3


@dataclass
class Course:
    """Knots (interpolation nodes) in time: the transducers' radiation at each, and the points' places.

    Attributes
    ----------
    drives
        (K, N) at the knots of one lap, or of all frames of an open sequence.
    frames
        (T, M, 3) in m, the points of each frame.
    envelope
        The transducers' radiation over time.
    spacing
        Time in s between two knots.
    start
        Time in s of the first knot, in the middle of the first part of the first frame.
    """

    drives: NDArray[np.complex64]
    frames: NDArray[np.float64]
    envelope: Envelope
    spacing: float
    start: float

    @staticmethod
    def of(envelope: Envelope, points: NDArray[np.float64], wavelength: float) -> Course:
        """Make the knots for the radiation of `envelope` and points (T, M, 3) in m."""
        frames, rate = len(points), envelope.rate
        # `every`: frames per knot. `parts`: knots per frame. One of them is 1.
        every, parts = 1, ceil(1 / (rate * SETTLED) - 1e-9)
        if parts <= 1:
            moved = np.linalg.norm(np.diff(points, axis=0), axis=2).max(initial=0.0)
            most = min(LONGEST * rate, WAY * wavelength / max(moved, 1e-9))
            every = max(int(min(most, frames)), 1)
            while envelope.closed and frames % every:
                every -= 1
        found = []
        for some, steps, y in envelope.inside(2 * parts):
            odd = np.arange(steps.start, steps.stop) % 2 == 1
            found.append(y[(-some.start) % every :: every][:, odd].reshape(-1, y.shape[-1]))
        drives = np.concatenate(found)
        return Course(drives, points, envelope, every / (rate * parts), 0.5 / (rate * parts))

    def knots(self, duration: float | None) -> int:
        """Return the number of knots of a flight."""
        lap = len(self.drives)
        if not self.envelope.closed:
            lasts = lap if duration is None else min(lap, ceil(duration / self.spacing) + 1)
            if lasts < 2:
                raise refused(
                    "duration", duration, "the sequence is too short for a flight, give more frames"
                )
            return lasts
        laps = min(max(ceil(1 / (lap * self.spacing)), 1), 100)
        return (laps * lap if duration is None else ceil(duration / self.spacing)) + 1

    def times(self, knots: NDArray[Any]) -> NDArray[np.float64]:
        """Return the times in s of knots, which may be fractional."""
        found: NDArray[np.float64] = self.start + self.spacing * knots
        return found

    def ways(self, knots: int, points: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the places (K, B, 3) of some points (B,) at the first `knots` knots."""
        lap = min(knots, len(self.drives))
        own = self.points(self.times(np.arange(lap)))[:, points]
        return own if lap == knots else own[np.arange(knots) % lap]

    def points(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places (T, M, 3) of the points at times in s, linear between frames."""
        points, count = self.frames, len(self.frames)
        way = times * self.envelope.rate
        way = way % count if self.envelope.closed else way.clip(0, count - 1)
        before = np.minimum(way.astype(np.intp), count - 1)
        after = (before + 1) % count if self.envelope.closed else np.minimum(before + 1, count - 1)
        share = (way - before)[:, None, None]
        found: NDArray[np.float64] = points[before] + share * (points[after] - points[before])
        return found

    def moving(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return velocities and accelerations (M, 3) of the points at the start; 0 for an open sequence."""
        if not self.envelope.closed:
            none = np.zeros(self.frames.shape[1:])
            return none, none
        apart = max(self.spacing, LONGEST)
        before, here, after = self.points(self.start - self.envelope.tau + apart * np.array([-1.0, 0.0, 1.0]))
        return (after - before) / (2 * apart), (after - 2 * here + before) / apart**2


#: Highest order of the waves, and the ball's radius in wavelengths.
ORDERS, BALL = 6, 1 / 6

#: Degree of the polynomials, the radius in wavelengths within which they are used, and the number of places
#: fitted.
DEGREE, UNIT, PLACES = 6, 1 / 7, 180

#: Number of monomials of a polynomial: C(6 + 3, 3).
TERMS = 84

#: Number of balls that are computed together.
AT_ONCE = 128


class Forces:
    """Computes the forces of a scene's field, without signatures, on a sphere with Gor'kov's factors (2,)."""

    def __init__(self, scene: Scene, factors: NDArray[np.float64]) -> None:
        self._scene, self._factors = scene.replace(signature=None, pressures=None), factors
        self.wavelength = wavelength = scene.sound_speed / scene.frequency
        wavenumber = 2 * np.pi / wavelength + 1j * scene.absorption
        directions, weights = _rule()
        radius, self.unit = BALL * wavelength, UNIT * wavelength
        self._ball = radius * directions
        cosines = np.polynomial.legendre.legvander(directions @ directions.T, ORDERS)
        orders = np.arange(ORDERS + 1)
        shares = (2 * orders + 1) * (-1j) ** orders / (16 * np.pi**2 * _bessel(wavenumber * radius))
        waves = (weights[:, None] * weights) * (cosines @ shares)
        inner = _within(PLACES)
        plane = np.exp(1j * wavenumber * self.unit * inner @ directions.T)
        slopes = 1j * wavenumber * directions
        # For each place ten rows: the pressure, and the pressure's three first and six second derivatives.
        sides = [np.ones(len(directions)), *slopes.T]
        sides += [slopes[:, a] * slopes[:, b] for a, b in SECOND]
        self._inside = np.concatenate([(plane * side) @ waves for side in sides]).T.astype(np.complex64)
        self._through = np.linalg.pinv(monomials(inner)).T

    def around(self, places: NDArray[np.float64], drives: NDArray[np.complex64]) -> NDArray[np.float64]:
        """Return coefficients (P, 84, 3) in N around places (P, 3), each in the field of its drive (P, N).

        The polynomials are in coordinates relative to the place, in units of `unit` m. Their monomials are in
        the order of the function `monomials`.
        """
        found = np.empty((len(places), TERMS, 3))
        for start in range(0, len(places), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            pressure = np.stack(
                [self._pressure(*one) for one in zip(places[part], drives[part], strict=True)]
            )
            p, *slopes = (pressure @ self._inside).reshape(len(pressure), 10, PLACES).swapaxes(0, 1)
            gradient, second = slopes[:3], dict(zip(SECOND, slopes[3:], strict=True))
            for axis in range(3):
                compressed = (p.conj() * gradient[axis]).real
                moved = sum((gradient[b].conj() * second[min(axis, b), max(axis, b)]).real for b in range(3))
                force = -2 * (self._factors[0] * compressed - self._factors[1] * moved)
                found[part, :, axis] = force @ self._through
        return found

    def _pressure(self, place: NDArray[np.float64], drive: NDArray[np.complex64]) -> NDArray[np.complex64]:
        """Return the pressure (D,) at D directions on the ball around a place."""
        try:
            return field(self._scene, drive, place + self._ball).pressure
        except SceneError as error:
            raise SceneError(f"beads come where there is no force: {error}") from None


#: Pairs of axes of the six second derivatives.
SECOND = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def monomials(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return monomials x^a y^b z^c (P, 84) at places (P, 3), by degree up to 6, then by falling exponents."""
    powers = places[:, None] ** np.arange(DEGREE + 1)[:, None]
    columns = [
        powers[:, degree - rest, 0] * powers[:, rest - c, 1] * powers[:, c, 2]
        for degree in range(DEGREE + 1)
        for rest in range(degree + 1)
        for c in range(rest + 1)
    ]
    return np.stack(columns, axis=1)


def _rule() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return directions (50, 3) and weights (50,) of a quadrature rule on the sphere, exact to degree 11.

    V. I. Lebedev, USSR Comput. Math. Math. Phys. 16(2), 10 (1976): the directions of the faces, edges and
    corners of a cube, and those of (1, 1, 3).
    """
    shapes = (
        ((0, 0, 1), 4 / 315),
        ((0, 1, 1), 64 / 2835),
        ((1, 1, 1), 27 / 1280),
        ((1, 1, 3), 14641 / 725760),
    )
    directions, weights = [], []
    for shape, weight in shapes:
        orders = sorted(set(permutations(shape)))
        each = {tuple(a * b) for a in np.array(orders) for b in product((-1, 1), repeat=3)}
        directions += [np.array(one) / np.linalg.norm(one) for one in sorted(each)]
        weights += [4 * np.pi * weight] * len(each)
    return np.array(directions), np.array(weights)


def _bessel(z: complex) -> NDArray[np.complex128]:
    """Return the spherical Bessel functions j_l(z), l = 0 to 6, of a small z by their power series."""
    found = np.empty(ORDERS + 1, complex)
    lead = 1.0 + 0j
    for order in range(ORDERS + 1):
        term, total = lead, lead
        for n in range(1, 12):
            term *= -z * z / (2 * n * (2 * (order + n) + 1))
            total += term
        found[order] = total
        lead *= z / (2 * order + 3)
    return found


def _within(count: int) -> NDArray[np.float64]:
    """Return places (P, 3) in the unit ball, denser near its surface, where a fitted polynomial errs most."""
    index = np.arange(count) + 0.5
    heights, angles = 1 - 2 * index / count, np.pi * (1 + np.sqrt(5)) * index
    across = np.sqrt(1 - heights**2)
    sphere = np.stack([across * np.cos(angles), across * np.sin(angles), heights], axis=1)
    found: NDArray[np.float64] = sphere * np.sin(np.pi / 2 * (index * np.sqrt(2) % 1))[:, None]
    return found
