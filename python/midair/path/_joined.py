"""Joins paths: at the same time, or one after the other with a fade where points do not continue.

A piece with M points has M slots. A point of the second piece that starts where a point of the first piece
ends keeps that point's slot. All other points of the first piece fade to 0. All other points of the second
piece rise from 0, in slots whose target is 0 or in new slots. A slot with target 0 has no point; only such a
slot may change its place suddenly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import stated
from .._support.arguments import shown
from ._piece import ROUNDING, Numbers, Piece, mixed

#: Two closed pieces played together must return to their starts within this many laps of one of them.
MOST_LAPS = 64


@dataclass(frozen=True, eq=False, kw_only=True)
class Beside(Piece):
    """All parts played at the same time: the points of one part after those of another.

    Closed parts repeat.
    """

    parts: tuple[Piece, ...]

    def place(self, times: Numbers) -> Numbers:
        """Return the places of all parts."""
        return self._all(times, lambda part: part.place)

    def pace(self, times: Numbers) -> Numbers:
        """Return the speeds of all parts."""
        return self._all(times, lambda part: part.pace)

    def level(self, times: Numbers) -> Numbers:
        """Return the targets of all parts."""
        return self._all(times, lambda part: part.level)

    def _all(self, times: Numbers, of: Callable[[Piece], Callable[[Numbers], Numbers]]) -> Numbers:
        return np.concatenate([of(part)(part.within(times)) for part in self.parts], axis=1)


def beside(first: Piece, second: Piece) -> Piece:
    """Return both paths played at the same time.

    They have the same duration, or both are closed and repeat until both are at their start again.
    """
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
    """Raise SceneError if one path has targets in Pa and the other relative ones."""
    if first.pascals != second.pascals:
        which = "first" if first.pascals else "second"
        cure = "give them for both or for neither"
        raise stated("pressures", f"are given for the {which} path only", cure, code="conflict")


def _together(first: Piece, second: Piece) -> float:
    """Return the duration after which both pieces end or are at their starts again."""
    ratio = Fraction(1)
    if first.closed and second.closed and ROUNDING < first.duration / second.duration < 1 / ROUNDING:
        ratio = Fraction(first.duration / second.duration).limit_denominator(MOST_LAPS)
    laps, others = ratio.denominator, ratio.numerator
    ends = laps * first.duration, others * second.duration
    if not 0 < others <= MOST_LAPS or abs(ends[0] - ends[1]) > ROUNDING * max(ends):
        cure = f"two closed ones durations in a ratio of whole numbers up to {MOST_LAPS}"
        words = f"last {first.duration:.6g} and {second.duration:.6g} s"
        raise stated("the paths", words, f"give them one duration, or {cure}")
    return ends[0]


#: An end and a start closer than this, in m, count as the same place: a ten-thousandth of the wavelength.
MEET = 1e-6


@dataclass(frozen=True, eq=False)
class Part:
    """A piece and the slots (rows in the joined path) of its points.

    All other slots stay at `idle` (M, 3), with target 0.
    """

    piece: Piece
    slots: NDArray[np.int64]
    idle: Numbers


@dataclass(frozen=True, eq=False, kw_only=True)
class Joined(Piece):
    """Parts one after the other, each with its start in s."""

    parts: tuple[Part, ...]
    starts: Numbers

    def place(self, times: Numbers) -> Numbers:
        """Return the places, from the part that plays at each time."""
        return self._each(times, lambda part: part.idle, lambda part: part.piece.place)

    def pace(self, times: Numbers) -> Numbers:
        """Return the speeds, from the part that plays at each time."""
        return self._each(times, lambda _: np.zeros(self.points), lambda part: part.piece.pace)

    def level(self, times: Numbers) -> Numbers:
        """Return the targets, from the part that plays at each time."""
        return self._each(times, lambda _: np.zeros(self.points), lambda part: part.piece.level)

    def _each(
        self,
        times: Numbers,
        idle: Callable[[Part], Numbers],
        moving: Callable[[Part], Callable[[Numbers], Numbers]],
    ) -> Numbers:
        which = (np.searchsorted(self.starts, times, side="right") - 1).clip(0)
        found = np.empty((len(times), *idle(self.parts[0]).shape))
        for index in np.unique(which):
            part, here = self.parts[index], which == index
            values = np.tile(idle(part), (int(here.sum()), *[1] * (found.ndim - 1)))
            values[:, part.slots] = moving(part)(part.piece.within(times[here] - self.starts[index]))
            found[here] = values
        return found


@dataclass(frozen=True, eq=False, kw_only=True)
class Fade(Piece):
    """Points at rest whose targets change along half a period of a cosine, from `before` to `after`."""

    #: Places (M, 3) in m.
    at: Numbers
    #: Targets (M,) at the start and at the end.
    before: Numbers
    after: Numbers

    def place(self, times: Numbers) -> Numbers:
        """Return the places, which do not change."""
        return np.tile(self.at, (len(times), 1, 1))

    def pace(self, times: Numbers) -> Numbers:
        """Return the speeds, which are 0."""
        return np.zeros((len(times), self.points))

    def level(self, times: Numbers) -> Numbers:
        """Return before (1 + c) / 2 + after (1 - c) / 2, with c = cos(pi t / duration)."""
        shares = (1 - np.cos(math.pi * times / self.duration)[:, None]) / 2
        return mixed(self.before, self.after, shares)


class State(NamedTuple):
    """Places (M, 3) in m and targets (M,) at one time."""

    places: Numbers
    targets: Numbers


def then(first: Piece, second: Piece, fade: float | None) -> Piece:
    """Return the second piece after the first, with a fade of `fade` s between them unless they meet."""
    same_unit(first, second)
    end, begin = _state(first, first.duration), _state(second, 0.0)
    slots, goes_on = _slots(end, begin)
    points = max(first.points, int(slots.max()) + 1)
    more = points - first.points
    places = np.concatenate([end.places, np.zeros((more, 3))])
    places[slots[~goes_on]] = begin.places[~goes_on]
    before = np.concatenate([end.targets, np.zeros(more)])
    after = np.zeros(points)
    after[slots] = begin.targets
    parts = list(_parts(first))
    if more:
        new = places[first.points :]
        parts = [Part(part.piece, part.slots, np.concatenate([part.idle, new])) for part in parts]
    if not np.allclose(before, after, rtol=ROUNDING, atol=0):
        if fade is None:
            raise stated("", f"{_jump(end, begin, slots, goes_on)}", "give a fade in s, such as fade=0.05")
        rest = Fade(
            points=points,
            duration=fade,
            closed=False,
            pascals=first.pascals,
            at=places,
            before=before,
            after=after,
        )
        parts.append(Part(rest, np.arange(points), places))
    for part in _parts(second):
        idle = places.copy()
        idle[slots] = part.idle
        parts.append(Part(part.piece, slots[part.slots], idle))
    return _joined(parts, first.pascals, points)


def _joined(parts: list[Part], pascals: bool, points: int) -> Joined:
    ends = np.cumsum([part.piece.duration for part in parts])
    path = Joined(
        points=points,
        duration=float(ends[-1]),
        closed=False,
        pascals=pascals,
        modulation=max(part.piece.modulation for part in parts),
        parts=tuple(parts),
        starts=np.concatenate([[0.0], ends[:-1]]),
    )
    first, last = _state(path, 0.0), _state(path, path.duration)
    apart = np.linalg.norm(first.places - last.places, axis=1)
    meets = bool((apart[first.targets > 0] <= MEET).all())
    return replace(path, closed=meets and np.allclose(first.targets, last.targets, rtol=ROUNDING, atol=0))


def _parts(piece: Piece) -> Sequence[Part]:
    if isinstance(piece, Joined):
        return piece.parts
    return [Part(piece, np.arange(piece.points), np.zeros((piece.points, 3)))]


def _state(piece: Piece, time: float) -> State:
    at = piece.within(np.array([time]))
    return State(piece.place(at)[0], piece.level(at)[0])


def _slots(end: State, begin: State) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the slot of each point of the second piece, and whether it continues a point of the first piece.

    A slot is a point's index in the joined path.
    """
    count = len(begin.places)
    slots, goes_on = np.full(count, -1), np.zeros(count, bool)
    open_ends = end.targets > 0
    for j in np.flatnonzero(begin.targets > 0):
        apart = np.where(open_ends, np.linalg.norm(end.places - begin.places[j], axis=1), np.inf)
        nearest = int(apart.argmin())
        if apart[nearest] <= MEET:
            slots[j], goes_on[j], open_ends[nearest] = nearest, True, False
    new = int((~goes_on).sum())
    free = np.concatenate([np.flatnonzero(end.targets <= 0), len(end.places) + np.arange(new)])
    slots[~goes_on] = free[:new]
    return slots, goes_on


def _jump(end: State, begin: State, slots: NDArray[np.int64], goes_on: NDArray[np.bool_]) -> str:
    """Return the difference between end and start as text, for an error."""
    counts = [int((state.targets > 0).sum()) for state in (end, begin)]
    if counts[0] != counts[1]:
        return f"M changes from {counts[0]} to {counts[1]} at the joint"
    starts = np.flatnonzero((begin.targets > 0) & ~goes_on)
    if len(starts):
        left = np.setdiff1d(np.flatnonzero(end.targets > 0), slots[goes_on])
        point = int(starts[0])
        apart = np.linalg.norm(end.places[left] - begin.places[point], axis=1).min()
        return f"point {point} of the second path starts {apart * 1e3:.4g} mm from where the first ends"
    return f"targets jump from {shown(end.targets.tolist())} to {shown(begin.targets.tolist())} at the joint"
