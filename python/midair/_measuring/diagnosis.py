"""Diagnosis: finds exchanged channels, delays and responses of boards from readings of known drives.

A first search compares orders of channels, sound speeds and delays of boards. Then `midair.calibrate` fits
responses, sound speed and the microphones' places, and pairs of channels are exchanged if that explains the
readings better. These two steps alternate until no pair is left.
"""

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._boards.board import changed
from .._midair import Scene
from .._support.arguments import without_warnings
from .calibrate import calibrate
from .fit import AIR, Complex, Real
from .result import Calibration

Indices = NDArray[np.intp]

#: Differences from the expected sound speed to try, in m/s; error of the best one in the fit, in m/s.
SPEEDS, LEFT = np.arange(-14.0, 14.5, 0.5), 3.0
#: A correlation of the readings with the model above this confirms the order of the channels.
ORDERED = 0.6
#: Largest number of boards whose delays the first search fits; more boards would have too many unknowns.
MOST_BOARDS = 12
#: Places closer than this, in m, match when a board is compared with its turned or mirrored copy.
SAME = 1e-3
#: Lower bound of the spread of living transducers' responses, relative to the usual response.
LEAST_SPREAD = 0.05
#: A transducer is suspected if its response is SUSPECT spreads off, or if a microphone's residuals correlate
#: with it by LEFT_OVER standard deviations. At most MOST_SUSPECTS are suspected.
SUSPECT, LEFT_OVER, MOST_SUSPECTS = 3.5, 5.0, 80
#: Penalties for reporting a transducer as reversed, dead, weak or with another phase, and two as exchanged:
#: -2 log of the frequency of such a fault.
REVERSED, DEAD, WEAK, ODD, EXCHANGED = 10.0, 8.0, 8.0, 10.0, 31.0
#: Smallest and largest gain of a weak transducer, relative to the usual one.
WEAKEST, STRONG = 0.1, 0.75
#: The delays of boards are final if they change by less than this, in rad, between two rounds.
SETTLED = 0.02
#: Largest number of rounds of calibration and exchange; steps of the fit of an exchanged pair.
ROUNDS, STEPS = 8, 3


class Diagnosis(NamedTuple):
    """Model of the boards after the diagnosis.

    Attributes
    ----------
    base
        Name of the wiring's overall order, "" for the expected one.
    order
        (N,): index of the position at which each channel's transducer is.
    cycles
        Channels that are exchanged in addition to `base`, as pairs or longer cycles.
    middle
        (B,) complex: the usual response of each board, relative to the array's.
    relative, error
        (N,) complex: each response relative to that of its board; error of its re and im.
    spread
        Standard deviation of re and im of living transducers' `relative`.
    calibration
        The fit with each channel at its found position, with sound speed and microphones.
    unexplained
        Residual of the readings, relative to their rms.
    """

    base: str
    order: Indices
    cycles: tuple[tuple[int, ...], ...]
    middle: Complex
    relative: Complex
    error: Real
    spread: float
    calibration: Calibration
    unexplained: float


def diagnose(
    scene: Scene, boards: Indices, drives: Complex, readings: Real | Complex, microphones_error: float | None
) -> Diagnosis:
    """Diagnose the array of a scene whose points are the microphones.

    Parameters
    ----------
    boards
        (N,): index of each channel's board, from 0 on.
    drives, readings, microphones_error
        Arguments of `midair.calibrate`.
    """
    own = np.ones(len(scene.array), complex) if scene.array.response is None else scene.array.response
    best = (-1.0, "", np.arange(len(own)), 0.0, np.ones(1, complex))
    for name, order in _orders(scene, boards):
        best = max(best, _look(scene, boards, name, order, own, drives, readings), key=lambda each: each[0])
        if best[0] > ORDERED:
            break
    _, base, order, speed, delays = best
    turned, expected = delays / np.abs(delays), order
    for _ in range(ROUNDS):
        # Each channel keeps its delay and response and gets the position of its transducer.
        places = {name: getattr(scene.array, name)[order] for name in ("positions", "normals")}
        array = changed(scene.array, **places, response=own * turned[boards])
        with without_warnings():
            # The diagnosis itself reports the problems that the calibration would warn of.
            found = calibrate(
                scene.replace(array=array, sound_speed=speed),
                drives,
                readings,
                sound_speed_error=LEFT,
                microphones_error=microphones_error,
            )
        left = float(np.sqrt(np.mean(np.abs(found.residuals) ** 2) / np.mean(np.abs(readings) ** 2)))
        sounding = (own != 0) & np.any(drives, axis=0)
        ratio, error = _ratio(found, own, sounding)
        middle, spread = _usual(ratio, boards, sounding)
        relative, error = ratio / middle[boards], error / np.abs(middle[boards])
        cycles = _cycles(expected, order)
        state = Diagnosis(base, order, cycles, middle, relative, error, spread, found, left)
        pairs = _Pairs(state, boards, own, sounding, drives, readings).exchanged()
        # The next calibration starts from these delays, so that it stays near this solution.
        delay = middle / np.abs(middle) * np.conj(middle[0]) / np.abs(middle[0])
        if not pairs and np.abs(delay - turned).max() < SETTLED:
            break
        turned, order = delay, order.copy()
        for i, j in pairs:
            order[[i, j]] = order[[j, i]]
    return state


def _cycles(expected: Indices, order: Indices) -> tuple[tuple[int, ...], ...]:
    """Return the cycles of channels that are at each other's expected positions."""
    then = np.argsort(expected)[order]
    rings, seen = [], set(np.flatnonzero(then == np.arange(len(then))).tolist())
    for first in range(len(then)):
        ring, at = [], first
        while at not in seen:
            seen.add(at)
            ring.append(at)
            at = int(then[at])
        if ring:
            rings.append(tuple(ring))
    return tuple(rings)


def _orders(scene: Scene, boards: Indices) -> Iterator[tuple[str, Indices]]:
    """Yield (name, order): the expected order, then those of exchanged, turned or mirrored boards."""
    identity = np.arange(len(boards))
    yield "", identity
    own = [np.flatnonzero(boards == b) for b in range(int(boards.max()) + 1)]
    whole = [("", identity)]
    if len(own) == 2 and len(own[0]) == len(own[1]):
        yield "boards exchanged", (exchanged := np.concatenate(own[::-1])[np.argsort(np.concatenate(own))])
        whole.append(("boards exchanged, ", exchanged))
    names = ("turned by 90 degrees", "turned by 180 degrees", "turned by 270 degrees")
    quarter, mirror = np.array([[0, -1], [1, 0]]), np.diag([1, -1])
    turns = [np.linalg.matrix_power(quarter, n) for n in range(4)]
    maps = [*zip(names, turns[1:], strict=True)]
    mirrored = "rows reversed", "mirrored at a diagonal", "columns reversed", "mirrored at the other diagonal"
    maps += [(name, turn @ mirror) for name, turn in zip(mirrored, turns, strict=True)]
    for name, turn in maps:
        each = [one for of in own if (one := _turned(scene, of, turn)) is not None]
        if len(each) < len(own):
            continue
        order = np.empty_like(identity)
        for of, one in zip(own, each, strict=True):
            order[of] = one
        for before, exchange in whole:
            yield before + name, exchange[order]


def _turned(scene: Scene, of: Indices, turn: NDArray[np.int64]) -> Indices | None:
    """Return a board's order after it is turned or mirrored in its plane, None if places do not match."""
    if len(of) < 2:
        return None
    places = scene.array.positions[of] - scene.array.positions[of].mean(axis=0)
    # Distances that differ by numerical errors alone are rounded to one value, so that the first of several
    # nearest neighbours is chosen.
    far = np.linalg.norm(places - places[0], axis=1).round(6)
    along = places[np.argsort(far, kind="stable")[1]] - places[0]
    along /= np.linalg.norm(along)
    frame = np.array([along, np.cross(scene.array.normals[of[0]], along)])
    flat = places @ frame.T
    apart = np.linalg.norm((flat @ turn.T)[:, None] - flat, axis=2)
    nearest = apart.argmin(axis=1)
    fits = apart.min(axis=1).max() < SAME and len(np.unique(nearest)) == len(of)
    return of[nearest] if fits else None


def _look(
    scene: Scene, boards: Indices, name: str, order: Indices, own: Complex, drives: Complex, readings: Real | Complex
) -> tuple[float, str, Indices, float, Complex]:
    """Return the best correlation of readings and model of an order, over sound speeds and delays."""
    best = (-1.0, name, order, scene.sound_speed, np.ones(int(boards.max()) + 1, complex))
    bare = changed(scene.array, response=None, mask=None, quantization=None)
    count = len(best[4])
    parts = [boards == b for b in range(count)] if count <= MOST_BOARDS else [np.ones(len(boards), bool)]
    for speed in np.clip(scene.sound_speed + SPEEDS, *AIR):
        matrix = _matrix(scene.replace(array=bare, sound_speed=float(speed)))[:, order] * own
        sums = np.stack([drives[:, part] @ matrix[:, part].T for part in parts], axis=-1)
        delays = _delays(sums.reshape(-1, len(parts)), readings.ravel())
        p = (sums @ delays).ravel()
        received = readings.ravel()
        if not np.iscomplexobj(received):
            # The moduli of any two models have similar means, which would hide the difference.
            p, received = np.abs(p) - np.abs(p).mean(), received - received.mean()
        size = float(np.linalg.norm(p) * np.linalg.norm(received))
        match = float(abs(np.vdot(p, received))) / max(size, 1e-30)
        if match > best[0]:
            best = match, name, order, float(speed), np.broadcast_to(delays, count)
    return best


def _delays(sums: Complex, readings: Real | Complex) -> Complex:
    """Return factors v (B,) with which the boards' pressures (K, B) add up to the readings (K,).

    If the readings are moduli: |sum v_b a_b|^2 is linear in the products v_b conj(v_c), and v is the leading
    eigenvector of the matrix of these products. The first factor is positive.
    """
    count = sums.shape[1]
    if np.iscomplexobj(readings):
        v = np.linalg.lstsq(sums, readings, rcond=None)[0]
    else:
        pairs = list(combinations(range(count), 2))
        products = [sums[:, b] * np.conj(sums[:, c]) for b, c in pairs]
        cross = np.stack(products, axis=1) if pairs else sums[:, :0]
        columns = np.hstack([np.abs(sums) ** 2, 2 * cross.real, -2 * cross.imag])
        found = np.linalg.lstsq(columns, readings**2, rcond=None)[0]
        matrix = np.diag(found[:count]).astype(complex)
        for (b, c), re, im in zip(pairs, found[count:], found[count + len(pairs) :], strict=False):
            matrix[b, c], matrix[c, b] = re + 1j * im, re - 1j * im
        v = np.linalg.eigh(matrix)[1][:, -1]
    v = v * np.conj(v[0]) / max(abs(v[0]), 1e-30)
    return np.where(np.abs(v) > 1e-6, v, 1e-6)


def _matrix(scene: Scene) -> Complex:
    with without_warnings():
        return np.asarray(scene.propagation(), np.complex128)


def _ratio(found: Calibration, own: Complex, sounding: NDArray[np.bool_]) -> tuple[Complex, Real]:
    """Return responses relative to the array's own, and their errors; 1 for transducers that cannot play."""
    divisor = np.where(own == 0, 1, own)
    ratio = np.where(sounding, found.response / divisor, 1)
    return ratio, np.asarray(found.response_error / np.abs(divisor))


def _usual(ratio: Complex, boards: Indices, sounding: NDArray[np.bool_]) -> tuple[Complex, float]:
    """Return the usual response (B,) of each board, and the spread of re and im of all responses about it."""
    middle, off = np.ones(int(boards.max()) + 1, complex), np.full(len(ratio), np.nan + 0j)
    for b in range(len(middle)):
        of = (boards == b) & sounding
        # Dead transducers are left out; on a mostly dead board, 0 would otherwise count as the usual
        # response.
        alive = of & (np.abs(ratio) > 0.1 * np.abs(ratio).max())
        if not alive.any():
            continue
        x = ratio[alive]
        at = np.median(np.abs(x)) * np.exp(1j * np.angle(np.sum(x / np.abs(x))))
        near = x[np.abs(x / at - 1) < 0.5]
        middle[b] = near.mean() if len(near) else at
        off[of] = ratio[of] / middle[b] - 1
    parts = np.abs(np.r_[off.real, off.imag])
    spread = 1.4826 * float(np.nanmedian(parts)) if np.isfinite(parts).any() else LEAST_SPREAD
    return middle, max(spread, LEAST_SPREAD)


def cost(relative: Complex, error: Real, spread: float) -> Real:
    """Return the least cost (N,) of each transducer's states: healthy, reversed, dead, weak, other."""
    v = spread**2 + error**2
    best = np.clip(relative.real, WEAKEST, STRONG)
    kinds = (
        np.abs(relative - 1) ** 2 / v,
        np.abs(relative + 1) ** 2 / v + REVERSED,
        np.abs(relative) ** 2 / (error**2 + 1e-4) + DEAD,
        np.abs(relative - best) ** 2 / v + WEAK,
        2 * np.log(0.72 / v) + ODD,
    )
    return np.asarray(np.minimum.reduce([np.broadcast_to(kind, relative.shape) for kind in kinds]))


class _Pairs:
    """Finds pairs of suspected channels whose exchange explains the readings better."""

    def __init__(
        self,
        state: Diagnosis,
        boards: Indices,
        own: Complex,
        sounding: NDArray[np.bool_],
        drives: Complex,
        readings: Real | Complex,
    ) -> None:
        found = state.calibration
        self._drives, self._readings, self._state = drives, readings, state
        self._usual = own * state.middle[boards]
        bare = changed(found.array, response=None, mask=None, quantization=None)
        matrix = _matrix(found.scene.replace(array=bare, points=found.microphones))
        p = drives @ (matrix * found.response).T
        if np.iscomplexobj(readings):
            # The clock of the readings has an unknown phase, which is removed.
            turn = np.exp(1j * np.angle(np.vdot(p, readings)))
            matrix, p = matrix * turn, p * turn
        self._matrix, self._p = matrix, p
        self._noise = max(found.noise, 1e-12 * float(np.abs(readings).max()))
        left = self._left(p)
        self._misfit = float(np.vdot(left, left).real) / self._noise**2
        self._alone = cost(state.relative, state.error, state.spread)
        self._suspects = self._suspected(left, sounding)

    def exchanged(self) -> list[tuple[int, int]]:
        """Return the pairs to exchange, the most certain first. No channel is in two pairs."""
        gains = [(gain, i, j) for i, j in combinations(self._suspects.tolist(), 2) if (gain := self._gain(i, j)) > 0]
        taken: set[int] = set()
        pairs = []
        for _, i, j in sorted(gains, reverse=True):
            if not taken & {i, j}:
                taken |= {i, j}
                pairs.append((i, j))
        return pairs

    def _left(self, p: Complex) -> Real | Complex:
        return self._readings - (p if np.iscomplexobj(self._readings) else np.abs(p))

    def _suspected(self, left: Real | Complex, sounding: NDArray[np.bool_]) -> Indices:
        state = self._state
        v = np.sqrt(state.spread**2 + state.error**2)
        off = np.abs(state.relative - 1) / v / SUSPECT
        turn = 1.0 if np.iscomplexobj(left) else self._p / np.maximum(np.abs(self._p), 1e-30)
        # Correlation of the residuals with each channel, per microphone, in standard deviations.
        each = np.abs(self._drives.conj().T @ (left * turn))
        each /= np.maximum(np.median(each[sounding], axis=0) / 1.18, 1e-30)
        score = np.maximum(off, each.max(axis=1) / LEFT_OVER) * sounding
        order = np.argsort(-score)[:MOST_SUSPECTS]
        return np.sort(order[score[order] > 1])

    def _gain(self, i: int, j: int) -> float:
        """Return how much the cost falls if channels i and j are exchanged and both are healthy."""
        q, state = self._drives, self._state
        response = state.calibration.response
        kept = np.array([i, j])
        rest = self._p - (q[:, kept] * response[kept]) @ self._matrix[:, kept].T
        # (K, M, 2): pressure of each of the two channels from the other one's position.
        sent = q[:, None, kept] * (self._matrix[:, kept[::-1]] * self._usual[kept])
        x, v = np.ones(2, complex), state.spread**2
        for _ in range(STEPS):
            p = rest + sent @ x
            left = self._left(p)
            if np.iscomplexobj(left):
                rows = sent.reshape(-1, 2)
                rows = np.hstack([rows, 1j * rows])
                rows, flat = np.vstack([rows.real, rows.imag]), np.r_[left.real.ravel(), left.imag.ravel()]
            else:
                rows = (sent * (np.conj(p) / np.maximum(np.abs(p), 1e-30))[..., None]).reshape(-1, 2)
                rows, flat = np.hstack([rows.real, -rows.imag]), left.ravel()
            square = rows.T @ rows / self._noise**2 + np.eye(4) / v
            away = np.r_[x.real - 1, x.imag]
            step = np.linalg.solve(square, rows.T @ flat / self._noise**2 - away / v)
            x = x + step[:2] + 1j * step[2:]
        left = self._left(rest + sent @ x)
        then = float(np.vdot(left, left).real) / self._noise**2 + float(np.sum(np.abs(x - 1) ** 2)) / v
        return float(self._misfit + self._alone[i] + self._alone[j] - then - EXCHANGED)
