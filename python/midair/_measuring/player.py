"""Plays drives through the user's reader: counts, checks, and keeps the best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError

#: The end of tuning: complete, out of readings, stopped by Ctrl-C or progress, or ended by an error of the
#: reader.
Status = Literal["done", "out_of_readings", "stopped", "failed"]


@dataclass(frozen=True, eq=False)
class Tuning:
    """The best drive that `midair.tune` found, and what is read with it.

    drive : (N,), complex of |q| <= 1
    pressures : (M,) |p| with it, as read or as three readings determine it
    value : its distance from the targets: the residual of eq. (7) over silence's;
        feedback: 1 - uniformity
    readings : how often was read
    status : "done", "stopped", "out_of_readings" or "failed"
    error : what the reader raised, if it did
    trace : the value after each turn, step or reading
    """

    drive: NDArray[np.complex64]
    pressures: NDArray[np.float64]
    value: float
    readings: int
    status: Status
    error: Exception | None
    trace: NDArray[np.float64]


Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]
Drive = NDArray[np.complex64]
Read = Callable[[Drive], Any]

#: Changes of the drive after which a microphone that still gives the same hears nothing of it.
CHANGES = 2


class Ended(Exception):
    """Tuning is over before its end."""

    def __init__(self, status: Status) -> None:
        super().__init__(status)
        self.status = status


class Unreadable(Exception):
    """The reader raised."""

    def __init__(self, error: Exception) -> None:
        super().__init__(str(error))
        self.error = error


class Player:
    """Reads |p| (M,) of drives (N,), at most `budget` times, and keeps the best of the given ones.

    `value` measures the error of pressures; `progress` is called with (readings, of how many).
    """

    def __init__(
        self,
        read: Read,
        count: int,
        power: bool,
        value: Callable[[Real], float],
        budget: int,
        progress: Callable[[int, int], object],
    ) -> None:
        self._read, self._count, self._power = read, count, power
        self.value, self.budget, self._progress = value, budget, progress
        self.readings = 0
        self.best: tuple[float, Drive, Real] | None = None
        self.trace: list[float] = []
        self._last: Drive | None = None
        self._changes = 0
        self._quietest, self._loudest = np.full(count, np.inf), np.zeros(count)

    def __call__(self, drive: NDArray[Any]) -> Real:
        """|p| (M,) at the places, read."""
        if self.readings >= self.budget:
            raise Ended("out_of_readings")
        if self._progress(self.readings, self.budget) is False:
            raise Ended("stopped")
        played = drive.astype(np.complex64)
        played.flags.writeable = False
        try:
            given = self._read(played)
            found = self._checked(given)
        except Exception as error:
            raise Unreadable(error) from error
        self.readings += 1
        self._changes += self._last is not None and not np.array_equal(played, self._last)
        self._last = played
        self._quietest, self._loudest = np.minimum(found, self._quietest), np.maximum(found, self._loudest)
        self.offer(played, found)
        return found

    def offer(self, drive: NDArray[Any], pressures: Real) -> None:
        """Keep a drive if its pressures are nearer to the targets."""
        value = self.value(pressures)
        if self.best is None or value < self.best[0]:
            kept = drive.astype(np.complex64)
            kept.flags.writeable = False
            self.best = (value, kept, pressures)

    def deaf(self) -> str | None:
        """Places that gave 0 in all readings, or the same for every drive, in a line."""
        same = (self._loudest == self._quietest) & ((self._loudest == 0) | (self._changes >= CHANGES))
        if not same.any():
            return None
        first, *others = np.flatnonzero(same)
        where = f"{first} and {len(others)} more" if others else f"{first}"
        return (
            f"read gave |p| = {self._loudest[first]:.4g} at place {where} in all {self.readings} readings: "
            "a dead microphone, mend it or leave its point out"
        )

    def _checked(self, given: Any) -> Real:
        found = np.atleast_1d(np.asarray(given))
        kind = "|p|^2" if self._power else "|p|"
        if found.shape != (self._count,) or found.dtype.kind not in "iuf":
            raise SceneError(
                f"read gave {found.dtype} of shape {found.shape}: "
                f"give {kind} at {self._count} places, real numbers"
            )
        if not np.isfinite(found).all() or found.min() < 0:
            worst = int(np.flatnonzero(~np.isfinite(found) | (found < 0))[0])
            raise SceneError(f"read gave {found[worst]} at place {worst}: give finite {kind}, never negative")
        found = found.astype(np.float64)
        return np.sqrt(found) if self._power else found
