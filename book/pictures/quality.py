"""docs/how-to-choose.md: quality over time of all methods, with its numbers in quality-time.csv (2 min).

Quality is the mean over the paper's random scenes. Time is the CPU time of a whole `midair.solve` in one
thread: the median of rounds in which the methods take turns, for the first of those scenes.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

import midair
from midair._reproduce import fig5, scenes, tables
from midair._reproduce.scenes import Method
from midair._sweep.block import solve_block
from pictures import DOCS, write_names

COUNTS = (4, 16, 64)
SCENES = 20
ROUNDS = 15
#: The least duration of a measurement in s; shorter solves are repeated.
LEAST = 5e-3

LABELS = {"accuracy": "accuracy (higher is louder)", "sigma": "sigma (lower is more even)"}

#: Options other than the defaults.
OPTIONS = {"uniform": {"aim": "max"}, "best": {"aim": "max"}}
FINE = Method("greedy 256 x 16", "greedy 256 x 16", "greedy", {"phases": 256, "amplitudes": 16}, "#7f0000")
#: The colours of the methods, as in the paper's figures.
COLOURS = {method.solver: method.colour for method in (*scenes.PAPER, scenes.GS, *scenes.EVEN)} | {
    "fast": "#e377c2",
    "wgs": "#008b8b",
    "tikhonov": "#808000",
    "naive": "#b8860b",
    "glide": "#00a000",
    "descent": "#0050ff",
    "bounded": "#9400d3",
}


def compared() -> list[Method]:
    """Returns every registered method with its defaults, and greedy on the paper's finest grid."""
    found = [Method(name, name, name, OPTIONS.get(name, {}), COLOURS.get(name, "#1a55ff")) for name in midair.solvers()]
    return [*found, FINE]


def measure(work: Sequence[Method], count: int) -> tables.Rows:
    """Returns a row per method: mean accuracy and sigma over all scenes, median time in s for the first."""
    answers = [solve_block(scenes.block(method, count, 0, drives=True), 0, SCENES) for method in work]
    array = midair.Array.grid(scenes.SIDE, scenes.SIDE, scenes.PITCH, source_pressure=1e-3)
    scene = midair.Scene(array, answers[0]["points"][0], answers[0]["targets"][0])
    calls = [(method.solver, method.options) for method in work]
    times = np.median(fig5.in_turns(calls, [scene] * (ROUNDS + 1), LEAST), axis=0)
    return [
        {
            "method": method.key,
            "N": len(array),
            "M": count,
            "scenes": SCENES,
            "accuracy": float(np.mean(answer["accuracy"])),
            "sigma": float(np.mean(answer["sigma"])),
            "rounds": ROUNDS,
            "seconds": float(seconds),
        }
        for method, answer, seconds in zip(work, answers, times, strict=True)
    ]


def draw(rows: tables.Rows) -> Figure:
    """Draws accuracy above sigma, over time, with a column for each number of points."""
    colours = {method.key: method.colour for method in compared()}
    figure = Figure(figsize=(11, 7.4), dpi=scenes.RESOLUTION, layout="constrained")
    panels = figure.subplots(2, len(COUNTS), sharex=True, sharey="row")
    panels[1, 0].set(xscale="log", yscale="log")
    panels[1, 0].xaxis.set_major_formatter(EngFormatter("s"))
    for axes, label in zip(panels[:, 0], LABELS.values(), strict=True):
        axes.set_ylabel(label)
    named = []
    for column, count in zip(panels.T, COUNTS, strict=True):
        mine = tables.pick(rows, M=count)
        keys = [row["method"] for row in mine]
        shades = [colours[key] for key in keys]
        column[0].set_title(f"M = {count} points", fontsize="medium")
        column[1].set_xlabel("CPU time of a solve")
        for axes, quantity in zip(column, LABELS, strict=True):
            points = np.column_stack([tables.column(mine, "seconds"), tables.column(mine, quantity)])
            axes.scatter(*points.T, s=36, c=shades, edgecolors="white", linewidths=0.6, zorder=2)
            axes.margins(0.1, 0.06)
            axes.grid(alpha=0.3)
            named.append((axes, keys, points, shades))
    # Names are placed in pixels, which are known only after the figure is laid out.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for panel in named:
        write_names(*panel)
    return figure


def main() -> None:
    """Measures, writes the table and draws the picture."""
    rows = [row for count in COUNTS for row in measure(compared(), count)]
    tables.write(DOCS / "quality-time.csv", rows)
    draw(rows).savefig(DOCS / "quality-time.png", metadata={"Software": None})
