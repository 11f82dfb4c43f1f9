"""Schedule: which focus plays in which frame, so that a curve on the skin is felt most.

One focus at full drive at a time, or none, is enough. Strength is a convex function of the pushes, and the
pushes of several foci at once lie between those of one: a convex function is largest at the corners.

With the answer D_xf of place x at line f, the strength without the slow channel is s = sum_x u_x |D_x|. It is
at least its tangent at another schedule, so the focus of the largest tangent in each frame never lowers it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Plane, Scene, solve_batch
from .._motion.felt import FAST, HIGHEST, threshold
from .._motion.sheet import Sheet, squares

#: Foci beside a curve: so far apart at least, in m, and at most about this many.
APART, BESIDE = 4e-3, 250

#: Places of the curve that count, and lines at most: slow frames have many by their steps.
COUNTED, LINES = 64, 400

#: Rounds of an ascent, and those without a gain after which it ends, by aim.
ROUNDS, IDLE = 120, {"strong": 1, "even": 30}

#: The factor by which weaker places gain weight in a round.
LEVELLING = 0.3


@dataclass(frozen=True, eq=False)
class Foci:
    """Single foci that a schedule chooses from, and how a curve answers.

    Attributes
    ----------
    places
        (F, 3) in m.
    drives, levels
        (F, N), and |p| (F,) in Pa at each place.
    answers
        (L, X, F) of each line, place of the curve and focus: displacement over the threshold of the fast
        channel, of a focus that plays in one frame of the schedule; the largest is 1.
    frames
        T of the schedule.
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
        """Foci at the places of a curve (P, 3), first, and in its plane within `reach` of it."""
        places = np.concatenate([curve, _around(curve, plane, reach)])
        solved = solve_batch(array, places[:, None], solver="fast")
        skin, step = squares(plane), plane.size / max(plane.pixels - 1, 1)
        pushes = np.square(np.abs(Scene(array, skin).propagation() @ solved.drives.T))
        counted = curve[:: -(-len(curve) // COUNTED)]
        apart = np.linalg.norm(counted[:, None] - skin, axis=2)
        # The mean of log(r) over a disc of a square's area is that at e^(-1/2) of its radius.
        apart = np.maximum(apart, step * np.exp(-0.5) / np.sqrt(np.pi))
        lines = np.arange(1, min(int(HIGHEST * frames / rate * (1 + 1e-9)), LINES) + 1)
        weights = np.sinc(lines / frames) / threshold(lines * (rate / frames), [FAST])
        answers = np.empty((len(lines), len(counted), len(places)), np.complex64)
        for k, weight in enumerate(weights):
            answers[k] = (sheet.response(apart, lines[k] * rate / frames) * weight).astype(
                np.complex64
            ) @ pushes
        answers /= np.abs(answers).max()
        return cls(places, solved.drives, np.abs(solved.pressures[:, 0]), answers, frames)

    @property
    def _folded(self) -> NDArray[np.int64]:
        """The lines, as those of T samples."""
        return np.arange(1, 1 + len(self.answers)) % self.frames

    def _moved(self, schedule: NDArray[np.int64]) -> NDArray[np.complex64]:
        """The answer (L, X) to a schedule."""
        played = np.zeros((self.frames, len(self.places)), np.float32)
        (on,) = np.nonzero(schedule >= 0)
        played[on, schedule[on]] = 1
        lines = np.fft.fft(played, axis=0)[self._folded].astype(np.complex64)
        moved: NDArray[np.complex64] = np.matmul(self.answers, lines[..., None])[..., 0]
        return moved

    def climb(self, start: NDArray[np.int64], aim: str) -> NDArray[np.int64]:
        """The schedule (T,), -1 where nothing plays, that an ascent from another one ends at.

        Parameters
        ----------
        aim
            "strong", the largest mean strength; "even", the largest at the weakest place.
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
        """Response of the fast channel to a schedule (T,) at each place (X,), relative to another one's."""
        found: NDArray[np.float32] = np.linalg.norm(self._moved(schedule), axis=0)
        return found


def _around(curve: NDArray[np.float64], plane: Plane, reach: float) -> NDArray[np.float64]:
    """Places (K, 3) of a square grid in a plane, within `reach` of a curve and not on it."""
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
