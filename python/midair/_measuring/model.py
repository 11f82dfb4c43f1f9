"""Model of readings by the core's propagation, and the prior of the fit."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._boards.layout import changed
from .._midair import Array, Scene, SceneWarning, directivities

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: The air that a fit may find, in m/s: -60 to 60 degrees C (docs/conventions.md).
AIR = (293.0, 366.0)
#: Standard deviations of a directivity's number before any reading: of an exponent, and of a length in m
#: relative to it. "point" is the cosine to the power of 0.
EXPONENT, WIDTH = 2.0, 0.3
#: Standard deviations of a clock's phase in rad and of the loudness's logarithm: nothing is known of them.
UNKNOWN = 10.0
#: Standard deviations of a microphone's coordinates in m, at the beginning.
MISPLACED = 1e-3
#: A transducer is alive, dead, or connected the wrong way round: how probable each is before any reading. The
#: fit learns that from those above DECIDED alone: from all, much noise would let all be dead.
SIGNS, CHANCES = np.array([1.0, 0.0, -1.0]), np.array([0.94, 0.05, 0.01])
DECIDED = 0.9
#: Where none is given: standard deviation of re and im of a living response, relative to the mean modulus.
SPREAD = 0.3
#: The learnt spread of responses and of places starts as if some more of them had this error: a part of the
#: mean modulus, and m.
OFF, OFF_PLACE = 0.2, 0.1e-3
#: No response is known to less than this part of the mean modulus, a dead one's 0 neither.
LEAST = 0.02
#: Steps of learning are this many times those of expectation and maximisation, safe below 2, and change a
#: standard deviation at most by the factor.
OVER_RELAXED, FACTOR = 1.7, 1.5
#: The places of a state's parts.
SPEED, NUMBER, CLOCK, LOUDNESS, PLACES = range(5)


@dataclass(frozen=True)
class Priors:
    """Standard deviations before any reading; 0 fixes its value."""

    #: A speed in m/s.
    sound_speed: float
    #: Standard deviation of each coordinate of a microphone, in m; None if it is learnt.
    microphones: float | None
    #: The second board's place in m, and its turn in rad.
    pose: tuple[float, float]


class Model:
    """Pressures at microphones by the state of the world, a vector.

    In this order: the sound speed, the directivity's number, the phase of the readings' clock, the logarithm
    of their loudness, places (M, 3) of the microphones, how the second board is moved (3,) in m and turned
    (3,) about its middle in rad. Its indices are `second`, none where no board's pose is in doubt.
    """

    def __init__(
        self, scene: Scene, microphones: Real, second: NDArray[np.intp], priors: Priors, phased: bool
    ) -> None:
        own = scene.array
        self._kind, number = kind_of(own.directivity)
        # The fit searches the responses: the core's matrix is without them, the model's has only their
        # phases.
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
        #: Which free values are coordinates with a learnt spread.
        first = np.searchsorted(self.free, PLACES)
        self.learnt = first + np.arange(microphones.size if priors.microphones is None else 0)

    def array(self, state: Real, response: Complex) -> Array:
        """The array as the state has it."""
        own = self._array
        keep = {"response": response, "mask": own.mask, "quantization": own.quantization}
        return self._made(*self._placed(state), state[NUMBER], keep)

    def matrix(self, state: Real) -> Complex:
        """Pressures (M, N) in Pa at the microphones, of each transducer at full drive and a modulus of 1."""
        array = self._made(*self._placed(state), state[NUMBER])
        with warnings.catch_warnings():
            # Trial values of the fit give no warnings.
            warnings.simplefilter("ignore", SceneWarning)
            scene = self._scene.replace(array=array, points=self.microphones(state), sound_speed=state[SPEED])
        return np.asarray(scene.propagation() * self.phases * np.exp(1j * state[CLOCK] + state[LOUDNESS]))

    def slopes(self, state: Real, matrix: Complex) -> Complex:
        """Derivatives (F, M, N) of the matrix by the free values.

        A wave e^{jkr}/r changes by (jk - 1/r) a metre along its ray and by -jkr/c a m/s; the directivity's
        number by a difference. That the lobe turns with a place is left to the next step's matrix.
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
        """The state after a step of the free values, limited to possible ones."""
        found = state.copy()
        found[self.free] += by
        found[SPEED] = np.clip(found[SPEED], *AIR)
        least = self.start[NUMBER] / 10 if self._unit == "m" else 0.0
        found[NUMBER] = np.maximum(found[NUMBER], least)
        return found

    def microphones(self, state: Real) -> Real:
        """Their places (M, 3) in m."""
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
        """Positions and normals (N, 3) with the second board where the state has it."""
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
    """Kind and number of a directivity, nan where it has none."""
    if isinstance(directivity, dict):
        ((kind, number),) = directivity.items()
        return kind, number
    return ("cos", 0.0) if directivity == "point" else (directivity, np.nan)


def rotation(turn: Real) -> Real:
    """The matrix that turns by |turn| rad about turn (Rodrigues)."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn / angle if angle else turn
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


class Belief:
    """Independent normal numbers for the unknowns: re and im of N responses, then the free part of the state.

    A response is normal about what is believed of it, or about the opposite of that, or it is exactly 0. One
    normal number stands for the three, with their mean and spread by how probable each is.

    Parameters
    ----------
    mean, spread
        (2N + F,) how far each unknown is from what is believed, and its standard deviation.
    chances
        (3, N) how probable it is that a transducer is alive, dead or reversed.
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

    # A chance may be less than the least number there is, which a program may have made an error (np.seterr).
    @np.errstate(under="ignore")
    def learn(self, off: Real, left: Real) -> float:
        """Take over the result of a step of the fit, and return the largest change of a chance.

        `off` is how far each unknown is from what is believed, `left` the part of the prior's variance that
        the readings leave.
        """
        n, variance = self.chances.shape[1], left * self.spread**2
        own, left_of, at, spread = (
            each[: 2 * n].reshape(2, n) for each in (off, variance, self.mean, self.spread)
        )
        # The estimate by the readings and all others alone: its own prior divided out.
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
            # One for re and im: with two, quieter responses that differ less would be ever more probable.
            squares = squares.mean(axis=0, keepdims=True)
            sounding = float(self.chances[::2].sum())
            self._alive = _learnt(self._alive, squares, sounding, n / 4, OFF * self._modulus)
        if len(self._places):
            places = self._places
            # By as many coordinates as the readings determine (MacKay 1992).
            # Less one: with few of them the spread is in doubt itself, and errors are to hold.
            determined = max(np.sum(1 - left[places]) - 1, 1.0)
            self.spread[places] = np.sqrt((np.sum(off[places] ** 2) + OFF_PLACE**2) / determined)
        self._stand()
        return float(np.abs(self.chances - before).max())

    def scale(self, responses: Complex) -> float:
        """The number that divides responses (N,) to the least distance from the prior, in its spreads."""
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
    """Standard deviations by the squares (..., K) of `count` numbers and of `more`, one step past them."""
    then = (squares.sum(axis=-1).reshape(last.shape) + more * off**2) / (count + more)
    return np.asarray(last * np.clip((np.sqrt(then) / last) ** OVER_RELAXED, 1 / FACTOR, FACTOR))
