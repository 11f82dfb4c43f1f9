"""Fit of responses, sound speed and places to readings: Levenberg-Marquardt with falling noise."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._support.ctrl_c import interruptibly
from .model import AIR, CLOCK, LOUDNESS, SPEED, Belief, Complex, Model, Real

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


@dataclass(frozen=True)
class Fitted:
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


@dataclass(frozen=True)
class Place:
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


def robust(
    model: Model,
    drives: Complex,
    readings: Real | Complex,
    believed: Real,
    prior: float | None,
    noise: float,
    progress: Callable[[int, int], object],
) -> Fitted:
    """Fit, leave out the outliers, and fit again until the outliers do not change. See `fit`.

    An outlier is OUTLYING standard deviations from the model. The standard deviation is estimated by the
    median distance of all readings. With too many outliers the model must be wrong; then all readings are
    used.
    """

    def fitted(used: NDArray[np.bool_]) -> Fitted:
        return fit(model, drives, readings, believed, prior, noise, progress, used)

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
    return Fitted(
        here.responses,
        np.sqrt((error[:n] ** 2 + error[n : 2 * n] ** 2) / 2),
        (left[:n] + left[n : 2 * n]) / 2,
        here.state,
        others,
        max(found, noise),
        _modelled(drives, here.responses, model.matrix(here.state), phased) - given,
        used,
        known.chances,
    )


def _start(
    model: Model, drives: Complex, readings: Real | Complex, believed: Real, used: NDArray[np.bool_]
) -> Real:
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


def _normal(
    model: Model, drives: Complex, here: Place, spread: Real, used: NDArray[np.bool_]
) -> tuple[Real, Real]:
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
