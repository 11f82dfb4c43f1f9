"""Pieces side by side: their points at the same time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from .._midair import SceneError
from ._piece import ROUNDING, Numbers, Piece

#: Closed pieces of different durations meet again after at most as many laps of one.
MOST_LAPS = 64


@dataclass(frozen=True, eq=False, kw_only=True)
class Beside(Piece):
    """The points of all parts, one part after the other; a closed part may go around several times."""

    parts: tuple[Piece, ...]

    def place(self, times: Numbers) -> Numbers:
        """Places of all parts."""
        return self._all(times, lambda part: part.place)

    def pace(self, times: Numbers) -> Numbers:
        """Speeds of all parts."""
        return self._all(times, lambda part: part.pace)

    def level(self, times: Numbers) -> Numbers:
        """Targets of all parts."""
        return self._all(times, lambda part: part.level)

    def _all(self, times: Numbers, of: Callable[[Piece], Callable[[Numbers], Numbers]]) -> Numbers:
        return np.concatenate([of(part)(part.within(times)) for part in self.parts], axis=1)


def beside(first: Piece, second: Piece) -> Piece:
    """Both at the same time, of one duration, or closed and around until both are at their start again."""
    same_unit(first, second)
    return Beside(
        points=first.points + second.points,
        duration=_together(first, second),
        closed=first.closed and second.closed,
        pascals=first.pascals,
        modulation=max(first.modulation, second.modulation),
        parts=tuple(
            part
            for piece in (first, second)
            for part in (piece.parts if isinstance(piece, Beside) else [piece])
        ),
    )


def same_unit(first: Piece, second: Piece) -> None:
    """Refuse a path in Pa together with one that leaves pressures to the balance."""
    if first.pascals != second.pascals:
        which = "first" if first.pascals else "second"
        raise SceneError(f"pressures are given for the {which} path only: give them for both or for neither")


def _together(first: Piece, second: Piece) -> float:
    """The duration after which both end, or join their starts."""
    ratio = Fraction(1)
    if first.closed and second.closed and ROUNDING < first.duration / second.duration < 1 / ROUNDING:
        ratio = Fraction(first.duration / second.duration).limit_denominator(MOST_LAPS)
    laps, others = ratio.denominator, ratio.numerator
    ends = laps * first.duration, others * second.duration
    if not 0 < others <= MOST_LAPS or abs(ends[0] - ends[1]) > ROUNDING * max(ends):
        raise SceneError(
            f"the paths last {first.duration:.6g} and {second.duration:.6g} s: give them one duration, or "
            f"two closed ones durations in a ratio of whole numbers up to {MOST_LAPS}"
        )
    return ends[0]
