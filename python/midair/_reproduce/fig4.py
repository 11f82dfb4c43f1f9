"""Fig. 4: mean deviation sigma of the points' pressures over the number of points."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from . import fig3, tables
from .scenes import PAPER
from .tables import Found, Run, Verdict, outcome

#: Largest mean sigma of a field that counts as even.
EVEN = 1e-4


def collect(run: Run) -> Found:
    """Return the sigma of the trials, eq. (13)."""
    return Found(fig3.study(run, "sigma"))


def draw(found: Found) -> Figure:
    """Draw sigma over the number of points, on a log axis, since the sigmas differ by orders of magnitude."""
    figure = fig3.over_points(found.rows, "deviation sigma, eq. (13) with 1/M")
    figure.axes[0].set_ylim(auto=True)
    figure.axes[0].set_yscale("log")
    return figure


def judge(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts on the paper's statements about the variation among points."""
    mean = tables.by_method(rows, "mean")
    counts = [row["M"] for row in tables.pick(rows, method="greedy")]
    others = [method.key for method in PAPER if method.key != "greedy"]
    least = np.min([mean[key] for key in others if key != "lm"] + [mean["greedy"]], axis=0)
    lowest = mean["lm"] < least
    where = [count for count, low in zip(counts, lowest, strict=True) if not low]
    squares, absolutes = (_louder(mean[key], mean, others) for key in ("greedy", "greedy-l1"))
    even = mean["gspat"] < mean["greedy"]
    verdicts = [
        Verdict(
            "LM has the least variation",
            outcome(bool(lowest.all()), bool(lowest.any())),
            f"LM {_range(mean['lm'])}"
            + (f"; not the least at M = {', '.join(map(str, where))}" if where else ""),
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
    ]
    if "uniform" in mean:
        worst = int(mean["uniform"].argmax())
        verdicts.append(
            Verdict(
                "(ours) `uniform` has sigma of at most 1e-4 at every M",
                outcome(bool((mean["uniform"] <= EVEN).all())),
                f"largest mean {mean['uniform'][worst]:.1e} at M = {counts[worst]}",
            )
        )
    return verdicts


def _louder(
    sigma: NDArray[np.float64], mean: dict[str, NDArray[np.float64]], others: list[str]
) -> NDArray[np.bool_]:
    """Return where at most one of the other methods varies more than `sigma`."""
    above: NDArray[np.bool_] = np.sum([mean[key] > sigma for key in others], axis=0) <= 1
    return above


def _range(values: NDArray[np.float64]) -> str:
    return f"{values.min():.4f} to {values.max():.4f}"
