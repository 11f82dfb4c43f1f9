"""Times of figs. 5 and 6: CPU time of a whole `midair.solve`, over all threads; the methods take turns."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Scene
from .._support.kept import Arrays
from .._sweep.engine import Job
from . import drawing, scenes, tables
from .scenes import Options, timed
from .tables import Run

#: Largest number of rounds. On a quiet machine the median of this many varies by a few per cent.
ROUNDS = 15

#: Shortest measurement in s, a thousand times the clock's step; faster solves are repeated.
LEAST = 2e-3


def measure(settings: Mapping[str, Any], start: int, stop: int) -> Arrays:
    """Return CPU times (rounds, methods) in s. All methods solve the same scene in a round."""
    side, count = settings["side"], settings["count"]
    array = Array.grid(side, side, scenes.PITCH, source_pressure=1e-3)
    target, half = scenes.reach(side) / math.sqrt(count), side * scenes.PITCH / 2

    def scene(index: int) -> Scene:
        random = np.random.default_rng([settings["seed"], index, count])
        flat = half * (2 * random.random((count, 2)) - 1)
        return Scene(array, np.column_stack([flat, np.full(count, scenes.Z)]), target)

    return {"seconds": in_turns(settings["methods"], [scene(index) for index in range(start, stop + 1)])}


def in_turns(
    methods: Sequence[tuple[str, Options]], scenes: Sequence[Scene], least: float = LEAST
) -> NDArray[np.float64]:
    """Return CPU times (rounds, methods) in s: a round for each scene except the last one.

    Each measurement takes at least `least` s. The methods take turns, so that other programs affect all.
    """
    *rounds, last = scenes
    # A first run without measurement fills the caches, and shows how often each method must be repeated.
    repeats = [max(1, math.ceil(least / _seconds(last, method, 1))) for method in methods]
    seconds = np.empty((len(rounds), len(methods)))
    for index, scene in enumerate(rounds):
        for turn in range(len(methods)):
            which = (turn + index) % len(methods)
            seconds[index, which] = _seconds(scene, methods[which], repeats[which])
    return seconds


def _seconds(scene: Scene, method: tuple[str, Options], repeats: int) -> float:
    solver, options = method
    began = time.process_time_ns()
    for _ in range(repeats):
        _midair.solve(scene, solver, **options)
    return (time.process_time_ns() - began) / 1e9 / repeats


def study(run: Run, places: Sequence[tuple[int, int]], x: str, least: int) -> tables.Rows:
    """Return median and quartiles for each method at each (side, count), and slopes over x = "M" or "N".

    The slopes are fitted twice: over all sizes, and over sizes x >= `least`.
    """
    methods = timed()
    rounds = min(run.trials, ROUNDS)
    common = {"seed": run.seed, "methods": [[method.solver, method.options] for method in methods]}
    jobs = [
        Job(measure, {**common, "side": side, "count": count}, 0, rounds, (side, count))
        for side, count in places
    ]
    found = run.gather(jobs, alone=True)
    rows: tables.Rows = []
    for number, method in enumerate(methods):
        quartiles = np.array(
            [np.quantile(found[place]["seconds"][:, number], [0.25, 0.5, 0.75]) for place in places]
        )
        size = np.array([side * side if x == "N" else count for side, count in places], float)
        large = size >= least
        slopes = [slope(size[keep], quartiles[keep, 1]) for keep in (size > 0, large)]
        for (side, count), (low, median, high) in zip(places, quartiles.tolist(), strict=True):
            rows.append(
                {
                    "method": method.key,
                    "label": method.label,
                    "N": side * side,
                    "M": count,
                    "rounds": rounds,
                    "median": median,
                    "low": low,
                    "high": high,
                    "from": least,
                    "slope": slopes[0][0],
                    "slope_error": slopes[0][1],
                    "slope_large": slopes[1][0],
                    "slope_large_error": slopes[1][1],
                }
            )
    return rows


def slope(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Return the slope of log y over log x by least squares, and its standard error."""
    across, up = np.log(x) - np.log(x).mean(), np.log(y) - np.log(y).mean()
    found = float(across @ up / (across @ across))
    left = up - found * across
    return found, float(math.sqrt(left @ left / (len(x) - 2) / (across @ across)))


def draw(rows: tables.Rows, x: str, label: str) -> Figure:
    """Draw time over size on log axes; bars extend from the lower to the upper quartile."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots()
    drawing.lines(axes, rows, timed(), x, "median")
    axes.set_yscale("log")
    axes.set(xlabel=label, ylabel="CPU time of a solve / s")
    axes.set_title(f"median of {rows[0]['rounds']} rounds, all threads; bars: quartiles", fontsize="medium")
    figure.legend(loc="outside right upper", fontsize="small")
    return figure


def stated_slope(row: tables.Row) -> str:
    """Return a method's slopes as text."""
    reported = f"{row['slope']:.2f} ± {row['slope_error']:.2f}"
    if row["from"] == 0:
        return reported
    return f"{reported}; {row['slope_large']:.2f} ± {row['slope_large_error']:.2f} from {row['from']} on"
