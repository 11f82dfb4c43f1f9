"""One run of a figure: its request, and its jobs through the sweeps' engine."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._support.kept import Arrays
from .._sweep.engine import Job, run
from .tables import Rows

Tell = Callable[[int, int], None]


def silent(done: int, items: int) -> None:
    """Do nothing."""


class Found(NamedTuple):
    """The numbers behind a figure: a table, and the fields of a picture where there are any."""

    rows: Rows
    fields: Mapping[str, NDArray[np.float64]] = MappingProxyType({})


@dataclass(frozen=True)
class Run:
    """Request: trials, seed, place of the work and of its results."""

    trials: int
    seed: int
    chunks: Path
    scheduler: str | None = None
    #: Called with (items done, items) of the figure in work.
    tell: Tell = silent

    def gather(self, jobs: Sequence[Job], *, alone: bool = False) -> dict[Hashable, Arrays]:
        """Each owner's results, the chunks joined. What is timed runs alone, in one thread of this one."""
        parts: defaultdict[Hashable, list[Arrays]] = defaultdict(list)
        items, done = sum(job.stop - job.start for job in jobs), 0

        def tell(more: int) -> None:
            nonlocal done
            done += more
            self.tell(done, items)

        run(
            jobs,
            lambda job, arrays: parts[job.owner].append(arrays),
            chunks=self.chunks,
            scheduler=None if alone else self.scheduler,
            threads=1 if alone else None,
            tell=tell,
        )
        return {
            owner: {name: np.concatenate([part[name] for part in found]) for name in found[0]}
            for owner, found in parts.items()
        }
