"""Fig. 6: time over the number of transducers, 64 points."""

from __future__ import annotations

from matplotlib.figure import Figure

from . import fig5, scenes, tables, timing
from .tables import Found, Run, Verdict


def collect(run: Run) -> Found:
    """Times of every method; the range of the points grows with the array."""
    places = [(side, scenes.FIXED_COUNT) for side in scenes.SIDES]
    return Found(timing.study(run, places, "N", 0))


def draw(found: Found) -> Figure:
    """Times over N."""
    return timing.draw(found.rows, "N", "transducers N, M = 64")


def judge(rows: tables.Rows) -> list[Verdict]:
    """Greedy is linear in N."""
    found = [key for key in ("greedy", "greedy-brute") if tables.pick(rows, method=key)]
    return [fig5.linear(rows, "N", key) for key in found]
