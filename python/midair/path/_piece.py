"""Base class of paths, and checks of their arguments. Errors state name, value and cure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import numbers, stated
from .._support.arguments import vectors

#: Values at times (T,): speeds and targets (T, M), places (T, M, 3).
Numbers: TypeAlias = NDArray[np.float64]

#: Tolerance of times, relative to a frame or a period, so that rounding errors never decide whether a time is
#: before or after a jump.
ROUNDING = 1e-9


def mixed(before: Numbers, after: Numbers, shares: Numbers) -> Numbers:
    """Return linear interpolation: `before` at share 0, `after` at share 1.

    The result is exact at both ends, and where `before` equals `after`.
    """
    return np.where(shares == 1, after, before + shares * (after - before))


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece(ABC):
    """M points that move for a time.

    `place`, `pace` and `level` are called with times within the piece only.
    """

    #: Number of points M.
    points: int
    #: Duration in s.
    duration: float
    #: Whether the end joins the start: the piece can repeat.
    closed: bool
    #: Whether the targets are in Pa; otherwise they are factors from 0 to 1.
    pascals: bool
    #: Highest frequency of amplitude modulation, in Hz.
    modulation: float = 0.0

    @abstractmethod
    def place(self, times: Numbers) -> Numbers:
        """Return the places (T, M, 3) in m."""

    @abstractmethod
    def pace(self, times: Numbers) -> Numbers:
        """Return the speeds (T, M) in m/s."""

    @abstractmethod
    def level(self, times: Numbers) -> Numbers:
        """Return the targets (T, M)."""

    def within(self, times: Numbers) -> Numbers:
        """Return times within the piece: modulo its duration if it is closed, else limited to its ends."""
        return times % self.duration if self.closed else times.clip(0.0, self.duration)


#: Largest coordinate in m; points farther away are rejected.
FARTHEST = 1e6


def instants(value: ArrayLike) -> Numbers:
    """Check times (T,); rejects times that are not finite."""
    return numbers("times", value, [(-1,), (0,)], "give a list of finite times in s")


def constant_pressures(value: ArrayLike | None, points: int) -> Numbers:
    """Return targets (M,) in Pa: one value for all points or one for each; 1 if None is given."""
    return np.ones(points) if value is None else _pressures(value, (points,))


def changing_pressures(value: ArrayLike | None, frames: int, points: int) -> Numbers:
    """Return targets (T, M) in Pa: one value for all, per point, or per frame and point; 1 if None."""
    return np.ones((frames, points)) if value is None else _pressures(value, (frames, points))


def _pressures(value: ArrayLike, shape: tuple[int, ...]) -> Numbers:
    sizes = [shape[k:] for k in range(len(shape))]
    forms = ["one number", *(" x ".join(map(str, size)) for size in reversed(sizes))]
    cure = f"give numbers of at least 0 in Pa: {' or '.join(forms)}"
    return np.broadcast_to(numbers("pressures", value, [(), *sizes], cure, least=0), shape)


def point_sets(item: str, value: Any) -> Numbers:
    """Return frames (T, M, 3) of points: at least two frames, each with the same number of points."""
    cure = "give frames x points x 3 numbers in m, at least two frames of at least one point"
    if isinstance(value, list | tuple | Iterator):
        frames = [vectors(f"{item}[{index}]", frame, least=1) for index, frame in enumerate(value)]
        for index, frame in enumerate(frames):
            if len(frame) != len(frames[0]):
                change = f"M changes from {len(frames[0])} to {len(frame)} at frame {index}"
                raise stated("", change, "join paths with a fade, a.then(b, fade=)")
        value = np.array(frames)
    return numbers(item, value, [(-2, -1, 3)], cure, most=FARTHEST)
