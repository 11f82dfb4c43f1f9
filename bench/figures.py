"""Draws quality over time, `make figures`: docs/quality-time.png, with its numbers in quality-time.csv.

Quality is the mean over the paper's random scenes. Time is the CPU time of a whole `midair.solve` in one
thread: the median of rounds in which the methods take turns, for the first of those scenes.
"""

import io
import math
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median

import labels
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

import midair
from midair._reproduce import drawing, methods, scenes, tables
from midair._support import output as output
from midair._sweep.block import solve_block

FOLDER = Path(__file__).parents[1] / "docs"
SIDE = 20
COUNTS = (4, 16, 64)
SCENES = 20
ROUNDS = 15
#: The least duration of a measurement in s; shorter solves are repeated.
LEAST = 5e-3

LABELS = {"accuracy": "accuracy (higher is louder)", "sigma": "sigma (lower is more even)"}

#: Options other than the defaults.
OPTIONS = {"uniform": {"aim": "max"}, "best": {"aim": "max"}}
FINE = methods.Method(
    "greedy 256 x 16", "greedy 256 x 16", "greedy", {"phases": 256, "amplitudes": 16}, "#7f0000"
)
#: The colours of the methods, as in the paper's figures.
COLOURS = {method.solver: method.colour for method in (*methods.PAPER, methods.GS, *methods.even())} | {
    "fast": "#e377c2",
    "wgs": "#008b8b",
    "tikhonov": "#808000",
    "naive": "#b8860b",
    "glide": "#00a000",
    "descent": "#0050ff",
    "bounded": "#9400d3",
}


def compared() -> list[methods.Method]:
    """Returns every registered method with its defaults, and greedy on the paper's finest grid."""
    found = [
        methods.Method(name, name, name, OPTIONS.get(name, {}), COLOURS.get(name, "#1a55ff"))
        for name in midair.solvers()
    ]
    return [*found, FINE]


def settings(method: methods.Method, count: int) -> dict[str, object]:
    """Returns the paper's random scenes for a method, in the form that sweeps take."""
    return {
        **scenes.random_points(SIDE, count),
        "solver": method.solver,
        "options": method.options,
        "seed": 0,
        "seeds": None,
        "drives": True,
    }


def measure(work: Sequence[methods.Method], count: int) -> tables.Rows:
    """Returns a row per method: mean accuracy and sigma over all scenes, median time in s for the first."""
    answers = [solve_block(settings(method, count), 0, SCENES) for method in work]
    array = midair.Array.grid(SIDE, SIDE, scenes.PITCH, source_pressure=1e-3)
    scene = midair.Scene(array, answers[0]["points"][0], answers[0]["targets"][0])
    repeats = [max(1, math.ceil(LEAST / seconds(scene, method, 1))) for method in work]
    times: list[list[float]] = [[] for _ in work]
    for turn in range(ROUNDS):
        for number in np.roll(range(len(work)), turn).tolist():
            times[number].append(seconds(scene, work[number], repeats[number]))
    return [
        {
            "method": method.key,
            "N": SIDE * SIDE,
            "M": count,
            "scenes": SCENES,
            "accuracy": float(np.mean(answer["accuracy"])),
            "sigma": float(np.mean(answer["sigma"])),
            "rounds": ROUNDS,
            "seconds": median(taken),
        }
        for method, answer, taken in zip(work, answers, times, strict=True)
    ]


def seconds(scene: midair.Scene, method: methods.Method, repeats: int) -> float:
    """Returns the CPU time of a solve in s, summed over all threads."""
    began = time.process_time_ns()
    for _ in range(repeats):
        midair.solve(scene, method.solver, **method.options)
    return (time.process_time_ns() - began) / 1e9 / repeats


def draw(rows: tables.Rows) -> Figure:
    """Draws accuracy above sigma, over time, with a column for each number of points."""
    colours = {method.key: method.colour for method in compared()}
    figure = Figure(figsize=(11, 7.4), dpi=drawing.RESOLUTION, layout="constrained")
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
        labels.write(*panel)
    return figure


def main() -> None:
    """Measures, writes the table and draws the picture."""
    rows = [row for count in COUNTS for row in measure(compared(), count)]
    tables.write(FOLDER / "quality-time.csv", rows)
    picture = io.BytesIO()
    draw(rows).savefig(picture, format="png", metadata={"Software": None})
    output.write(FOLDER / "quality-time.png", picture.getvalue())


if __name__ == "__main__":
    main()
