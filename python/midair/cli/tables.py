"""Tables and lines on standard output."""

from __future__ import annotations

import sys
from collections.abc import Iterable

from rich import box
from rich.console import Console
from rich.table import Table

from .. import Solution
from ..compare import cells

# A pipe has no width of its own; tables keep theirs.
console = Console() if sys.stdout.isatty() else Console(width=120)


def print_written(what: object) -> None:
    """The line that tells what was written, names of files as they are."""
    console.print(f"wrote {what}", markup=False, emoji=False, highlight=False, soft_wrap=True)


def print_solutions(
    solutions: Iterable[Solution], names: Iterable[str] | None = None, gaps: Iterable[float] | None = None
) -> None:
    """Metrics side by side, under the solvers' names unless told otherwise."""
    solutions = list(solutions)
    columns = cells(solutions, names or [solution.solver for solution in solutions], gaps)
    table = Table(*columns, box=box.SIMPLE_HEAD, pad_edge=False)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    console.print(table)
