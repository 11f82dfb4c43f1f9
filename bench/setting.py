"""The setting of the GS-PAT paper: 32 points, solved again and again, on all cores.

D. M. Plasencia et al., "GS-PAT", ACM Trans. Graphics 39(4), 138, 2020, report 17,000 solutions per second on
a GTX 1660. We do not know the size of their array, and use the pair of OpenMPD boards, 512 transducers.
"""

import os
import time
from collections.abc import Callable
from statistics import median

import numpy as np

import midair

METHODS = ("fast", "uniform")
COUNT = 32
PROBLEMS = 3000
HALF = 0.05  # m, half the side of the cube of points


def timed(array: midair.Array, method: str) -> Callable[[], float]:
    """Returns a function that measures the wall time per solution in ns."""
    middle = np.mean(array.positions, axis=0)
    points = middle + np.random.default_rng(COUNT).uniform(-HALF, HALF, (PROBLEMS, COUNT, 3))

    def measure() -> float:
        begin = time.perf_counter_ns()
        midair.solve_batch(array, points, solver=method)
        return (time.perf_counter_ns() - begin) / PROBLEMS

    return measure


def rows(common: dict[str, str], rounds: int) -> list[dict[str, str]]:
    """Returns a row per method, measured in turns; `common` has the columns that all rows share."""
    array = midair.Array.preset("openmpd_pair")
    measures = {method: timed(array, method) for method in METHODS}
    times = [[measure() for measure in measures.values()] for _ in range(rounds + 1)][1:]
    cores = len(os.sched_getaffinity(0))
    return [
        common
        | {
            "rival": "midair",
            "version": midair.__version__,
            "method": method,
            "form": f"batch, {cores} cores",
        }
        | {"grid": "board", "N": str(len(array)), "M": str(COUNT), "rounds": str(rounds)}
        | {"ns_median": f"{median(own):.0f}", "ns_min": f"{min(own):.0f}"}
        for method, own in zip(METHODS, zip(*times, strict=True), strict=True)
    ]
