"""Figs. 3 and 4: mean accuracy and deviation sigma over the number of points, in random scenes."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .._sweep.block import solve_block
from .._sweep.engine import Job
from . import scenes, tables
from .scenes import CURVES, PAPER
from .tables import Found, Run, Verdict, outcome, percent, span

#: Trials that are stored together; the slowest method takes one or two seconds for them.
CHUNK = 25

#: Largest mean sigma of a field that counts as even.
EVEN = 1e-4


def collect(run: Run, metric: str) -> Found:
    """Return mean, standard deviation and interval of a metric for each method and number of points."""
    cells = [(method, count) for method in CURVES for count in scenes.COUNTS]
    blocks = {(method.key, count): scenes.block(method, count, run.seed) for method, count in cells}
    # Each chunk is run for all methods before the next one, so that the remaining time can be estimated
    # early.
    jobs = [
        Job(solve_block, settings, start, min(start + CHUNK, run.trials), owner)
        for start in range(0, run.trials, CHUNK)
        for owner, settings in blocks.items()
    ]
    found = run.gather(jobs)
    rows = []
    for method, count in cells:
        spread = tables.spread(found[method.key, count][metric])
        rows.append({"method": method.key, "label": method.label, "M": count, **spread})
    return Found(rows)


def draw(found: Found, label: str, scale: str = "linear") -> Figure:
    """Draw curves over the number of points, with their 95 % intervals."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots()
    scenes.lines(axes, found.rows, CURVES, "M", "mean")
    axes.set(xlabel="control points M", ylabel=label, yscale=scale)
    if scale == "linear":
        axes.set_ylim(0, None)
    title = f"20 x 20 transducers, {found.rows[0]['trials']} trials; bars: 95 % of the mean"
    axes.set_title(title, fontsize="medium")
    figure.legend(loc="outside right upper", fontsize="small")
    return figure


def judge_accuracy(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts on the paper's statements about accuracy, eq. (12)."""
    mean = tables.by_method(rows, "mean")
    counts = [row["M"] for row in tables.pick(rows, method="greedy")]
    greedy, lm, gspat = mean["greedy"], mean["lm"], mean["gspat"]

    least = min(tables.pick(rows, method="greedy"), key=lambda row: row["mean"])
    lead, second = lm - greedy, greedy - tables.largest(mean, ("gspat", "evd", "sdp"))
    low, gap = greedy - tables.largest(mean, ("evd", "sdp")), lm - gspat
    fine, gain = abs(mean["greedy-fine"] - greedy), mean["uniform"] - greedy
    return [
        Verdict(
            "greedy's accuracy is above 80 % at every M",
            outcome(least["mean"] > 0.8),
            f"lowest mean {percent(least['mean'])} at M = {least['M']}"
            f" (95 %: {percent(least['low'])} to {percent(least['high'])})",
        ),
        Verdict(
            "LM is the most accurate, greedy comes next",
            outcome(bool((lead > 0).all()), bool((second > 0).all())),
            f"LM over greedy {span(lead, counts)}; greedy over the best of the others {span(second, counts)}",
        ),
        Verdict(
            "EVD and SDP+BCD are less accurate than greedy",
            outcome(bool((low > 0).all())),
            f"greedy over the better of the two {span(low, counts)}",
        ),
        Verdict(
            "GS-PAT is slightly less accurate than LM",
            outcome(bool((gap > 0).all()), bool((gap < 0.05).all())),
            f"LM over GS-PAT {span(gap, counts)}; slightly is taken as below 5 points",
        ),
        Verdict(
            "K=16, L=256 gains less than a point over K=1, L=16",
            outcome(bool((fine < 0.01).all())),
            f"difference at most {100 * fine.max():.2f} points, at M = {counts[int(fine.argmax())]}",
        ),
        Verdict(
            "(ours) `uniform` is more accurate than greedy at every M",
            outcome(bool((gain > 0).all())),
            f"uniform over greedy {span(gain, counts)}",
        ),
    ]


def judge_deviation(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts on the paper's statements about the variation among points, eq. (13)."""
    mean = tables.by_method(rows, "mean")
    counts = [row["M"] for row in tables.pick(rows, method="greedy")]
    others = [method.key for method in PAPER if method.key != "greedy"]
    least = np.min([mean[key] for key in others if key != "lm"] + [mean["greedy"]], axis=0)
    lowest = mean["lm"] < least
    where = [count for count, low in zip(counts, lowest, strict=True) if not low]
    # Where at most one of the other methods varies more.
    squares, absolutes = (
        np.sum([mean[other] > mean[key] for other in others], axis=0) <= 1 for key in ("greedy", "greedy-l1")
    )
    even, worst = mean["gspat"] < mean["greedy"], int(mean["uniform"].argmax())
    return [
        Verdict(
            "LM has the least variation",
            outcome(bool(lowest.all()), bool(lowest.any())),
            f"LM {_range(mean['lm'])}" + (f"; not the least at M = {', '.join(map(str, where))}" if where else ""),
        ),
        Verdict(
            "greedy's variation is relatively large at every M",
            outcome(bool(squares.all()), bool(absolutes.all())),
            f"among the two largest of five at {squares.sum()} of {len(counts)} M with squared errors, as"
            f" printed ({_range(mean['greedy'])}), and at {absolutes.sum()} with absolute errors, as in the"
            f" authors' code ({_range(mean['greedy-l1'])})",
        ),
        Verdict(
            "GS-PAT's variation is little",
            outcome(bool(even.all()), bool(even.any())),
            f"GS-PAT {_range(mean['gspat'])}; below greedy at {even.sum()} of {len(counts)} M",
        ),
        Verdict(
            "(ours) `uniform` has sigma of at most 1e-4 at every M",
            outcome(bool((mean["uniform"] <= EVEN).all())),
            f"largest mean {mean['uniform'][worst]:.1e} at M = {counts[worst]}",
        ),
    ]


def _range(values: NDArray[np.float64]) -> str:
    return f"{values.min():.4f} to {values.max():.4f}"
