"""Model of the readings by the core's propagation, and the prior probabilities of the fit."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._boards.layout import changed
from .._midair import Array, Scene, directivities
from .._support.arguments import without_warnings

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: Range of sound speeds that a fit may find, in m/s: -60 to 60 degrees C (docs/conventions.md).
AIR = (293.0, 366.0)
#: Prior standard deviation of the directivity's parameter: of the exponent of a cosine (0 for "point"); or of
#: the size of a piston or strip, relative to this size.
EXPONENT, WIDTH = 2.0, 0.3
#: Prior standard deviation of the clock's phase in rad and of log(loudness): so wide that both are unknown.
UNKNOWN = 10.0
#: Initial standard deviation of a microphone's coordinates, in m.
MISPLACED = 1e-3
#: Signs of the responses of alive, dead and reversed transducers, and their prior probabilities. The fit
#: updates the probabilities from transducers that are decided with more than DECIDED. If it used all
#: transducers, it would declare all of them dead when the noise is high.
SIGNS, CHANCES = np.array([1.0, 0.0, -1.0]), np.array([0.94, 0.05, 0.01])
DECIDED = 0.9
#: Default prior standard deviation of re and im of a living response, relative to the mean modulus.
SPREAD = 0.3
#: Estimates of a spread start as if some additional responses (or places) had this error: relative to the
#: mean modulus, and in m.
OFF, OFF_PLACE = 0.2, 0.1e-3
#: Lower bound of a response's standard deviation, relative to the mean modulus, also of a dead one.
LEAST = 0.02
#: Updates of a spread are over-relaxed by this exponent (below 2 it converges), and limited to this factor.
OVER_RELAXED, FACTOR = 1.7, 1.5
#: Indices in the state vector: sound speed, directivity's parameter, clock's phase, log(loudness), first
#: place.
SPEED, NUMBER, CLOCK, LOUDNESS, PLACES = range(5)


@dataclass(frozen=True)
class Priors:
    """Prior standard deviations. A value of 0 fixes the quantity."""

    #: Standard deviation of the sound speed, in m/s.
    sound_speed: float
    #: Standard deviation of each coordinate of a microphone, in m; None if the fit estimates it.
    microphones: float | None
    #: Standard deviations of the second board's position in m and of its rotation in rad.
    pose: tuple[float, float]


class Model:
    """Pressures at microphones as a function of a state vector.

    The state contains, in this order: sound speed, the directivity's parameter, the phase of the readings'
    clock, log of their loudness, places (M, 3) of the microphones, the second board's displacement (3,) in m
    and its rotation (3,) in rad about its centre. `second` are the indices of this board's transducers, none
    if all poses are known.
    """

    def __init__(
        self, scene: Scene, microphones: Real, second: NDArray[np.intp], priors: Priors, phased: bool
    ) -> None:
        own = scene.array
        self._kind, number = kind_of(own.directivity)
        # The fit determines the responses, so the core computes the matrix without them. `matrix` multiplies
        # it by the phases of the array's own responses.
        self.phases = np.exp(1j * np.angle(np.ones(len(own)) if own.response is None else own.response))
        self._array = own
        self._scene = scene.replace(array=self._made(own.positions, own.normals, number))
        self._second = second
        self._middle = own.positions[second].mean(0) if len(second) else np.zeros(3)
        self.start = np.r_[scene.sound_speed, number, 0.0, 0.0, microphones.ravel(), np.zeros(6)]
        default, self._unit, _ = directivities()[self._kind]
        width = 0.0 if default is None else WIDTH * number if self._unit == "m" else EXPONENT
        pose = np.repeat(priors.pose, 3) if len(second) else np.zeros(6)
        self.spread = np.r_[
            priors.sound_speed,
            width,
            UNKNOWN * phased,
            UNKNOWN,
            np.full(microphones.size, MISPLACED if priors.microphones is None else priors.microphones),
            pose,
        ]
        self.free = np.flatnonzero(self.spread)
        #: Indices, among the free values, of coordinates whose spread the fit estimates.
        first = np.searchsorted(self.free, PLACES)
        self.learnt = first + np.arange(microphones.size if priors.microphones is None else 0)

    def array(self, state: Real, response: Complex) -> Array:
        """Return the array with the state's pose and directivity and with given responses."""
        own = self._array
        keep = {"response": response, "mask": own.mask, "quantization": own.quantization}
        return self._made(*self._placed(state), state[NUMBER], keep)

    def matrix(self, state: Real) -> Complex:
        """Return the pressures (M, N) in Pa at the microphones, per transducer, for |response| 1."""
        array = self._made(*self._placed(state), state[NUMBER])
        with without_warnings():
            # Trial values of the fit must not cause warnings.
            scene = self._scene.replace(array=array, points=self.microphones(state), sound_speed=state[SPEED])
        return np.asarray(scene.propagation() * self.phases * np.exp(1j * state[CLOCK] + state[LOUDNESS]))

    def slopes(self, state: Real, matrix: Complex) -> Complex:
        """Return the derivatives (F, M, N) of the matrix by the F free values.

        The wave e^{jkr}/r changes by (jk - 1/r) per m along its ray and by -jkr/c per m/s of sound speed. The
        directivity's parameter has a finite difference. The change of the radiation angle with a place is
        neglected; the next step's matrix includes it.
        """
        positions, _ = self._placed(state)
        rays = self.microphones(state)[:, None] - positions
        r = np.linalg.norm(rays, axis=2)
        number = 2 * np.pi * self._scene.frequency / state[SPEED]
        along = ((1j * number - 1 / r) * matrix / r)[..., None] * rays
        moved = np.isin(np.arange(len(positions)), self._second)
        found = np.zeros((len(state), *matrix.shape), np.complex128)
        found[SPEED] = -1j * number * r / state[SPEED] * matrix
        if self.spread[NUMBER]:
            step = 0.01 * self.spread[NUMBER]
            nudged = state.copy()
            nudged[NUMBER] += step
            found[NUMBER] = (self.matrix(nudged) - matrix) / step
        found[CLOCK], found[LOUDNESS] = 1j * matrix, matrix
        for m in range(len(matrix)):
            found[PLACES + 3 * m : PLACES + 3 * m + 3, m] = along[m].T
        arms = positions - self._middle - state[-6:-3]
        for axis, unit in enumerate(np.eye(3)):
            found[axis - 6] = -along[..., axis] * moved
            found[axis - 3] = -np.einsum("mnx,nx->mn", along, np.cross(unit, arms)) * moved
        return found[self.free]

    def moved(self, state: Real, by: Real) -> Real:
        """Return the state after a step of the free values, limited to physically possible values."""
        found = state.copy()
        found[self.free] += by
        found[SPEED] = np.clip(found[SPEED], *AIR)
        least = self.start[NUMBER] / 10 if self._unit == "m" else 0.0
        found[NUMBER] = np.maximum(found[NUMBER], least)
        return found

    def microphones(self, state: Real) -> Real:
        """Return the microphones' places (M, 3) in m."""
        return state[PLACES:-6].reshape(-1, 3)

    def _made(
        self, positions: Real, normals: Real, number: float, keep: dict[str, Any] | None = None
    ) -> Array:
        own = self._array
        same = np.isnan(number) or number == kind_of(own.directivity)[1]
        directivity = own.directivity if same else {self._kind: float(number)}
        bare = {"response": None, "mask": None, "quantization": None}
        placed = {"positions": positions, "normals": normals, "directivity": directivity}
        return changed(own, **placed, **(keep or bare))

    def _placed(self, state: Real) -> tuple[Real, Real]:
        """Return positions and normals (N, 3) with the second board in the state's pose."""
        positions, normals = self._array.positions, self._array.normals
        if not len(self._second):
            return positions, normals
        positions, normals = positions.copy(), normals.copy()
        turned = rotation(state[-3:]).T
        positions[self._second] = (
            self._middle + state[-6:-3] + (positions[self._second] - self._middle) @ turned
        )
        normals[self._second] = normals[self._second] @ turned
        return positions, normals


def kind_of(directivity: str | dict[str, float]) -> tuple[str, float]:
    """Return kind and parameter of a directivity; the parameter is NaN for a kind without one."""
    if isinstance(directivity, dict):
        ((kind, number),) = directivity.items()
        return kind, number
    return ("cos", 0.0) if directivity == "point" else (directivity, np.nan)


def rotation(turn: Real) -> Real:
    """Return the rotation matrix by |turn| rad about the axis `turn` (Rodrigues)."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn / angle if angle else turn
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


class Belief:
    """Prior: independent normal distributions of re and im of N responses and of the free part of the state.

    A response is alive (normal about the expected value), reversed (about its negative) or dead (exactly 0).
    One normal distribution with the mean and variance of this mixture approximates it.

    Parameters
    ----------
    mean, spread
        (2N + F,): prior mean of each unknown, relative to the expected value, and its standard deviation.
    chances
        (3, N): probabilities that a transducer is alive, dead or reversed.
    """

    def __init__(self, model: Model, believed: Real, prior: float | None) -> None:
        n = len(believed)
        self._centre, self._modulus = np.array([believed, np.zeros(n)]), float(believed.mean())
        self._alive, self._learnt = np.full((1, 1), (prior or SPREAD) * self._modulus), prior is None
        self._places = 2 * n + model.learnt
        self.chances = np.zeros((3, n))
        self.chances[0] = 1
        self.mean, self.spread = np.zeros((2, 2 * n + len(model.free)))
        self.spread[2 * n :] = model.spread[model.free]
        self._stand()

    # A probability may underflow to 0; this must raise no error if the caller has set
    # np.seterr(under="raise").
    @np.errstate(under="ignore")
    def learn(self, off: Real, left: Real) -> float:
        """Update the prior from a step of the fit; return the largest change of a probability.

        `off` is the distance of each unknown from its expected value. `left` is the fraction of the prior's
        variance that remains after the readings.
        """
        n, variance = self.chances.shape[1], left * self.spread**2
        own, left_of, at, spread = (
            each[: 2 * n].reshape(2, n) for each in (off, variance, self.mean, self.spread)
        )
        # Precision and mean of the estimate without this unknown's own prior, which is divided out.
        precision = np.maximum(1 / left_of - 1 / spread**2, 1e-9 / self._modulus**2)
        middle = (own / left_of - at / spread**2) / precision
        apart = middle - (SIGNS[:, None, None] - 1) * self._centre
        parts = np.sum(self.chances > DECIDED, axis=1) + n / 2 * CHANCES
        widths = 1 / precision + (SIGNS[:, None, None] * self._alive) ** 2
        likely = np.log(parts)[:, None] - np.sum(np.log(widths) + apart**2 / widths, axis=1) / 2
        likely = np.exp(likely - likely.max(axis=0))
        before, self.chances = self.chances, likely / likely.sum(axis=0)
        if self._learnt:
            kept = self._alive**2 / widths
            squares = np.sum(self.chances[::2, None] * ((kept * apart) ** 2 + kept / precision)[::2], axis=0)
            # One spread for re and im together: with two, the estimate would favour ever smaller spreads of
            # quiet responses.
            squares = squares.mean(axis=0, keepdims=True)
            sounding = float(self.chances[::2].sum())
            self._alive = _learnt(self._alive, squares, sounding, n / 4, OFF * self._modulus)
        if len(self._places):
            places = self._places
            # Divided by the number of coordinates that the readings determine (MacKay 1992), minus one: with
            # few coordinates the spread itself is uncertain, and the reported errors must not be too small.
            determined = max(np.sum(1 - left[places]) - 1, 1.0)
            self.spread[places] = np.sqrt((np.sum(off[places] ** 2) + OFF_PLACE**2) / determined)
        self._stand()
        return float(np.abs(self.chances - before).max())

    def scale(self, responses: Complex) -> float:
        """Return the divisor of responses (N,) that minimises their distance from the prior.

        Distances are in units of the prior's standard deviations.
        """
        n = len(responses)
        mean = self._centre[0] + self.mean[:n]
        parts = np.array([responses.real, responses.imag]) / self.spread[: 2 * n].reshape(2, n)
        return float(np.sum(parts**2) / max(parts[0] @ (mean / self.spread[:n]), np.finfo(float).tiny))

    def _stand(self) -> None:
        n, sign, sounding = self.chances.shape[1], SIGNS @ self.chances, SIGNS**2 @ self.chances
        self.mean[: 2 * n] = np.ravel((sign - 1) * self._centre)
        variance = sounding * self._alive**2 + (sounding - sign**2) * self._centre**2
        self.spread[: 2 * n] = np.sqrt(np.maximum(variance, (LEAST * self._modulus) ** 2)).ravel()


def _learnt(last: Real, squares: Real, count: float, more: float, off: float) -> Real:
    """Return the updated standard deviations, over-relaxed from the `last` ones.

    The estimate uses the sums over K of `squares` (..., K), which contain `count` observed numbers. It also
    counts `more` imagined numbers with the standard deviation `off`.
    """
    then = (squares.sum(axis=-1).reshape(last.shape) + more * off**2) / (count + more)
    return np.asarray(last * np.clip((np.sqrt(then) / last) ** OVER_RELAXED, 1 / FACTOR, FACTOR))
