"""Propagation to points that move: rows of G, |p| of each frame's drive at its points, forces around them.

Inside of a ball that no source reaches, sound is a sum of regular waves of orders l, and each of plane waves:

    p(x) = sum_d e^{j k d . x} c_d
    c_d = w_d sum_s w_s p(R s) sum_l (2l + 1)/(4 pi)^2 (-j)^l P_l(d . s)/j_l(kR)

(NIST's Digital Library of Mathematical Functions, 10.60.7 and 14.30.9), d and s directions of a rule with
weights w. Orders up to 6 leave 1e-5 of the pressure out. With Gor'kov's U = c1 |p|^2 - c2 |grad p|^2 the
force follows at some places in a smaller ball, and a polynomial of degree 6 runs through them to 1e-3.
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

#: Entries of G at once behind obstacles or under a signature, where it is kept in double precision.
MOST_KEPT = 1 << 17


def rows(
    scene: Scene, points: NDArray[np.float64], name: str = "points", first: int = 0
) -> NDArray[np.complex64]:
    """G (..., N) at points (..., 3) in a scene's air; an error names the point, the first being `first`."""
    shape, flat = points.shape[:-1], points.reshape(-1, 3)
    kept = scene.obstacles or scene.signature is not None
    part = max(MOST_KEPT // len(scene.array), 1) if kept else len(flat)
    # Each point of a frame has its own entry of a list.
    names = scene.signature if isinstance(scene.signature, list) else None
    blocks = []
    with warnings.catch_warnings():
        # The scene itself has reported probable mistakes.
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
    """|p| (T, M) in Pa: p_j(t) = sum_i G_ji(t) q_i(t)."""
    frames, count, _ = points.shape
    found = np.empty((frames, count))
    for part in blocks(frames, count * len(scene.array)):
        found[part] = moduli(rows(scene, points[part], first=part.start), drives[part])
    return found


def moduli(matrices: NDArray[np.complex64], drives: NDArray[np.complex64]) -> NDArray[np.float32]:
    """|p| (..., M) by matrices (..., M, N) and drives (..., N)."""
    found: NDArray[np.float32] = np.abs(np.matmul(matrices, drives[..., None])[..., 0])
    return found


class Between(NamedTuple):
    """Pressures inside the frames: `times` (S,) in s and |p| `pressures` (S, M) in Pa, S = T substeps."""

    times: NDArray[np.float64]
    pressures: NDArray[np.float64]


def between(
    scene: Scene, points: NDArray[np.float64], targets: NDArray[np.float64], envelope: Envelope, substeps: int
) -> Between:
    """|p_j| = |sum_i G_ji y_i| at the times (t + k/substeps)/rate, points on straight lines between frames.

    A point stays where it is while it is not there in the next frame; so do all after an open end.
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
        # Rows of G are `count` times as many numbers as drives.
        for some in blocks(len(y), y[0].size * count):
            matrices = rows(scene, places[some], first=part.start + some.start)
            found[part.start + some.start : part.start + some.stop, steps] = moduli(matrices, y[some])
    times = np.arange(frames * substeps) / (substeps * envelope.rate)
    return Between(times, found.reshape(-1, count))


#: From a knot to the next, the longest time in s and the longest way of a point in wavelengths: between
#: knots, traps then stray by less than a thousandth from the straight line.
LONGEST, WAY = 1e-3, 1 / 16

#: Where frames last longer, this many seconds: shorter than what transducers take to settle.
SETTLED = 0.25e-3


@dataclass
class Course:
    """Knots of frames: the transducers' radiation at each, and the points' places.

    Attributes
    ----------
    drives
        (K, N) at the knots of a lap, or of all frames where they are open.
    frames
        (T, M, 3) in m, the points of each frame.
    envelope
        What radiates.
    spacing
        S from a knot to the next.
    start
        S of the first, in the middle of the first part of the first frame.
    """

    drives: NDArray[np.complex64]
    frames: NDArray[np.float64]
    envelope: Envelope
    spacing: float
    start: float

    @staticmethod
    def of(envelope: Envelope, points: NDArray[np.float64], wavelength: float) -> Course:
        """The field around points (T, M, 3) for the transducers' radiation."""
        frames, rate = len(points), envelope.rate
        # Frames a knot, or knots a frame.
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
        """The number of knots of a flight."""
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
        """Times in s of knots, which may be between two."""
        found: NDArray[np.float64] = self.start + self.spacing * knots
        return found

    def ways(self, knots: int, points: NDArray[np.intp]) -> NDArray[np.float64]:
        """Places (K, B, 3) of some points (B,) at a number of knots from the first on."""
        lap = min(knots, len(self.drives))
        own = self.points(self.times(np.arange(lap)))[:, points]
        return own if lap == knots else own[np.arange(knots) % lap]

    def points(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places (T, M, 3) of the points at times in s, straight between frames."""
        points, count = self.frames, len(self.frames)
        way = times * self.envelope.rate
        way = way % count if self.envelope.closed else way.clip(0, count - 1)
        before = np.minimum(way.astype(np.intp), count - 1)
        after = (before + 1) % count if self.envelope.closed else np.minimum(before + 1, count - 1)
        share = (way - before)[:, None, None]
        found: NDArray[np.float64] = points[before] + share * (points[after] - points[before])
        return found

    def moving(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds and accelerations (M, 3) of the points at the start; of an open sequence 0."""
        if not self.envelope.closed:
            none = np.zeros(self.frames.shape[1:])
            return none, none
        apart = max(self.spacing, LONGEST)
        before, here, after = self.points(self.start - self.envelope.tau + apart * np.array([-1.0, 0.0, 1.0]))
        return (after - before) / (2 * apart), (after - 2 * here + before) / apart**2


#: Orders of waves, and the radius in wavelengths of the ball on which the pressure is looked at.
ORDERS, BALL = 6, 1 / 6

#: Degree of the polynomials, the radius in wavelengths up to which they count, and how many places they meet.
DEGREE, UNIT, PLACES = 6, 1 / 7, 180

#: Monomials of a polynomial.
TERMS = 84

#: Balls at once.
AT_ONCE = 128


class Forces:
    """The potential of a sphere with Gor'kov's factors (2,) in a scene's real field."""

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
        # Pressure, its slopes and their slopes: of each place ten rows.
        sides = [np.ones(len(directions)), *slopes.T]
        sides += [slopes[:, a] * slopes[:, b] for a, b in SECOND]
        self._inside = np.concatenate([(plane * side) @ waves for side in sides]).T.astype(np.complex64)
        self._through = np.linalg.pinv(monomials(inner)).T

    def around(self, places: NDArray[np.float64], drives: NDArray[np.complex64]) -> NDArray[np.float64]:
        """Coefficients (P, 84, 3) in N around places (P, 3), each in the field of its drive (P, N).

        Coordinates from the place are in `unit` m; monomials stand by degree, then by exponents that fall.
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
        """The pressure (D,) on the ball around a place."""
        try:
            return field(self._scene, drive, place + self._ball).pressure
        except SceneError as error:
            raise SceneError(f"beads come where there is no force: {error}") from None


#: The second derivatives.
SECOND = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def monomials(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """x^a y^b z^c (P, 84) up to degree 6 at places (P, 3), by degree, then by exponents that fall."""
    powers = places[:, None] ** np.arange(DEGREE + 1)[:, None]
    columns = [
        powers[:, degree - rest, 0] * powers[:, rest - c, 1] * powers[:, c, 2]
        for degree in range(DEGREE + 1)
        for rest in range(degree + 1)
        for c in range(rest + 1)
    ]
    return np.stack(columns, axis=1)


def _rule() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions (50, 3) and weights (50,) that integrate over the sphere, exact to degree 11.

    V. I. Lebedev, USSR Comput. Math. Math. Phys. 16(2), 10 (1976): towards faces, edges and corners of a
    cube, and along (1, 1, 3).
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
    """Spherical Bessel functions j_l(z) (7,) of a small z, by their power series."""
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
    """Places (P, 3) in the unit ball, denser towards its surface, where polynomials stray."""
    index = np.arange(count) + 0.5
    heights, angles = 1 - 2 * index / count, np.pi * (1 + np.sqrt(5)) * index
    across = np.sqrt(1 - heights**2)
    sphere = np.stack([across * np.cos(angles), across * np.sin(angles), heights], axis=1)
    found: NDArray[np.float64] = sphere * np.sin(np.pi / 2 * (index * np.sqrt(2) % 1))[:, None]
    return found
