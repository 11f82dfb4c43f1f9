"""Piece of a path: points in time, each with its place, its speed and its target."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

#: Of times (T,), ways (T, M), places (T, M, 3), targets (T, M).
Numbers: TypeAlias = NDArray[np.float64]

#: Rounding of times, in parts of a frame or of a period, never decides on which side of a step they lie.
ROUNDING = 1e-9


def mixed(before: Numbers, after: Numbers, shares: Numbers) -> Numbers:
    """Before where the share is 0, after where it is 1, straight between; exact at both and at rest."""
    return np.where(shares == 1, after, before + shares * (after - before))


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece(ABC):
    """M points that move for a time; `place`, `pace` and `level` are asked for times within it only."""

    #: M.
    points: int
    #: In s.
    duration: float
    #: Whether the end joins the start: a time after the end is one after the start.
    closed: bool
    #: Whether targets are in Pa, or relative to full.
    pascals: bool
    #: Highest frequency of amplitude modulation, in Hz.
    modulation: float = 0.0

    @abstractmethod
    def place(self, times: Numbers) -> Numbers:
        """(T, M, 3) in m."""

    @abstractmethod
    def pace(self, times: Numbers) -> Numbers:
        """Speeds (T, M) in m/s."""

    @abstractmethod
    def level(self, times: Numbers) -> Numbers:
        """Targets (T, M)."""

    def within(self, times: Numbers) -> Numbers:
        """Times brought into the piece: around where it is closed, else to its start or its end."""
        return times % self.duration if self.closed else times.clip(0.0, self.duration)
