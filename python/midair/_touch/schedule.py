"""Schedule: chooses which focus plays in which frame, so that a curve on the skin feels strongest.

It suffices to consider one focus at full drive at a time, or none. The strength is a convex function of the
radiation pressures, and the pressures of several foci together lie between those of single foci. A convex
function is largest at the corners of its domain.

Let D_xf be the displacement at place x and frequency line f, and u_x the weight of the place. Without the
slow tactile channel the strength is s = sum_x u_x |D_x|. It is never below its tangent at another schedule,
so choosing the focus with the largest tangent in each frame never reduces it.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import HIGHEST, Array, Membrane, Plane, Scene, SceneError, restated, solve_batch, threshold
from .._pictures.panel import squares
from .._support.arguments import flag, refused, vectors, warn, without_warnings
from ..path import Path, from_array

#: Places of a focus along the shape: their distance in m, and their largest number.
STEP, MOST = 2e-3, 200

#: Largest extent of a shape in m. Larger ones are not on a hand; their places are probably in mm.
LARGEST = 1.0

#: Frequencies in Hz of foci that are felt as a steady push: 5 to 15 Hz (Morisaki et al. 2022).
PRESSING = (5.0, 15.0)

#: Draw speeds in m/s: of the usual techniques, and further ones that are tried if there is a bound.
USUAL, SPEEDS = 7.0, (5.0, 6.0, 8.0, 10.0)


#: Foci beside a curve: their least distance in m, and their largest number, approximately.
APART, BESIDE = 4e-3, 250

#: Largest numbers of places of the curve and of frequency lines that are evaluated.
COUNTED, LINES = 64, 400

#: Largest number of iterations of an ascent; iterations without a gain after which it ends, by aim.
ROUNDS, IDLE = 120, {"strong": 1, "even": 30}

#: Exponent by which weaker places gain weight in an iteration.
LEVELLING = 0.3


class Foci(NamedTuple):
    """Single foci from which a schedule is chosen, and the skin's response to them.

    Attributes
    ----------
    places
        (F, 3) in m.
    drives, levels
        (F, N), and |p| (F,) in Pa at each focus's place.
    answers
        (L, X, F): displacement relative to the fast channel's threshold, at frequency line L and place X of
        the curve, of a focus F that plays in one frame of the schedule. Scaled so that the largest is 1.
    frames
        Number of frames T of the schedule.
    """

    places: NDArray[np.float64]
    drives: NDArray[np.complex64]
    levels: NDArray[np.float64]
    answers: NDArray[np.complex64]
    frames: int

    @classmethod
    def beside(
        cls,
        array: Array,
        curve: NDArray[np.float64],
        plane: Plane,
        reach: float,
        membrane: Membrane,
        rate: float,
        frames: int,
    ) -> "Foci":
        """Return foci at the places of a curve (P, 3), followed by others in its plane within `reach` m."""
        around = _around(curve, plane, reach)
        if len(around):
            around = around[(Scene(array, around).propagation() != 0).any(axis=1)]
        places = np.concatenate([curve, around])
        solved = solve_batch(array, places[:, None], solver="fast")
        skin, step = squares(plane), plane.size / max(plane.pixels - 1, 1)
        pushes = np.square(np.abs(Scene(array, skin).propagation() @ solved.drives.T))
        counted = curve[:: -(-len(curve) // COUNTED)]
        apart = np.linalg.norm(counted[:, None] - skin, axis=2)
        # The mean of log(r) over a disc is log(r) at e^(-1/2) of its radius; the disc has the area of a
        # square.
        apart = np.maximum(apart, step * np.exp(-0.5) / np.sqrt(np.pi))
        lines = np.arange(1, min(int(HIGHEST * frames / rate * (1 + 1e-9)), LINES) + 1)
        frequencies = (lines * (rate / frames)).astype(np.float64)
        weights = np.sinc(lines / frames) / threshold(True, frequencies)
        answers = np.empty((len(lines), len(counted), len(places)), np.complex64)
        for k, weight in enumerate(weights):
            answers[k] = (membrane.response(frequencies[k], apart) * weight).astype(np.complex64) @ pushes
        answers /= np.abs(answers).max()
        return cls(places, solved.drives, np.abs(solved.pressures[:, 0]), answers, frames)

    @property
    def _folded(self) -> NDArray[np.int64]:
        """Indices of the frequency lines in a discrete Fourier transform of T samples."""
        return np.arange(1, 1 + len(self.answers)) % self.frames

    def _moved(self, schedule: NDArray[np.int64]) -> NDArray[np.complex64]:
        """Return the response (L, X) to a schedule."""
        played = np.zeros((self.frames, len(self.places)), np.float32)
        (on,) = np.nonzero(schedule >= 0)
        played[on, schedule[on]] = 1
        lines = np.fft.fft(played, axis=0)[self._folded].astype(np.complex64)
        moved: NDArray[np.complex64] = np.matmul(self.answers, lines[..., None])[..., 0]
        return moved

    def climb(self, start: NDArray[np.int64], aim: str) -> NDArray[np.int64]:
        """Return the schedule (T,) at which an ascent from `start` ends; -1 where nothing plays.

        Parameters
        ----------
        aim
            "strong" maximises the mean strength, "even" the strength at the weakest place.
        """
        schedule, best, most, idle = start, start, 0.0, 0
        weights = np.ones(self.answers.shape[1])
        for _ in range(ROUNDS):
            moved = self._moved(schedule)
            strengths = np.linalg.norm(moved, axis=0)
            score = float(strengths.mean() if aim == "strong" else strengths.min())
            if score > most * (1 + 1e-4):
                best, most, idle = schedule, score, 0
            elif (idle := idle + 1) > IDLE[aim]:
                break
            if aim == "even":
                weights *= (strengths.mean() / np.maximum(strengths, 1e-6)) ** LEVELLING
                weights /= weights.mean()
            directions = (weights * moved / np.maximum(strengths, 1e-9)).conj().astype(np.complex64)
            slopes = np.zeros((self.frames, len(self.places)), np.complex64)
            np.add.at(slopes, self._folded, np.matmul(directions[:, None], self.answers)[:, 0])
            tangents = np.fft.fft(slopes, axis=0).real
            schedule = np.where(tangents.max(axis=1) > 0, tangents.argmax(axis=1), -1)
        return best

    def strengths(self, schedule: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return the fast channel's response (X,) to a schedule (T,), on a relative scale."""
        found: NDArray[np.float32] = np.linalg.norm(self._moved(schedule), axis=0)
        return found


def _around(curve: NDArray[np.float64], plane: Plane, reach: float) -> NDArray[np.float64]:
    """Return places (K, 3) of a square grid in a plane, within `reach` of a curve and not on it."""
    apart = APART
    while True:
        pixels = int(plane.size / apart) + 1
        side = (pixels - 1) * apart
        grid = squares(Plane(axis=plane.axis, at=plane.at, size=side, pixels=pixels, center=plane.center))
        nearest = np.min(np.linalg.norm(grid[:, None] - curve, axis=2), axis=1)
        inside: NDArray[np.float64] = grid[(nearest <= reach) & (nearest > apart / 3)]
        if len(inside) <= BESIDE:
            return inside
        apart *= 1.2


class Technique(NamedTuple):
    """Positions of the foci along a shape in each frame.

    Attributes
    ----------
    name
        Name for the report.
    ways
        (T, M): place of each focus as a fraction of the shape's length, 0 to 1.
    amplitudes
        (T,): amplitude of the drive.
    """

    name: str
    ways: NDArray[np.float64]
    amplitudes: NDArray[np.float64]


class Curve(NamedTuple):
    """Places (P, 3) in m at equal distances along a shape, its length in m, and whether it is closed.

    `given` has the places (K, 3) that a caller gave; none for a path.
    """

    given: NDArray[np.float64]
    places: NDArray[np.float64]
    length: float
    closed: bool

    @classmethod
    def of(cls, shape: Path | ArrayLike, closed: bool) -> "Curve":
        loops, given = flag("closed", closed), np.empty((0, 3))
        if isinstance(shape, Path):
            if shape.points != 1:
                raise refused("shape", shape, "give a path of one point, or places (K, 3)")
            corners = shape.at(np.linspace(0, shape.duration, 2000, endpoint=False))[:, 0]
            loops = shape.closed
        else:
            corners = given = vectors("shape", shape)
        extent = float(np.ptp(corners, axis=0).max())
        if extent > LARGEST:
            raise refused("shape", f"{extent:.4g} m large", f"give places in m, at most {LARGEST:g} m apart")
        if loops:
            corners = np.concatenate([corners, corners[:1]])
        ways = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        length = float(ways[-1])
        if length == 0:
            raise refused("shape", f"{length:g} m long", "give places that are apart")
        count = min(max(round(length / STEP), 2), MOST)
        at = np.linspace(0, length, count, endpoint=not loops)
        places = np.stack([np.interp(at, ways, column) for column in corners.T], axis=1)
        return cls(given, places, length, loops)

    def check(self, array: Array) -> Scene:
        """Return a scene of the array; rejects a shape with a place that is on or behind the transducers."""
        for k, place in enumerate([*self.given, *self.places]):
            item = f"shape[{k}]" if k < len(self.given) else "shape"
            try:
                # No warning about `points`, which a caller does not give.
                with without_warnings():
                    scene = Scene(array, [place])
                received = np.abs(scene.propagation()).max()
            except SceneError as error:
                raise restated(error, item=error.item.replace("points[0]", item)) from None
            if received == 0:
                cure = "no transducer reaches it, give places in front of the array"
                raise refused(item, place.tolist(), cure)
        if far := scene._far("shape", self.places):
            warn(far)
        return scene

    def indices(self, ways: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return indices of the places at fractions of the length. An open curve is run back and forth."""
        count = len(self.places)
        if self.closed:
            return np.rint(ways * count).astype(np.int64) % count
        back = np.abs((ways + 1) % 2 - 1)
        found: NDArray[np.int64] = np.rint(back * (count - 1)).astype(np.int64)
        return found

    def at(self, ways: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places (..., 3) at fractions of the length, between those of the curve."""
        count = len(self.places)
        ends = np.concatenate([self.places, self.places[:1]]) if self.closed else self.places
        where = ways % 1 * count if self.closed else np.abs((ways + 1) % 2 - 1) * (count - 1)
        return np.stack([np.interp(where, np.arange(len(ends)), column) for column in ends.T], axis=-1)


def _times(rate: float, frequency: float) -> NDArray[np.float64]:
    """Return the times of a period's frames, as fractions of the period, which is rounded to whole frames."""
    count = max(round(rate / frequency), 2)
    return np.arange(count) / count


def moving(curve: Curve, rate: float, speed: float, points: int) -> Technique:
    """Return the technique of foci that move along a curve at `speed` m/s, back and forth if it is open."""
    laps = 1 if curve.closed else 2
    t = _times(rate, speed / (laps * curve.length))
    ways = laps * t[:, None] + laps * np.arange(points) / points
    name = f"STM at {laps * curve.length * rate / len(t):.3g} m/s"
    return Technique(name if points == 1 else f"{name}, {points} foci", ways, np.ones(len(t)))


def pressing(curve: Curve, rate: float) -> Iterator[tuple[str, Path]]:
    """Yield techniques that are felt as a steady push: a focus runs along the curve, or several swing.

    They repeat 5 to 15 times a second, in steps as small as the rate allows (Morisaki et al. 2022).
    """
    laps, rest = 1 if curve.closed else 2, _rest(curve)
    for frequency in PRESSING:
        t = _times(rate, frequency)[:, None]
        ways = rest + 0.25 / len(rest) * np.sin(2 * np.pi * t)
        for name, moved in (
            (f"{frequency:g} laps/s", laps * t),
            (f"{len(rest)} foci, {frequency:g} Hz", ways),
        ):
            yield f"pressure, {name}", from_array(curve.at(moved), rate=rate, closed=True)


def _rest(curve: Curve) -> NDArray[np.float64]:
    """Return places of foci at rest, 1 cm apart, as fractions of the length."""
    spread = max(round(curve.length / 0.01), 2)
    found: NDArray[np.float64] = (np.arange(spread) + 0.5 * (not curve.closed)) / spread
    return found


def usual(curve: Curve, rate: float) -> Iterator[Technique]:
    """Yield the four usual techniques: amplitude and lateral modulation, one and two foci that move along."""
    rest = _rest(curve)
    spread, t = len(rest), _times(rate, 200.0)
    amplitudes = np.sqrt((1 + np.cos(2 * np.pi * t)) / 2)
    still = np.tile(rest, (len(t), 1))
    yield Technique(f"AM at {rate / len(t):.4g} Hz, {spread} foci", still, amplitudes)
    t = _times(rate, 100.0)
    ways = rest + 0.25 / spread * np.sin(2 * np.pi * t)[:, None]
    yield Technique(f"LM at {rate / len(t):.4g} Hz, {spread} foci", ways, np.ones(len(t)))
    yield from (moving(curve, rate, USUAL, points) for points in (1, 2))
