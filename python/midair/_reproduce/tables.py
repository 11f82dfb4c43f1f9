"""Tables of the numbers behind the figures, as lists of rows and CSV files; the run that computes them."""

import csv
import math
from collections import defaultdict
from collections.abc import Callable, Hashable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._support import output
from .._support.cache import Arrays
from .._sweep.engine import Job, counted, run

Outcome = Literal["holds", "holds in part", "does not hold"]


class Verdict(NamedTuple):
    """A statement, its verdict, and the numbers on which the verdict is based."""

    statement: str
    verdict: Outcome
    evidence: str


def outcome(*parts: bool) -> Outcome:
    """Return the verdict on a statement with several parts."""
    if all(parts):
        return "holds"
    return "holds in part" if any(parts) else "does not hold"


def span(gaps: NDArray[np.float64], counts: list[int]) -> str:
    """Return the least and largest of differences in accuracy as text: percentage points, and M of each."""
    ends = (int(gaps.argmin()), int(gaps.argmax()))
    return " to ".join(f"{100 * gaps[end]:+.1f} points (M = {counts[end]})" for end in ends)


def percent(part: float) -> str:
    """Return a fraction as text: 0.8512 as "85.1 %"."""
    return f"{100 * part:.1f} %"


Row = dict[str, Any]
Rows = list[Row]

#: Half-width of a mean's 95 % interval, in standard errors.
NORMAL = 1.96


def spread(values: NDArray[np.float64]) -> Row:
    """Return mean, standard deviation (n - 1) and the mean's 95 % interval.

    A single value has deviation 0.
    """
    count, mean = len(values), float(np.mean(values))
    std = float(np.std(values, ddof=1)) if count > 1 else 0.0
    half = NORMAL * std / math.sqrt(count)
    return {"trials": count, "mean": mean, "std": std, "low": mean - half, "high": mean + half}


def write(path: Path, rows: Rows) -> None:
    """Write a CSV file with six significant digits."""
    rounded = (
        {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows
    )
    output.write(path, output.to_csv([*rounded]))


def read(path: Path) -> Rows:
    """Read the rows of a CSV file, with numbers as numbers."""
    with path.open(newline="", encoding="utf-8") as file:
        return [{key: _number(text) for key, text in row.items()} for row in csv.DictReader(file)]


def _number(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def pick(rows: Rows, **wanted: Any) -> Rows:
    """Return the rows in which each column named in `wanted` has the value given there."""
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def column(rows: Rows, name: str) -> NDArray[np.float64]:
    """Return a column as an array of numbers."""
    return np.array([row[name] for row in rows], float)


def by_method(rows: Rows, name: str) -> dict[str, NDArray[np.float64]]:
    """Return a column of the table for each method, by the method's key."""
    return {key: column(pick(rows, method=key), name) for key in labels(rows)}


def largest(of: dict[str, NDArray[np.float64]], keys: Sequence[str]) -> NDArray[np.float64]:
    """Return the largest value of some methods at each index."""
    top: NDArray[np.float64] = np.max([of[key] for key in keys], axis=0)
    return top


def labels(rows: Rows) -> Sequence[str]:
    """Return the methods' keys in the order of the rows."""
    return list(dict.fromkeys(row["method"] for row in rows))


Tell = Callable[[int, int], None]


def silent(done: int, items: int) -> None:
    """Do nothing."""


class Found(NamedTuple):
    """The numbers of a figure: a table, and the fields of its panels if it shows fields."""

    rows: Rows
    fields: Mapping[str, NDArray[np.float64]] = MappingProxyType({})


class Run(NamedTuple):
    """A run: trials, seed, the folder of its results, and where it is computed."""

    trials: int
    seed: int
    chunks: Path
    scheduler: str | None = None
    #: Called with (items done, items) for the current figure.
    tell: Tell = silent

    def gather(self, jobs: Sequence[Job], *, alone: bool = False) -> dict[Hashable, Arrays]:
        """Return the results of all jobs by their owner; those of one owner are joined.

        With `alone` the jobs run in one thread of this process, for timing.
        """
        parts: defaultdict[Hashable, list[Arrays]] = defaultdict(list)
        run(
            jobs,
            lambda job, arrays: parts[job.owner].append(arrays),
            chunks=self.chunks,
            scheduler=None if alone else self.scheduler,
            threads=1 if alone else None,
            tell=counted(self.tell, sum(job.stop - job.start for job in jobs)),
        )
        return {
            owner: {name: np.concatenate([part[name] for part in found]) for name in found[0]}
            for owner, found in parts.items()
        }
