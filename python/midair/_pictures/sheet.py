"""Contact sheet: the fields of several solutions of one scene, side by side in the same colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .._midair import Field, SceneError
from .colours import Quantity, colours, loud
from .panel import add_bar, draw, grid
from .words import asked, level, marks, number, place, scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Width in inches, or width and height.
Size = float | tuple[float, float]

#: How far above the largest target a scale goes where a panel is that loud; an arrow tells of more.
HEADROOM = 1.5


def resize(figure: Figure, size: Size | None) -> None:
    """Makes a figure `size` inches wide, or wide and high; None leaves it. Raises SceneError for another."""
    if size is None:
        return
    sides = (
        (size, size * figure.get_figheight() / figure.get_figwidth())
        if isinstance(size, int | float)
        else size
    )
    if len(sides) != 2 or not all(np.isfinite(side) and side > 0 for side in sides):
        raise SceneError(f"size is {size!r}: give a width in inches, or (width, height)")
    figure.set_size_inches(*sides)


def contact_sheet(fields: Sequence[Field], names: Sequence[str], quantity: Quantity = "pressure") -> Figure:
    """The field of each solution: a panel, or a row of panels where the points lie in several planes."""
    from matplotlib.figure import Figure

    rows = [field.panels for field in fields]
    width = len(rows[0])
    columns = width if width > 1 else min(len(fields), 3)
    height = -(-len(fields) * width // columns)
    figure = Figure(figsize=(3.6 * columns + 0.9, 3.7 * height + 0.6), layout="constrained")
    panels = [panel for row in rows for panel in row]
    axes = grid(figure, panels, columns)
    paint = colours(panels, quantity, loudest=common_top(rows))
    for k, (panel, ax) in enumerate(zip(panels, axes, strict=True)):
        image = draw(panel, ax, paint)
        title = _title(panel, names[k // width]) if k % width == 0 else ""
        if width > 1:
            title = f"{title}\n{place(panel)}" if title else place(panel)
        ax.set_title(title, fontsize="medium")
    add_bar(image, axes, paint)
    first = fields[0]
    targets = [] if first.solution is None else [asked(first.solution.targets, first.scene)]
    lines = [", ".join([*targets, place(first)] if width == 1 else targets), marks(rows[0])]
    figure.suptitle("\n".join(filter(None, lines)), fontsize="medium")
    return figure


def common_top(rows: Sequence[Sequence[Field]]) -> float:
    """The |p| at the top of everybody's scale, in Pa.

    It is the loudest panel's, unless that is far above the targets: one method that overshoots would make all
    others black. Where most do, their median sets it.
    """
    tops = [max(map(loud, row)) for row in rows]
    targets = [solution.targets.max() for row in rows if (solution := row[0].solution) is not None]
    if not targets:
        return max(tops)
    return min(max(tops), max(HEADROOM * float(max(targets)), float(np.median(tops))))


def _title(field: Field, name: str) -> str:
    solution = field.solution
    if solution is None:
        return name
    metrics = solution.metrics
    numbers = f"accuracy {number(metrics.accuracy)}, sigma {number(metrics.sigma)}, {level(solution)}"
    return f"{name}{scale(solution)}\n{numbers}"
