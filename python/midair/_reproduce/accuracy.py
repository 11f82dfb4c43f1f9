"""The trials behind figs. 3 and 4: accuracy and sigma at random points, the same for every method."""

from __future__ import annotations

from matplotlib.figure import Figure

from .._sweep.block import solve_block
from .._sweep.engine import Job
from . import drawing, scenes, tables
from .run import Run
from .scenes import curves

#: Trials that are kept together: a second or two of the slowest method.
CHUNK = 25

SIDE = 20


def study(run: Run, metric: str) -> tables.Rows:
    """Mean, standard deviation and interval of a metric, for each method and number of points."""
    blocks = {
        (method.key, count): {
            **scenes.random_points(SIDE, count),
            "solver": method.solver,
            "options": method.options,
            "seed": run.seed,
            "seeds": None,
            "drives": False,
        }
        for method in curves()
        for count in scenes.COUNTS
    }
    # Chunk by chunk over all methods, so that the time left is known early.
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


def draw(rows: tables.Rows, label: str) -> Figure:
    """Curves over M with their 95 % intervals."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots()
    drawing.lines(axes, rows, curves(), "M", "mean")
    axes.set(xlabel="control points M", ylabel=label, ylim=(0, None))
    axes.set_title(
        f"20 x 20 transducers, {rows[0]['trials']} trials; bars: 95 % of the mean", fontsize="medium"
    )
    figure.legend(loc="outside right upper", fontsize="small")
    return figure
