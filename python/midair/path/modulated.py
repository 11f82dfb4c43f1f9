"""Amplitude modulation: targets times a periodic curve between 1 and 0."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from ..shape.arguments import number, refused, word
from .piece import ROUNDING, Numbers, Piece

Shape: TypeAlias = Literal["sqrt", "cosine", "square"]

#: By periods since the start; each begins at 1.
SHAPES: dict[str, Callable[[Numbers], Numbers]] = {
    "sqrt": lambda periods: np.sqrt((1 + np.cos(2 * math.pi * periods)) / 2),
    "cosine": lambda periods: (1 + np.cos(2 * math.pi * periods)) / 2,
    "square": lambda periods: ((periods + ROUNDING) % 1 < 0.5).astype(np.float64),
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Modulated(Piece):
    """A piece whose targets are multiplied by 1 - depth + depth shape(frequency t)."""

    piece: Piece
    frequency: float
    shape: str
    depth: float

    def place(self, times: Numbers) -> Numbers:
        """As the piece's."""
        return self.piece.place(times)

    def pace(self, times: Numbers) -> Numbers:
        """As the piece's."""
        return self.piece.pace(times)

    def level(self, times: Numbers) -> Numbers:
        """Those of the piece, modulated."""
        factors = 1 - self.depth + self.depth * SHAPES[self.shape](self.frequency * times)
        return factors[:, None] * self.piece.level(times)


def modulated(piece: Piece, frequency: float, shape: str, depth: float) -> Piece:
    """The piece, modulated; a closed one holds a whole number of periods."""
    frequency, depth = number("frequency", frequency, above=0), number("depth", depth, least=0)
    if depth > 1:
        raise refused("depth", depth, "give a number from 0 to 1")
    if word("shape", shape) not in SHAPES:
        raise refused("shape", shape, f"give one of {', '.join(SHAPES)}")
    periods = frequency * piece.duration
    if piece.closed and abs(periods - round(periods)) > ROUNDING * max(periods, 1):
        near = " or ".join(
            f"{n / piece.duration:.10g}" for n in (math.floor(periods), math.ceil(periods)) if n
        )
        lasts = (
            f"the closed path of {piece.duration:.6g} s would hold {periods:.6g} periods and jump at its seam"
        )
        raise refused("frequency", frequency, f"{lasts}, give {near} Hz")
    return Modulated(
        points=piece.points,
        duration=piece.duration,
        closed=piece.closed,
        pascals=piece.pascals,
        modulation=max(piece.modulation, frequency),
        piece=piece,
        frequency=frequency,
        shape=shape,
        depth=depth,
    )
