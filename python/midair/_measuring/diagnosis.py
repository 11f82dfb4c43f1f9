"""Diagnosis: faults of boards from readings of known drives.

It first tries orders of channels, sound speeds and delays of boards. `midair.calibrate` fits responses,
sound speed and the microphones' places. Pairs of channels are exchanged if that explains the readings
better. The last two steps alternate until no pair is left.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from .._boards.layout import changed
from .._midair import Scene, SceneWarning
from .calibrate import calibrate
from .model import AIR, Complex, Real
from .result import Calibration

Indices = NDArray[np.intp]

#: Sound speeds that are tried about the expected one, in m/s; largest error of the best of them.
SPEEDS, LEFT = np.arange(-14.0, 14.5, 0.5), 3.0
#: Readings that correlate with the model by more than this confirm its order.
ORDERED = 0.6
#: Boards with unknown delays: with more, the first search has too many unknowns.
MOST_BOARDS = 12
#: Places nearer than this, in m, count as one when a board is turned or mirrored.
SAME = 1e-3
#: The least spread of living transducers' responses, relative to their middle.
LEAST_SPREAD = 0.05
#: A transducer is suspected if its response is this many spreads off, or if the residuals of one
#: microphone point to it by this many deviations; at most this many are suspected.
SUSPECT, LEFT_OVER, MOST_SUSPECTS = 3.5, 5.0, 80
#: Penalties for reporting a transducer as reversed, dead, weak, of another phase, or two as exchanged: -2
#: log of the frequency of such a fault.
REVERSED, DEAD, WEAK, ODD, EXCHANGED = 10.0, 8.0, 8.0, 10.0, 31.0
#: A weak transducer has at least this part of the usual gain, and at most that.
WEAKEST, STRONG = 0.1, 0.75
#: Delays of boards are final if they change by less, in rad, from round to round.
SETTLED = 0.02
#: Rounds of calibration, and steps of the fit of a pair.
ROUNDS, STEPS = 8, 3


@dataclass(frozen=True)
class Diagnosis:
    """Model of boards after the diagnosis.

    Attributes
    ----------
    base
        Name of the order of the whole wiring, "" for the expected one.
    order
        (N,) the place of each channel's transducer.
    cycles
        Channels that are exchanged beyond that order, pairs and rings.
    middle
        (B,) complex, the usual response of each board relative to the array's.
    relative
        (N,) complex, each response relative to that of its board; error : (N,) of re and im.
    spread
        Of living responses about their board's, of re and im.
    calibration
        Of the channels at their places, with sound speed and microphones.
    unexplained
        Residual of the readings, as a part of their root mean square.
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

    @property
    def wave_number(self) -> float:
        """2 pi f / c, in rad/m."""
        return 2 * np.pi * self.calibration.scene.frequency / self.calibration.sound_speed


def diagnose(
    scene: Scene,
    boards: Indices,
    drives: Complex,
    readings: Real | Complex,
    microphones_error: float | None,
) -> Diagnosis:
    """Diagnose the array of a scene whose points are the microphones.

    Parameters
    ----------
    boards
        (N,) the board of each channel, from 0 on.
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
        # The channel keeps its delay and response; the place is that of its transducer.
        array = changed(
            scene.array,
            positions=scene.array.positions[order],
            normals=scene.array.normals[order],
            response=own * turned[boards],
        )
        with warnings.catch_warnings():
            # The report contains the warnings of the calibration.
            warnings.simplefilter("ignore", SceneWarning)
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
        # The calibration starts from the delays of its last result, so that it stays there.
        delay = middle / np.abs(middle) * np.conj(middle[0]) / np.abs(middle[0])
        if not pairs and np.abs(delay - turned).max() < SETTLED:
            break
        turned, order = delay, order.copy()
        for i, j in pairs:
            order[[i, j]] = order[[j, i]]
    return state


def _cycles(expected: Indices, order: Indices) -> tuple[tuple[int, ...], ...]:
    """The rings of channels that are at each other's expected places."""
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
    """Yield the expected order, then those of exchanged, turned or mirrored boards."""
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
    """Transducers of a board after it is turned or mirrored in its plane, or None if they do not match."""
    if len(of) < 2:
        return None
    places = scene.array.positions[of] - scene.array.positions[of].mean(axis=0)
    # The first of equally near neighbours.
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
    scene: Scene,
    boards: Indices,
    name: str,
    order: Indices,
    own: Complex,
    drives: Complex,
    readings: Real | Complex,
) -> tuple[float, str, Indices, float, Complex]:
    """Correlation of the readings with an order's model, at the best speed and delays."""
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
            # Moduli of any two models have a similar mean.
            p, received = np.abs(p) - np.abs(p).mean(), received - received.mean()
        size = float(np.linalg.norm(p) * np.linalg.norm(received))
        match = float(abs(np.vdot(p, received))) / max(size, 1e-30)
        if match > best[0]:
            best = match, name, order, float(speed), np.broadcast_to(delays, count)
    return best


def _delays(sums: Complex, readings: Real | Complex) -> Complex:
    """Factors of each board's sum (K, B) with which all together give the readings (K,).

    Moduli are linear in the products v_b conj(v_c): |sum v_b a_b|^2. Of their matrix v is the leading
    eigenvector. The first board's is positive.
    """
    count = sums.shape[1]
    if np.iscomplexobj(readings):
        v = np.linalg.lstsq(sums, readings, rcond=None)[0]
    else:
        pairs = list(combinations(range(count), 2))
        cross = (
            np.stack([sums[:, b] * np.conj(sums[:, c]) for b, c in pairs], axis=1) if pairs else sums[:, :0]
        )
        columns = np.hstack([np.abs(sums) ** 2, 2 * cross.real, -2 * cross.imag])
        found = np.linalg.lstsq(columns, readings**2, rcond=None)[0]
        matrix = np.diag(found[:count]).astype(complex)
        for (b, c), re, im in zip(pairs, found[count:], found[count + len(pairs) :], strict=False):
            matrix[b, c], matrix[c, b] = re + 1j * im, re - 1j * im
        v = np.linalg.eigh(matrix)[1][:, -1]
    v = v * np.conj(v[0]) / max(abs(v[0]), 1e-30)
    return np.where(np.abs(v) > 1e-6, v, 1e-6)


def _matrix(scene: Scene) -> Complex:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)
        return np.asarray(scene.propagation(), np.complex128)


def _ratio(found: Calibration, own: Complex, sounding: NDArray[np.bool_]) -> tuple[Complex, Real]:
    """Responses relative to the array's own, and their errors; 1 for transducers that cannot play."""
    divisor = np.where(own == 0, 1, own)
    ratio = np.where(sounding, found.response / divisor, 1)
    return ratio, np.asarray(found.response_error / np.abs(divisor))


def _usual(ratio: Complex, boards: Indices, sounding: NDArray[np.bool_]) -> tuple[Complex, float]:
    """The middle (B,) of each board's responses, and the spread of re and im of all about it."""
    middle, off = np.ones(int(boards.max()) + 1, complex), np.full(len(ratio), np.nan + 0j)
    for b in range(len(middle)):
        of = (boards == b) & sounding
        # A mostly dead board has no other middle.
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
    """The least cost (N,) over the states of a transducer: healthy, reversed, dead, weak, or anything."""
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
    """Suspected channels, and the pairs of them whose exchange explains the readings better."""

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
            # The clock of the readings.
            turn = np.exp(1j * np.angle(np.vdot(p, readings)))
            matrix, p = matrix * turn, p * turn
        self._matrix, self._p = matrix, p
        self._noise = max(found.noise, 1e-12 * float(np.abs(readings).max()))
        left = self._left(p)
        self._misfit = float(np.vdot(left, left).real) / self._noise**2
        self._alone = cost(state.relative, state.error, state.spread)
        self._suspects = self._suspected(left, sounding)

    def exchanged(self) -> list[tuple[int, int]]:
        """Pairs to exchange, the most certain first, each channel in one of them at most."""
        gains = [
            (gain, i, j)
            for i, j in combinations(self._suspects.tolist(), 2)
            if (gain := self._gain(i, j)) > 0
        ]
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
        # Residuals by channel and microphone, in units of their usual size.
        each = np.abs(self._drives.conj().T @ (left * turn))
        each /= np.maximum(np.median(each[sounding], axis=0) / 1.18, 1e-30)
        score = np.maximum(off, each.max(axis=1) / LEFT_OVER) * sounding
        order = np.argsort(-score)[:MOST_SUSPECTS]
        return np.sort(order[score[order] > 1])

    def _gain(self, i: int, j: int) -> float:
        """Reduction of the cost if i and j are exchanged, both healthy."""
        q, state = self._drives, self._state
        response = state.calibration.response
        kept = np.array([i, j])
        rest = self._p - (q[:, kept] * response[kept]) @ self._matrix[:, kept].T
        # (K, M, 2): the wave of each from the other's place.
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
