"""Fit of responses, sound speed and places to readings: Levenberg-Marquardt with falling noise."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._boards.board import changed
from .._midair import Array, Scene, directivities
from .._support.arguments import without_warnings
from .._support.ctrl_c import interruptibly

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


class Priors(NamedTuple):
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

    def __init__(self, scene: Scene, microphones: Real, second: NDArray[np.intp], priors: Priors, phased: bool) -> None:
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

    def _made(self, positions: Real, normals: Real, number: float, keep: dict[str, Any] | None = None) -> Array:
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
        around = positions[self._second] - self._middle
        positions[self._second] = self._middle + state[-6:-3] + around @ turned
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
        own, left_of, at, spread = (each[: 2 * n].reshape(2, n) for each in (off, variance, self.mean, self.spread))
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


#: Noise that the first step assumes, relative to the readings' rms; a later step assumes at least TIGHTER
#: times the noise of the step before. If the assumed noise fell faster, the fit would end in a local minimum
#: where the noise is small and readings are few.
FIRST_TRUST, TIGHTER = 0.3, 0.6
#: A reading more than OUTLYING standard deviations from the model is an outlier. This happens to one normally
#: distributed reading in 10^9. The standard deviation is at least LEAST_SCATTER times the median reading.
OUTLYING, LEAST_SCATTER = 6.0, 1e-3
#: Largest share of outliers: above it the model must be wrong, and all readings are used. Largest number of
#: rounds that remove outliers.
MOST_OUTLYING, ROUNDS = 0.2, 8
#: Largest number of steps. Once the noise has reached its final value, the fit ends when a step reduces the
#: cost by less than the fraction GAIN and changes no probability of a transducer's state by more than CHANGE.
STEPS, GAIN, CHANGE = 40, 1e-3, 0.02
#: Largest damping that is tried, relative to the prior's curvature. With damping below WHOLE, a step counts
#: as undamped.
MOST_DAMPING, WHOLE = 1e3, 0.1
#: Lower bound of the mean response's modulus in a step.
LEAST_SCALE = 0.1
#: Distance in m/s of the sound speeds that are compared before the first step.
SPEED_STEP = 0.5
#: Drives per block of the normal equations. Ctrl-C takes effect after a block.
BLOCK = 256


class Fitted(NamedTuple):
    """Result of a fit: responses (N,) and state, with their standard deviations (0 for fixed values)."""

    responses: Complex
    responses_error: Real
    #: Share (N,) of each response that the prior decides: posterior variance over the prior's.
    prior_share: Real
    state: Real
    state_error: Real
    #: Standard deviation of a reading in Pa.
    noise: float
    #: Model minus reading (K, M) in Pa; which readings were used.
    residuals: Real | Complex
    used: NDArray[np.bool_]
    #: Probabilities (3, N) that each transducer is alive, dead or reversed.
    chances: Real


class Place(NamedTuple):
    """An iterate: its parameters and residuals."""

    #: Differences from the prior's centre: of re and im of the responses, then of the free part of the state.
    off: Real
    responses: Complex
    state: Real
    residuals: Real | Complex
    #: Standard deviation of a modulus in Pa.
    noise: float

    @property
    def misfit(self) -> float:
        """Sum of the squared residuals."""
        return float(np.vdot(self.residuals, self.residuals).real)


def robust(fitted: Callable[[NDArray[np.bool_]], Fitted], readings: Real | Complex) -> Fitted:
    """Fit, leave out the outliers, and fit again until the outliers do not change. `fitted` is `fit` of what is used.

    An outlier is OUTLYING standard deviations from the model. The standard deviation is estimated by the
    median distance of all readings. With too many outliers the model must be wrong; then all readings are
    used.
    """
    used = np.ones(readings.shape, bool)
    first = found = fitted(used)
    # Median modulus of a normally distributed complex or real number, relative to the standard deviation of
    # its real part.
    median = np.sqrt(2 * np.log(2)) if np.iscomplexobj(readings) else 0.6745
    least = LEAST_SCATTER * float(np.median(np.abs(readings)))
    for _ in range(ROUNDS):
        off = np.abs(found.residuals)
        then = off <= OUTLYING * max(float(np.median(off)) / median, least)
        if np.array_equal(then, used):
            break
        if then.mean() < 1 - MOST_OUTLYING:
            return first
        used = then
        found = fitted(used)
    return found


def fit(
    model: Model,
    drives: Complex,
    readings: Real | Complex,
    believed: Real,
    prior: float | None,
    noise: float,
    progress: Callable[[int, int], object],
    used: NDArray[np.bool_],
) -> Fitted:
    """Find responses and state with the least squared residuals plus squared distances from the prior.

    Readings (K, M) of drives (K, N) are moduli or complex. `believed` are the expected moduli of the
    responses; re and im of a response are relative to the phase that the array gives it. `prior` is the
    standard deviation of living responses, relative to the mean modulus; None estimates it during the fit.
    `noise` in Pa is a lower bound of the readings' noise. Readings that are not `used` have no effect.
    """
    phased, given, readings = np.iscomplexobj(readings), readings, readings * used
    state = _start(model, drives, readings, believed, used)
    n, known = len(believed), Belief(model, believed, prior)
    rms = float(np.sqrt(np.sum(np.abs(readings) ** 2) / used.sum()))
    count = int(used.sum()) * (2 if phased else 1)

    loudness = 2 * n + int(np.searchsorted(model.free, LOUDNESS))

    def place(off: Real, noise: float) -> Place:
        responses = believed + off[:n] + 1j * off[n : 2 * n]
        # The scalar "loudness" takes a common factor of all responses, so that they are nearest to their
        # prior.
        scale = max(known.scale(responses), LEAST_SCALE)
        responses /= scale
        off = np.r_[responses.real - believed, responses.imag, off[2 * n :]]
        off[loudness] += np.log(scale)
        at = model.moved(state, off[2 * n :])
        modelled = _modelled(drives, responses, model.matrix(at), phased, noise) * used
        return Place(off, responses, at, modelled - readings, noise)

    trust, damping, noise = max(FIRST_TRUST * rms, noise), 0.0, max(noise, 1e-6 * rms)
    here, one, left = place(known.mean, trust), np.eye(len(known.mean)), np.ones(len(known.mean))
    for step in range(STEPS):
        progress(step, STEPS)
        spread = known.spread.copy()
        square, slope = _normal(model, drives, here, spread, used)
        # Degrees of freedom: each unknown that the readings determine uses up one reading.
        found = float(np.sqrt(here.misfit / max(count - np.sum(1 - left), 1.0)))
        settled = trust <= 1.05 * max(found, noise)
        trust = max(noise, float(np.clip(found, TIGHTER * trust, trust / TIGHTER)))
        left = interruptibly(_inverse_diagonal, square / trust**2 + one)
        unknowns = (here.off - known.mean) / spread
        cost = here.misfit / trust**2 + unknowns @ unknowns
        while True:
            curvature = square / trust**2 + (1 + damping) * one
            then = unknowns - interruptibly(np.linalg.solve, curvature, slope / trust**2 + unknowns)
            there = place(known.mean + then * spread, here.noise)
            gain = cost - there.misfit / trust**2 - np.sum(((there.off - known.mean) / spread) ** 2)
            if gain > 0 or damping > MOST_DAMPING:
                break
            damping = max(4 * damping, 0.01)
        whole, change = damping < WHOLE, 0.0
        if gain > 0:
            here, damping = there, damping / 4
            # Only an undamped step ends at the posterior mean, from which the probabilities are updated.
            change = known.learn(here.off, left) if whole else 1.0
        if settled and gain < GAIN * cost and change < CHANGE:
            break
        here = place(here.off, trust)
    progress(STEPS, STEPS)
    error = np.sqrt(left) * spread
    others = np.zeros(len(state))
    others[model.free] = error[2 * n :]
    errors = np.sqrt((error[:n] ** 2 + error[n : 2 * n] ** 2) / 2)
    share, noise = (left[:n] + left[n : 2 * n]) / 2, max(found, noise)
    off = _modelled(drives, here.responses, model.matrix(here.state), phased) - given
    return Fitted(here.responses, errors, share, here.state, others, noise, off, used, known.chances)


def _start(model: Model, drives: Complex, readings: Real | Complex, believed: Real, used: NDArray[np.bool_]) -> Real:
    """Return the initial state: the best sound speed for the readings and its prior, and their loudness.

    Sound speeds within three standard deviations are compared. With a wrong sound speed, the wave's phase
    over a large array is wrong by more than half a period, and the steps would not converge. The readings
    have the noise of the first step, so that a few of them do not outweigh the prior.
    """
    phased = np.iscomplexobj(readings)
    deviation = model.spread[SPEED]
    reach, trust = 3 * deviation, (FIRST_TRUST * np.linalg.norm(readings)) ** 2 / used.sum()
    best, start = np.inf, model.start
    for offset in np.arange(-reach, reach + SPEED_STEP, SPEED_STEP) if reach else [0.0]:
        state = model.start.copy()
        state[SPEED] = np.clip(state[SPEED] + offset, *AIR)
        p = _modelled(drives, believed, model.matrix(state), phased) * used
        product = np.vdot(p, readings) / np.linalg.norm(p)
        # Without the squared norm of the readings, which is the same for every sound speed.
        cost = -(abs(product) ** 2) / trust + (offset / max(deviation, SPEED_STEP)) ** 2
        if cost < best:
            state[LOUDNESS] = np.log(np.linalg.norm(readings) / np.linalg.norm(p))
            state[CLOCK] = np.angle(product) if phased else 0.0
            best, start = float(cost), state
    return np.asarray(start)


def _modelled(
    drives: Complex, responses: Real | Complex, matrix: Complex, phased: bool, noise: float = 0.0
) -> Real | Complex:
    """Return the expected readings (K, M): p, or the root mean square of a modulus with noise."""
    p = drives @ (matrix * responses).T
    return p if phased else np.hypot(np.abs(p), noise)


def _normal(model: Model, drives: Complex, here: Place, spread: Real, used: NDArray[np.bool_]) -> tuple[Real, Real]:
    """Return J^T J and J^T r for the residuals r, where J are the derivatives by the unknowns.

    The derivatives of a modulus |p| by re and im of response i are the real part and minus the imaginary part
    of conj(p)/|p| G_i q_i. The derivatives by the state use those of G, summed over i. |p| includes noise.
    """
    matrix = model.matrix(here.state)
    slopes = model.slopes(here.state, matrix) * here.responses
    square, slope = np.zeros((len(spread), len(spread))), np.zeros(len(spread))
    for m, row in enumerate(matrix):
        for begin in range(0, len(drives), BLOCK):
            q = drives[begin : begin + BLOCK] * used[begin : begin + BLOCK, m, None]
            left = here.residuals[begin : begin + BLOCK, m]
            each, others = q * row, q @ slopes[:, m].T
            if np.iscomplexobj(left):
                rows = np.hstack([each, 1j * each, others])
                rows, left = np.concatenate([rows.real, rows.imag]), np.concatenate([left.real, left.imag])
            else:
                p = each @ here.responses
                modelled = np.hypot(np.abs(p), max(here.noise, np.finfo(float).tiny))
                turned = (np.conj(p) / modelled)[:, None]
                each, others = each * turned, others * turned
                rows = np.hstack([each.real, -each.imag, others.real])
            rows *= spread
            square += rows.T @ rows
            slope += rows.T @ left
    return square, slope


def _inverse_diagonal(square: Real) -> Real:
    """Return the diagonal of a matrix's inverse; by Cholesky's factor, rounding cannot make it negative."""
    return np.asarray(np.sum(np.linalg.inv(np.linalg.cholesky(square)) ** 2, axis=0))
