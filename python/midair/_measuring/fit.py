"""The fit: responses, sound speed and places from readings, by Levenberg-Marquardt with falling noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._support.ctrl_c import interruptibly
from .model import AIR, CLOCK, LOUDNESS, SPEED, Belief, Complex, Model, Real

#: Readings are first trusted to this part of their root mean square, then at most this many times tighter or
#: looser a step. Without it the fit ends in false minima where noise is small and readings are few.
FIRST_TRUST, TIGHTER = 0.3, 0.6
#: A reading this many standard deviations off the model is an outlier: one normal reading in 10^9 is so.
#: Scatter below this part of the median reading does not matter.
OUTLYING, LEAST_SCATTER = 6.0, 1e-3
#: Above this part of outlying readings it is the model that is wrong; rounds of leaving out at most.
MOST_OUTLYING, ROUNDS = 0.2, 8
#: Steps at most. Once trusted to their noise, the fit ends when a step gains less than this part of its cost,
#: and changes the chances of no transducer by more than so much.
STEPS, GAIN, CHANGE = 40, 1e-3, 0.02
#: The most damping of a step that is tried, in units of the prior's curvature; with less than the other it is
#: whole.
MOST_DAMPING, WHOLE = 1e3, 0.1
#: A step that would make the mean response less than this is no step.
LEAST_SCALE = 0.1
#: Speeds looked through before the first step are so far apart, in m/s.
SPEED_STEP = 0.5
#: Drives of a block of the normal equations: Ctrl-C waits for one block.
BLOCK = 256


@dataclass(frozen=True)
class Fitted:
    """Result of a fit: responses (N,) and state with their standard deviations, 0 for fixed ones."""

    responses: Complex
    responses_error: Real
    state: Real
    state_error: Real
    #: A pressure in Pa.
    noise: float
    #: Model minus reading (K, M) in Pa, and which readings were used.
    residuals: Real | Complex
    used: NDArray[np.bool_]
    #: The probabilities that each transducer is alive, dead or reversed (3, N).
    chances: Real


@dataclass(frozen=True)
class Place:
    """An iterate: its parameters, and its distance from the readings."""

    #: The differences of re and im of the responses, and of the free part of the state, from the estimate.
    off: Real
    responses: Complex
    state: Real
    residuals: Real | Complex
    #: The standard deviation of a modulus in Pa.
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
    """Fit, leave out the readings that lie far off, and fit again until none changes sides.

    Arguments are those of `fit`.

    Far is OUTLYING times the readings' own scatter, by the median of their distances from the model. Where so
    many are far that the model must be wrong, all are used.
    """

    def fitted(used: NDArray[np.bool_]) -> Fitted:
        return fit(model, drives, readings, believed, prior, noise, progress, used)

    used = np.ones(readings.shape, bool)
    first = found = fitted(used)
    # The median of the modulus of a normal number, and of one of two parts, by their standard deviation.
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
    """Responses and state of the least misfit, weighed against their distance from the estimate.

    Readings (K, M) of drives (K, N): moduli, or complex. `believed` are the responses' moduli: re and im are
    along and across the phases that the model's array has. `prior` is the standard deviation of living ones,
    relative to the mean modulus; None learns it from step to step. `noise` in Pa is the least that
    readings are taken to have; of those that are not `used` nothing is taken.
    """
    phased, given, readings = np.iscomplexobj(readings), readings, readings * used
    state = _start(model, drives, readings, believed, used)
    n, known = len(believed), Belief(model, believed, prior)
    rms = float(np.sqrt(np.sum(np.abs(readings) ** 2) / used.sum()))
    count = int(used.sum()) * (2 if phased else 1)

    loudness = 2 * n + int(np.searchsorted(model.free, LOUDNESS))

    def place(off: Real, noise: float) -> Place:
        responses = believed + off[:n] + 1j * off[n : 2 * n]
        # The loudness takes the common part of the responses, so that they are nearest to their prior.
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
        # The part of the unknowns that the readings determine also uses up readings.
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
            # Only a whole step ends at the posterior's mean.
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
    """The current estimate, at the loudness of the readings and in the air that fits them best.

    The speeds within three standard deviations are looked through: over a large array a wave slips by more
    than half a length for a wrong one, which no step would find back from.
    """
    phased = np.iscomplexobj(readings)
    reach = 3 * model.spread[SPEED]
    best, start = -1.0, model.start
    for offset in np.arange(-reach, reach + SPEED_STEP, SPEED_STEP) if reach else [0.0]:
        state = model.start.copy()
        state[SPEED] = np.clip(state[SPEED] + offset, *AIR)
        p = _modelled(drives, believed, model.matrix(state), phased) * used
        product = np.vdot(p, readings) / np.linalg.norm(p)
        if abs(product) > best:
            state[LOUDNESS] = np.log(np.linalg.norm(readings) / np.linalg.norm(p))
            state[CLOCK] = np.angle(product) if phased else 0.0
            best, start = float(abs(product)), state
    return np.asarray(start)


def _modelled(
    drives: Complex, responses: Real | Complex, matrix: Complex, phased: bool, noise: float = 0.0
) -> Real | Complex:
    """The expected readings (K, M): p, or the root mean square of a modulus with noise."""
    p = drives @ (matrix * responses).T
    return p if phased else np.hypot(np.abs(p), noise)


def _normal(
    model: Model, drives: Complex, here: Place, spread: Real, used: NDArray[np.bool_]
) -> tuple[Real, Real]:
    """J^T J and J^T r of the residuals r, by the unknowns.

    d|p|/dx_i = conj(p)/|p| G_i q_i (re, -im), and the same of G's derivatives by the state, summed over i.
    |p| is that with noise.
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
    """The diagonal of a matrix's inverse, by Cholesky's factor: no rounding makes it negative."""
    return np.asarray(np.sum(np.linalg.inv(np.linalg.cholesky(square)) ** 2, axis=0))
