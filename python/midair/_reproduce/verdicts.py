"""Verdicts on the paper's statements."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .tables import Row

Outcome = Literal["holds", "holds in part", "does not hold"]


@dataclass(frozen=True)
class Verdict:
    """A statement, what became of it, and the numbers that decide."""

    figure: str
    statement: str
    verdict: Outcome
    evidence: str

    def row(self) -> Row:
        """As a row of verdicts.csv."""
        return asdict(self)


def outcome(*parts: bool) -> Outcome:
    """Of a statement with several parts."""
    if all(parts):
        return "holds"
    return "holds in part" if any(parts) else "does not hold"


def span(gaps: NDArray[np.float64], counts: list[int]) -> str:
    """Smallest and largest of differences of accuracy over M, in points."""
    ends = (int(gaps.argmin()), int(gaps.argmax()))
    return " to ".join(f"{100 * gaps[end]:+.1f} points (M = {counts[end]})" for end in ends)


def percent(part: float) -> str:
    """0.8512 as 85.1 %."""
    return f"{100 * part:.1f} %"
