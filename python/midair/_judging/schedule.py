"""Schedule: chooses which focus plays in which frame, so that a curve on the skin feels strongest.

It suffices to consider one focus at full drive at a time, or none. The strength is a convex function of the
radiation pressures, and the pressures of several foci together lie between those of single foci. A convex
function is largest at the corners of its domain.

Let D_xf be the displacement at place x and frequency line f, and u_x the weight of the place. Without the
slow tactile channel the strength is s = sum_x u_x |D_x|. It is never below its tangent at another schedule,
so choosing the focus with the largest tangent in each frame never reduces it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._midair import HIGHEST, Array, Plane, Scene, Sheet, solve_batch, threshold
from .._motion.sheet import squares

#: Foci beside a curve: their least distance in m, and their largest number, approximately.
APART, BESIDE = 4e-3, 250

#: Largest numbers of places of the curve and of frequency lines that are evaluated.
COUNTED, LINES = 64, 400

#: Largest number of iterations of an ascent; iterations without a gain after which it ends, by aim.
ROUNDS, IDLE = 120, {"strong": 1, "even": 30}

#: Exponent by which weaker places gain weight in an iteration.
LEVELLING = 0.3


@dataclass(frozen=True, eq=False)
class Foci:
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
        sheet: Sheet,
        rate: float,
        frames: int,
    ) -> Foci:
        """Return foci at the places of a curve (P, 3), followed by others in its plane within `reach` m."""
        places = np.concatenate([curve, _around(curve, plane, reach)])
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
            answers[k] = (sheet.response(frequencies[k], apart) * weight).astype(np.complex64) @ pushes
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
