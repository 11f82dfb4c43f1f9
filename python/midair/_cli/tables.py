"""Tables and lines on standard output."""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from .. import Solution
from .._judging.compare import cells
from .._support import output

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Blanks between two columns.
GAP = 3

#: Letters of a picture as fonts and text, which journals ask for.
FONTS: Any = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}


def write_image(path: Path, figure: Figure) -> None:
    """Write a figure in the format of the path's ending."""
    from matplotlib import rc_context

    content = io.BytesIO()
    with rc_context(FONTS):
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


def print_summary(solution: Solution) -> None:
    """What a solution makes at its points, in one plain sentence."""
    got = np.abs(solution.pressures[solution.targets > 0])
    if not got.size:
        return
    low, high = float(got.min()), float(got.max())
    points = f"{got.size} point{'s' * (got.size > 1)}"
    if solution.scene is not None and solution.scene.in_paper_unit:
        loud = (
            f"{low:.4g} to {high:.4g} in the paper's unit"
            if high > 1.001 * low
            else f"{low:.4g} in the paper's unit"
        )
    else:
        level = 20 * math.log10(max(low, 1e-30) / math.sqrt(2) / 20e-6)
        span = f"{low:.4g} to {high:.4g} Pa" if high > 1.001 * low else f"{low:.4g} Pa"
        loud = f"{span} ({level:.0f} dB{' and more' * (high > 1.12 * low)})"
    alike = f", alike to {max(100 * (1 - low / high), 0.1):.2g} %" if got.size > 1 and high > 0 else ""
    line = f"{points} at {loud} with {len(solution.drive)} transducers{alike}."
    console.print(line, markup=False, highlight=False, soft_wrap=True)


def print_columns(columns: Mapping[str, list[str]]) -> None:
    """Columns of text as a table; where they do not fit, each is a row, in as many parts as it takes."""
    lines = [list(columns), *map(list, zip(*columns.values(), strict=True))]
    widths = [max(map(len, column)) + GAP for column in zip(*lines, strict=True)]
    width = console.width - GAP
    if sum(widths) <= width:
        _print_lines(lines)
        return
    head, *rest = lines
    room = width - max(map(len, head)) - GAP
    while rest:
        taken = 1
        while taken < len(rest) and sum(max(map(len, line)) + GAP for line in rest[: taken + 1]) <= room:
            taken += 1
        _print_lines(list(zip(head, *rest[:taken], strict=True)))
        rest = rest[taken:]


def _print_lines(lines: Sequence[Sequence[str]]) -> None:
    """Lines of cells under the first as their head."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in lines[0]:
        table.add_column(name, no_wrap=True, overflow="fold")
    for line in lines[1:]:
        table.add_row(*line)
    console.print(table)
