"""Figs. 5 and 6: computation time over the number of points and over the number of transducers."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from . import scenes, tables, timing
from .scenes import PAPER
from .tables import Found, Run, Verdict, outcome

#: Of the two slopes of time over M, the second uses M from LARGE on. For a smaller M, the constant work per
#: transducer dominates.
LARGE = 64

#: "Computation is linear" holds if the slope of log time over log M differs from 1 by at most this.
LINEAR = 0.1


def collect(run: Run) -> Found:
    """Return the times of every method."""
    return Found(timing.study(run, [(scenes.SIDE, count) for count in scenes.MANY], "M", LARGE))


def draw(found: Found) -> Figure:
    """Draw the times over the number of points."""
    return timing.draw(found.rows, "M", "control points M, N = 400")


def judge(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts: is greedy's time linear in the number of points, and which methods are faster?"""
    median = tables.by_method(rows, "median")
    counts = [row["M"] for row in tables.pick(rows, method="greedy")]
    slow = [method.key for method in PAPER if method.key not in ("greedy", "gspat")]
    fast = np.maximum(median["greedy"], median["gspat"])
    ratio = {key: median[key] / fast for key in slow}
    share = median["greedy"] / median["gspat"]
    faster = ", ".join(str(count) for count, part in zip(counts, share, strict=True) if part < 1)
    verdicts = [
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
    ]
    if "greedy-brute" in median:
        verdicts.append(linear(rows, "M", "greedy-brute"))
    return verdicts


def linear(rows: tables.Rows, x: str, method: str) -> Verdict:
    """Return the verdict on whether a method's time is linear in x."""
    row = tables.pick(rows, method=method)[0]
    return Verdict(
        f"{'greedy' if method == 'greedy' else 'greedy by plain brute force'} is linear in {x}",
        outcome(abs(row["slope_large"] - 1) <= LINEAR),
        f"log-log slope {timing.stated_slope(row)}",
    )


class Transducers:
    """Fig. 6: time over the number of transducers, with 64 points."""

    def collect(self, run: Run, /) -> Found:
        """Return the times of every method. The region of the points grows with the array."""
        places = [(side, scenes.FIXED_COUNT) for side in scenes.SIDES]
        return Found(timing.study(run, places, "N", 0))

    def draw(self, found: Found, /) -> Figure:
        """Draw the times over the number of transducers."""
        return timing.draw(found.rows, "N", "transducers N, M = 64")

    def judge(self, rows: tables.Rows, /) -> list[Verdict]:
        """Return the verdicts: is greedy's time linear in the number of transducers?"""
        found = [key for key in ("greedy", "greedy-brute") if tables.pick(rows, method=key)]
        return [linear(rows, "N", key) for key in found]
