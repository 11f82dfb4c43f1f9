"""Tables and lines on standard output."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table

from .. import Solution

# A pipe has no width of its own; tables keep theirs.
console = Console() if sys.stdout.isatty() else Console(width=120)


def print_written(what: object) -> None:
    """The line that tells what was written, names of files as they are."""
    console.print(f"wrote {what}", markup=False, emoji=False, highlight=False, soft_wrap=True)


def print_solutions(solutions: Sequence[Solution], gaps: Sequence[float] | None = None) -> None:
    """Metrics side by side; the leak only where there are quiet points, the gap where it is known."""
    names = ["accuracy", "sigma", "uniformity", "level", "residual"]
    if any(solution.metrics.leak > 0 for solution in solutions):
        names.append("leak")
    known = [] if gaps is None else ["gap"]
    table = Table(
        "solver", *names, *known, "limit", "steps", "time", "status", box=box.SIMPLE_HEAD, pad_edge=False
    )
    for k, solution in enumerate(solutions):
        numbers = [f"{getattr(solution.metrics, name):.4f}" for name in names]
        numbers += [] if gaps is None else [f"{gaps[k]:.1%}"]
        limit = str(solution.options.get("limit", "-"))
        time = _duration(solution.elapsed)
        status = solution.status if solution.scale == 1 else f"{solution.status}, scale {solution.scale:.3g}"
        table.add_row(solution.solver, *numbers, limit, str(solution.steps), time, status)
    console.print(table)


def _duration(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 1 else f"{seconds * 1e3:.2f} ms"
