"""Tables and lines on standard output."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table

from .. import Solution
from .._judging.compare import cells
from .._support import output

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_image(path: Path, figure: Figure) -> None:
    """Write a figure in the format of the path's ending."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=150)
    output.write(path, content.getvalue())


class _Console(Console):
    """Tables for people, and for pipes that may be closed at any time."""

    def on_broken_pipe(self) -> None:
        """Leave it to `main` to end quietly."""
        raise BrokenPipeError


# A pipe has no width of its own; tables keep theirs. Where standard output is closed there is none at all.
console = _Console() if sys.stdout is not None and sys.stdout.isatty() else _Console(width=120)


def print_facts(lines: Mapping[str, str]) -> None:
    """Names and what is known by them, a line each, words as they are."""
    for name, line in lines.items():
        console.print(f"  {name + ':':14}{line}", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def beside(document: bool) -> Iterator[None]:
    """Tables on standard error where a document takes standard output."""
    console.stderr = document
    try:
        yield
    finally:
        console.stderr = False


def print_written(what: object) -> None:
    """The line that tells what was written, names of files as they are."""
    console.print(f"wrote {what}", markup=False, emoji=False, highlight=False, soft_wrap=True)


def print_solutions(
    solutions: Iterable[Solution], names: Iterable[str] | None = None, gaps: Iterable[float] | None = None
) -> None:
    """Metrics side by side, under the solvers' names unless told otherwise."""
    solutions = list(solutions)
    columns = cells(solutions, names or [solution.solver for solution in solutions], gaps)
    print_columns(columns)


def print_columns(columns: Mapping[str, list[str]]) -> None:
    """Columns of text as a table."""
    table = Table(*columns, box=box.SIMPLE_HEAD, pad_edge=False)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    console.print(table)
