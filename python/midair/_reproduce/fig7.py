"""Fig. 7: a focus over 36 x 36 transducers: weak and strong, random and fixed order, and balanced."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .. import _midair
from .._support.cache import Arrays
from .._sweep.engine import Job, pieces
from . import scenes, tables
from .scenes import Options
from .tables import Found, Run, Verdict, outcome

SIZE = 0.04
POINT = [[0.0, 0.0, scenes.Z]]

#: Range in m, to each side, in which widths are measured; and its sampling step.
SPAN = 0.06
STEP = 1e-4

#: A region above half the maximum that is wider than this, in m, is no single focus; an ideal one has 6.7 mm.
NARROW = 0.015
#: Widths of an ideal focus in m: 1.2 lambda/(2 NA) within 5 %.
IDEAL = (6.3e-3, 7.1e-3)
#: Sound farther than this from the focus, in m, counts as an artefact: twice the ideal width, past the first
#: side lobe.
AWAY = 0.0134

CHUNK = 10

#: Each panel: its letter, |p| at the focus, order of the updates, and whether it is balanced.
PANELS = (
    ("a", 1.0, "random", False),
    ("b", 1.0, "columns", False),
    ("c", 10.0, "random", False),
    ("d", 10.0, "columns", False),
    ("e", 1.0, "random", True),
    ("f", 1.0, "columns", True),
)


def measure(settings: Mapping[str, Any], start: int, stop: int) -> Arrays:
    """Return the widths along x and y in m, artefacts and radiated power for seeds start to stop."""
    scene = scenes.scene(POINT, settings["target"])
    steps = np.arange(-round(SPAN / STEP), round(SPAN / STEP) + 1) * STEP
    zero = np.zeros_like(steps)
    lines = np.concatenate([np.column_stack([steps, zero]), np.column_stack([zero, steps])])
    # Samples a quarter of a wavelength apart cannot miss a lobe.
    grid = np.arange(-30, 31) * SPAN / 30
    plane = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    places = np.concatenate([lines, plane])
    places = np.column_stack([places, np.full(len(places), scenes.Z)])
    away = np.linalg.norm(plane, axis=1) > AWAY
    measured = []
    for index in range(start, stop):
        seed = {"seed": settings["seed"] + index}
        solution = _midair.solve(scene, "greedy", **settings["options"], **seed)
        size = np.abs(_midair.field(scene, solution.drive, places).pressure)
        along_x, along_y, rest = np.split(size, [len(steps), 2 * len(steps)])
        peak = abs(solution.pressures[0])
        power = float(np.mean(solution.amplitudes**2))
        measured.append([_width(along_x), _width(along_y), rest[away].max() / peak, power, peak])
    names = ("width_x", "width_y", "artefact", "power", "pressure")
    return dict(zip(names, np.array(measured, float).T, strict=True))


def _width(line: NDArray[np.float32]) -> float:
    """Return the distance between the outermost samples above half the maximum."""
    loud = np.flatnonzero(line > line.max() / 2)
    return float(loud[-1] - loud[0]) * STEP


def collect(run: Run) -> Found:
    """Return a row for each panel, and its field. Random orders: the row covers all, the field shows one."""
    jobs: list[Job] = []
    fields = {}
    for panel, target, order, balance in PANELS:
        options: Options = {"order": order, "balance": balance}
        settings = {"target": target, "options": options, "seed": run.seed}
        trials = run.trials if order == "random" else 1
        jobs += pieces(measure, settings, trials, CHUNK, panel)
        _, fields[panel] = scenes.solved(POINT, target, "greedy", {**options, "seed": run.seed}, SIZE)
    measured = run.gather(jobs)
    rows: tables.Rows = []
    for panel, target, order, balance in PANELS:
        mine = measured[panel]
        widths = np.maximum(mine["width_x"], mine["width_y"])
        rows.append(
            {
                "panel": panel,
                "target": target,
                "order": order,
                "balance": "on" if balance else "off",
                "orders": len(widths),
                "width_x_mm": 1e3 * float(np.median(mine["width_x"])),
                "width_y_mm": 1e3 * float(np.median(mine["width_y"])),
                "narrow": float(np.mean(widths < NARROW)),
                "ideal": float(np.mean((widths > IDEAL[0]) & (widths < IDEAL[1]))),
                **{name: float(np.median(mine[name])) for name in ("artefact", "power", "pressure")},
            }
        )
    return Found(rows, fields)


def draw(found: Found) -> Figure:
    """Draw the panels: weak, strong, balanced from top to bottom; random order left, fixed order right.

    Each panel has its own colour scale.
    """
    figure = Figure(figsize=(7.8, 9.6), layout="compressed")
    for axes, row in zip(figure.subplots(3, 2, sharex=True, sharey=True).flat, found.rows, strict=True):
        field = found.fields[row["panel"]]
        image = scenes.picture(axes, field, SIZE, float(field.max()))
        order = "random order" if row["order"] == "random" else "fixed order"
        how = ", balanced" if row["balance"] == "on" else ""
        axes.set_title(f"({row['panel']}) |p| = {row['target']:g}, {order}{how}", fontsize="medium")
        axes.label_outer()
        figure.colorbar(image, ax=axes, fraction=0.046, pad=0.02, label="|p|²")
    return figure


def judge(rows: tables.Rows) -> list[Verdict]:
    """Return the verdicts on the paper's statements about each panel, and on balancing of the weak focus."""
    a, b, c, d, e, f = rows
    return [
        Verdict(
            "(a) a weak focus in random order is narrow, with artefacts around it",
            outcome(a["narrow"] >= 0.5, a["artefact"] > 2 * c["artefact"]),
            f"narrower than 15 mm in {a['narrow']:.0%} of {a['orders']} orders; artefacts of"
            f" {a['artefact']:.2f} of the focus in the median, {c['artefact']:.2f} with |p| = 10",
        ),
        Verdict(
            "(b) a weak focus in fixed order is smeared along x",
            outcome(b["width_x_mm"] > 2 * b["width_y_mm"] and b["width_x_mm"] > 1e3 * NARROW),
            f"{b['width_x_mm']:.1f} mm in x, {b['width_y_mm']:.1f} mm in y",
        ),
        *(
            Verdict(
                f"({row['panel']}) a strong focus in {order} order is ideal",
                outcome(row["ideal"] == 1.0, row["ideal"] >= 0.5),
                f"{row['width_x_mm']:.1f} mm in x, {row['width_y_mm']:.1f} mm in y;"
                f" ideal in {row['ideal']:.0%} of {row['orders']}",
            )
            for row, order in ((c, "random"), (d, "fixed"))
        ),
        Verdict(
            "(section V) balancing makes the weak focus ideal in either order",
            outcome(e["ideal"] == 1.0, f["ideal"] == 1.0),
            f"random {e['width_x_mm']:.1f} x {e['width_y_mm']:.1f} mm, artefacts {e['artefact']:.2f};"
            f" fixed {f['width_x_mm']:.1f} x {f['width_y_mm']:.1f} mm, artefacts {f['artefact']:.2f};"
            f" power {e['power']:.3f} of full instead of {a['power']:.3f}",
        ),
    ]
