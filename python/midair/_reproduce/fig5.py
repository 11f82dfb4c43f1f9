"""Figs. 5 and 6: CPU time of a whole `midair.solve` over the numbers of points and of transducers.

Times of all threads are added. The methods take turns.
"""

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Scene
from .._support.cache import Arrays
from .._sweep.engine import Job
from . import scenes, tables
from .scenes import PAPER, TIMED, Options
from .tables import Found, Run, Verdict, outcome

#: Largest number of rounds. On a quiet machine the median of this many varies by a few per cent.
ROUNDS = 15

#: Shortest measurement in s, a thousand times the clock's step; faster solves are repeated.
LEAST = 2e-3

#: Of the two slopes of time over M, the second uses M from LARGE on. For a smaller M, the constant work per
#: transducer dominates.
LARGE = 64

#: "Computation is linear" holds if the slope of log time over log M differs from 1 by at most this.
LINEAR = 0.1

#: Labels of the horizontal axis.
LABELS = {"M": "control points M, N = 400", "N": "transducers N, M = 64"}


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


def collect(run: Run, over: str) -> Found:
    """Return median and quartiles for each method and size, and slopes over M or N.

    The points of fig. 6 are in a region that grows with the array. The slopes are fitted twice: over all
    sizes, and over sizes of `from` or more.
    """
    places, least = [(scenes.SIDE, count) for count in scenes.MANY], LARGE
    if over == "N":
        places, least = [(side, scenes.FIXED_COUNT) for side in scenes.SIDES], 0
    rounds = min(run.trials, ROUNDS)
    common = {"seed": run.seed, "methods": [[method.solver, method.options] for method in TIMED]}
    jobs = [Job(measure, {**common, "side": side, "count": count}, 0, rounds, (side, count)) for side, count in places]
    found = run.gather(jobs, alone=True)
    size = np.array([side * side if over == "N" else count for side, count in places], float)
    rows: tables.Rows = []
    for number, method in enumerate(TIMED):
        times = [found[place]["seconds"][:, number] for place in places]
        quartiles = np.array([np.quantile(each, [0.25, 0.5, 0.75]) for each in times])
        slopes = [slope(size[keep], quartiles[keep, 1]) for keep in (size > 0, size >= least)]
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
    return Found(rows)


def slope(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Return the slope of log y over log x by least squares, and its standard error."""
    (found, _), covariance = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    return float(found), float(np.sqrt(covariance[0, 0]))


def draw(found: Found, over: str) -> Figure:
    """Draw time over size on log axes; bars extend from the lower to the upper quartile."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots()
    scenes.lines(axes, found.rows, TIMED, over, "median")
    axes.set_yscale("log")
    axes.set(xlabel=LABELS[over], ylabel="CPU time of a solve / s")
    title = f"median of {found.rows[0]['rounds']} rounds, all threads; bars: quartiles"
    axes.set_title(title, fontsize="medium")
    figure.legend(loc="outside right upper", fontsize="small")
    return figure


def judge_points(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts: is greedy's time linear in the number of points, and which methods are faster?"""
    median = tables.by_method(rows, "median")
    counts = [row["M"] for row in tables.pick(rows, method="greedy")]
    slow = [method.key for method in PAPER if method.key not in ("greedy", "gspat")]
    fast = np.maximum(median["greedy"], median["gspat"])
    ratio = {key: median[key] / fast for key in slow}
    share = median["greedy"] / median["gspat"]
    faster = ", ".join(str(count) for count, part in zip(counts, share, strict=True) if part < 1)
    return [
        linear(rows, "M", "greedy"),
        Verdict(
            "greedy and GS-PAT are more than ten times as fast as the others",
            outcome(*(bool((ratio[key] > 10).all()) for key in slow)),
            "time over that of the slower of greedy and GS-PAT: "
            + ", ".join(f"{key} {ratio[key].min():.1f} to {ratio[key].max():.1f}" for key in slow),
        ),
        Verdict(
            "GS-PAT is faster at small M, greedy at large M",
            outcome(bool(share[0] > 1), bool(share[-1] < 1)),
            f"greedy over GS-PAT in time: {share[0]:.2f} at M = {counts[0]},"
            f" {share[-1]:.2f} at M = {counts[-1]}; greedy is faster at M = {faster or 'none'}",
        ),
        linear(rows, "M", "greedy-brute"),
    ]


def linear(rows: tables.Rows, x: str, method: str) -> Verdict:
    """Return the verdict on whether a method's time is linear in x."""
    row = tables.pick(rows, method=method)[0]
    slopes = f"{row['slope']:.2f} ± {row['slope_error']:.2f}"
    if row["from"]:
        slopes += f"; {row['slope_large']:.2f} ± {row['slope_large_error']:.2f} from {row['from']} on"
    name, verdict = "greedy", outcome(abs(row["slope_large"] - 1) <= LINEAR)
    name = name if method == name else "greedy by plain brute force"
    return Verdict(f"{name} is linear in {x}", verdict, f"log-log slope {slopes}")


def judge_transducers(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts: is greedy's time linear in the number of transducers?"""
    return [linear(rows, "N", key) for key in ("greedy", "greedy-brute")]
