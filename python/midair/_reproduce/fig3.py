"""Fig. 3: mean accuracy over the number of points, in random scenes that fig. 4 also uses."""

from __future__ import annotations

from matplotlib.figure import Figure

from .._sweep.block import solve_block
from .._sweep.engine import Job
from . import drawing, scenes, tables
from .scenes import curves
from .tables import Found, Run, Verdict, outcome, percent, span

#: Trials that are stored together; the slowest method takes one or two seconds for them.
CHUNK = 25


def collect(run: Run) -> Found:
    """Return the accuracy of the trials, eq. (12)."""
    return Found(study(run, "accuracy"))


def draw(found: Found) -> Figure:
    """Draw the accuracy over the number of points."""
    return over_points(found.rows, "accuracy, eq. (12)")


def judge(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts on the paper's statements about accuracy."""
    mean = tables.by_method(rows, "mean")
    counts = [row["M"] for row in tables.pick(rows, method="greedy")]
    greedy, lm, gspat = mean["greedy"], mean["lm"], mean["gspat"]

    least = min(tables.pick(rows, method="greedy"), key=lambda row: row["mean"])
    lead, second = lm - greedy, greedy - tables.largest(mean, ("gspat", "evd", "sdp"))
    low, gap = greedy - tables.largest(mean, ("evd", "sdp")), lm - gspat
    fine = abs(mean["greedy-fine"] - greedy)
    verdicts = [
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
    ]
    if "uniform" in mean:
        gain = mean["uniform"] - greedy
        verdicts.append(
            Verdict(
                "(ours) `uniform` is more accurate than greedy at every M",
                outcome(bool((gain > 0).all())),
                f"uniform over greedy {span(gain, counts)}",
            )
        )
    return verdicts


def study(run: Run, metric: str) -> tables.Rows:
    """Return mean, standard deviation and interval of a metric for each method and number of points."""
    blocks = {
        (method.key, count): scenes.block(method, count, run.seed)
        for method in curves()
        for count in scenes.COUNTS
    }
    # Each chunk is run for all methods before the next one, so that the remaining time can be estimated
    # early.
    jobs = [
        Job(solve_block, settings, start, min(start + CHUNK, run.trials), key)
        for start in range(0, run.trials, CHUNK)
        for key, settings in blocks.items()
    ]
    found = run.gather(jobs)
    return [
        {
            "method": method.key,
            "label": method.label,
            "M": count,
            **tables.spread(found[method.key, count][metric]),
        }
        for method in curves()
        for count in scenes.COUNTS
    ]


def over_points(rows: tables.Rows, label: str) -> Figure:
    """Draw curves over the number of points, with their 95 % intervals."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots()
    drawing.lines(axes, rows, curves(), "M", "mean")
    axes.set(xlabel="control points M", ylabel=label, ylim=(0, None))
    axes.set_title(
        f"20 x 20 transducers, {rows[0]['trials']} trials; bars: 95 % of the mean", fontsize="medium"
    )
    figure.legend(loc="outside right upper", fontsize="small")
    return figure
