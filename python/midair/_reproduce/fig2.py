"""Fig. 2: a smiley of 38 points with |p| = 1 each, over 36 x 36 transducers."""

import numpy as np
from matplotlib.figure import Figure

from . import scenes, tables
from .scenes import PANELS
from .tables import Found, Run, Verdict, outcome

SIZE = 0.1
METRICS = ("accuracy", "sigma", "uniformity", "residual")

#: A point counts as lost if its |p| is below this fraction of the mean over the points.
LOST = 0.5


def collect(run: Run) -> Found:
    """Return a row for each method and point, and the fields."""
    points, fields = scenes.smiley(), {}
    rows: tables.Rows = []
    for done, method in enumerate(PANELS):
        run.tell(done, len(PANELS))
        solution, fields[method.key] = scenes.solved(points, 1.0, method.solver, method.options, SIZE)
        metrics = {name: getattr(solution.metrics, name) for name in METRICS}
        for index, ((x, y, _), pressure) in enumerate(zip(points, np.abs(solution.pressures), strict=True)):
            row = {
                "method": method.key,
                "label": method.label,
                "point": index,
                "x_mm": x * 1e3,
                "y_mm": y * 1e3,
            }
            rows.append({**row, "pressure": float(pressure), **metrics})
    return Found(rows, fields)


def draw(found: Found) -> Figure:
    """Draw a panel for each method, all on the same colour scale."""
    height = -(-len(found.fields) // 3)
    figure = Figure(figsize=(9.6, 3.25 * height), layout="compressed")
    grid = figure.subplots(height, 3, squeeze=False, sharex=True, sharey=True)
    image = None
    for axes in grid.flat[len(found.fields) :]:
        axes.set_axis_off()
    for axes, (key, field) in zip(grid.flat, found.fields.items(), strict=False):
        # The target is 1. Values above 1.5 have the colour of the scale's top.
        image = scenes.picture(axes, field, SIZE, 1.5)
        first = tables.pick(found.rows, method=key)[0]
        title = f"{first['label']}\naccuracy {first['accuracy']:.2f}, sigma {first['sigma']:.3f}"
        axes.set_title(title, fontsize=9)
        axes.label_outer()
    if image is not None:
        figure.colorbar(image, ax=grid, fraction=0.03, pad=0.02, label="|p|², target 1", extend="max")
    return figure


def lost(rows: tables.Rows, method: str) -> int:
    """Return the number of points that a method loses."""
    pressure = tables.column(tables.pick(rows, method=method), "pressure")
    return int((pressure < LOST * pressure.mean()).sum())


def judge(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts on which methods lose points."""
    counts = {key: lost(rows, key) for key in tables.labels(rows)}
    reported = ", ".join(f"{key} {count}" for key, count in counts.items())
    return [
        Verdict(
            "SDP+BCD loses points of the pattern",
            outcome(counts["sdp"] > 0),
            f"points of 38 below half the mean |p|: {reported}",
        )
    ]
