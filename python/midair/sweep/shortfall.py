"""Problems of a sweep that ask for more than the array reaches, or for weak foci: counted, and told."""

from __future__ import annotations

import numpy as np

from .engine import Arrays


class Shortfall:
    """Counts over the results of a sweep."""

    def __init__(self) -> None:
        self.problems = self.beyond = self.weak = 0
        self.least = np.inf

    def add(self, arrays: Arrays) -> None:
        """Count the problems of one result."""
        beyond = arrays["beyond"]
        self.problems += len(beyond)
        self.beyond += int(beyond.sum())
        self.weak += int(arrays["weak"].sum())
        self.least = min(self.least, arrays["level"][beyond].min(initial=np.inf))

    def text(self) -> str:
        """What is to be told of them; nothing, if there are none."""
        parts = []
        if self.beyond:
            parts.append(
                f"{self.beyond:,} of {self.problems:,} problems ask for more pressure than the array reaches"
                f" at a point, and get as little as {self.least:.2g} of it (column level): ask for less, or"
                " leave the pressure out for the balanced level"
            )
        if self.weak:
            parts.append(
                f"{self.weak:,} of {self.problems:,} problems ask for less than half the balanced level: foci"
                " this weak come out smeared, balance = true cures it"
            )
        return "; ".join(parts)
