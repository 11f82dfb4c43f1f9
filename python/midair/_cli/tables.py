"""Tables and lines that `solve`, `compare` and other commands print."""

import io
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from .. import Field, Solution
from .._judging.compare import cells, weakest
from .._pictures.colours import Figure, table
from .._pictures.words import beads, is_requested, off, sentence
from .._support import output

#: Largest number of characters per row of a picture in the terminal; the characters for pressures from 0 to
#: the highest.
WIDEST = 76
SHADES = " .:-=+*#%@"

#: The same for terminals of 16 colours, which would show the picture in garish ones.
BLOCKS = " ░▒▓█"

#: Columns that a narrow terminal does not show; the first ones are left out first.
SPARED = ("sigma", "residual", "limit", "complex error", "accuracy", "steps", "time", "gap")


def write_image(path: Path, figure: Figure) -> None:
    """Write a figure in the format of the path's ending."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=150)
    output.write(path, content.getvalue())


#: Function that chooses a metric's best value.
BEST: dict[str, Callable[[Iterable[float]], float]] = {
    "accuracy": max,
    "sigma": min,
    "uniformity": max,
    "level": max,
    "residual": min,
    "leak": min,
    "complex error": min,
    "gap": min,
    "largest change": min,
    "seam": min,
    "dip": max,
    "noise": min,
}


class _Console(Console):
    """A console whose output may be a pipe that its reader closes at any time."""

    def on_broken_pipe(self) -> None:
        """Raise the error, so that `main` ends the program without a message."""
        raise BrokenPipeError


# A pipe has no width, so tables get 120 characters. If standard output is closed, `sys.stdout` is None.
console = _Console() if sys.stdout is not None and sys.stdout.isatty() else _Console(width=120)


def print_line(text: str, style: str = "") -> None:
    """Print a line of text exactly as it is, without line breaks in a pipe; a terminal shows the style."""
    console.print(text, style=style, markup=False, emoji=False, highlight=False, soft_wrap=True)


def print_hint(command: str, before: str = "") -> None:
    """Print where the columns of a command's table are explained."""
    print_line(f"{before}columns: midair {command} --help, docs/columns.md", "dim")


def print_facts(lines: Mapping[str, str]) -> None:
    """Print names and values, one pair per line, exactly as they are."""
    for name, line in lines.items():
        print_line(f"  {name + ':':14}{line}")


@contextmanager
def beside(document: bool) -> Iterator[None]:
    """Print tables on standard error while standard output is used for a document."""
    console.stderr = document
    try:
        yield
    finally:
        console.stderr = False


def print_written(what: object) -> None:
    """Print the line that names a written file."""
    print_line(f"wrote {what}")


def print_solutions(
    command: str, solutions: Iterable[Solution], names: Iterable[str] | None = None, gaps: Iterable[float] | None = None
) -> None:
    """Print a sentence about the best solution, and the metrics of all side by side.

    The columns have the solvers' names unless `names` are given.
    """
    solutions = list(solutions)
    names = list(names or [solution.solver for solution in solutions])
    columns = cells(solutions, names, gaps)
    quality = [-off(each) if is_requested(each) else weakest(each) for each in solutions]
    best = quality.index(max(quality))
    name = f"{names[best]}: " if len(solutions) > 1 else ""
    words = [f"{name}{sentence(solutions[best])}", *filter(None, [beads(solutions[best])])]
    print_columns(command, columns if len(solutions) == 1 else best_of(columns), *words)


def print_columns(command: str, columns: Mapping[str, list[str]], *sentences: str) -> None:
    """Print sentences, columns of text as a table that is never cut, and where its columns are explained.

    If a table is too wide, rows and columns are exchanged, or some columns are left out.
    """
    for line in sentences:
        print_line(line, "bold")
    shown = dict(columns)
    if not _fits(_table(shown)) and _fits(_table(_turned(shown))):
        shown = _turned(shown)
    left = []
    for name in SPARED:
        if _fits(_table(shown)):
            break
        if shown.pop(name, None) is not None:
            left.append(name)
    if not _fits(_table(shown)):
        # Error texts of the operating system may be wider than the terminal: each row is then printed as
        # several lines.
        for row in zip(*columns.values(), strict=True):
            print_facts(dict(zip(columns, row, strict=True)))
    else:
        console.print(_table(shown))
        if left:
            print_line(f"left out, because the terminal is narrow: {', '.join(left)}; --json has all")
    print_hint(command)


def print_list(command: str, columns: Mapping[str, list[str]]) -> None:
    """Print a row per entry. The text of the last column continues on further lines if it is too long."""
    console.print(_table(columns, wrapped=True))
    print_hint(command, f"midair {command} NAME describes one of them; ")


def print_field(field: Field) -> None:
    """Print |p| of each panel of a field: in colours, with two rows of samples per line, or as characters."""
    colours = ["#" + bytes(colour).hex() for colour in table("field")]
    shades = {None: SHADES, "standard": BLOCKS, "windows": BLOCKS}.get(console.color_system)
    for panel in field.panels or [field]:
        pressure = np.abs(panel.pressure)
        top = max(float(pressure.max()), 1e-30)
        height, width = pressure.shape
        across = min(console.width - 1, WIDEST)
        rows = max(round(across * height / width / 2), 1)
        picked = np.ix_(_spread(height, 2 * rows)[::-1], _spread(width, across))
        parts = pressure[picked] / top
        for above, below in zip(parts[::2], parts[1::2], strict=True):
            line = Text(no_wrap=True)
            for one, other in zip(above, below, strict=True):
                if shades is not None:
                    line.append(shades[round((one + other) / 2 * (len(shades) - 1))])
                else:
                    ends = [colours[round(255 * part)] for part in (one, other)]
                    line.append("\u2580", f"{ends[0]} on {ends[1]}")
            console.print(line, soft_wrap=True)
        print_line(_legend(panel, top))


def _spread(size: int, count: int) -> NDArray[np.intp]:
    """Return indices of `count` evenly spaced samples of a side, from the first to the last."""
    return np.linspace(0, size - 1, count).round().astype(np.intp)


def _legend(panel: Field, top: float) -> str:
    """Return the extent of a picture and its largest sample, as text."""
    known = [(name, getattr(panel, name)) for name in "xyz"]
    sides = [(name, side) for name, side in known if side is not None and side.size > 1]
    ends = [f"{name} {1e3 * side[0]:.0f} to {1e3 * side[-1]:.0f}" for name, side in sides]
    plane = panel.plane
    place = "" if plane is None else f", {plane.axis} = {1e3 * plane.at:.0f}"
    unit = "in the paper's unit" if panel.scene.in_paper_unit else "Pa"
    return f"{', '.join(ends)}{place} mm; brightest {top:.4g} {unit}"


class _Best(str):
    """A cell with the best value of its column; a terminal shows it in colour."""


def best_of(columns: Mapping[str, list[str]]) -> dict[str, list[str]]:
    """Return columns whose best values are marked, unless all values are equal."""
    shown = dict(columns)
    for name, choose in BEST.items():
        column = shown.get(name, [])
        values = {cell: float(cell.rstrip("%")) for cell in column if cell != "-"}
        if len(values) > 1:
            best = choose(values.values())
            shown[name] = [_Best(cell) if values.get(cell) == best else cell for cell in column]
    return shown


def _turned(columns: Mapping[str, list[str]]) -> dict[str, list[str]]:
    """Return the table with rows and columns exchanged: one row per metric, one column per method."""
    first, *others = columns
    rows = zip(*(columns[name] for name in others), strict=True)
    return {first: others} | {name: list(row) for name, row in zip(columns[first], rows, strict=True)}


def _table(columns: Mapping[str, list[str]], *, wrapped: bool = False) -> Table:
    """Return a table, numbers at the right; the last column may be `wrapped`."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    *_, last = columns
    for name, column in columns.items():
        numbers = all(cell[:1].isdigit() or cell[:1] == "-" for cell in column)
        table.add_column(escape(name), no_wrap=not wrapped or name != last, justify="right" if numbers else "left")
    for row in zip(*columns.values(), strict=True):
        table.add_row(*(Text(cell, "bold green" if isinstance(cell, _Best) else "") for cell in row))
    return table


def _width(table: Table) -> int:
    """Return the width of an uncut table in characters."""
    return Measurement.get(console, console.options.update(max_width=10_000), table).maximum


def _fits(table: Table) -> bool:
    return _width(table) <= console.width
