"""Writes the record of a run as CSV, and makes the tables of pages from it."""

import csv
import datetime
import platform
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import midair
from midair._support import output

FIELDS = (
    "date", "cpu", "rival", "version", "method", "form", "grid", "N", "M", "rounds", "ns_median", "ns_min",
    "scenes", "accuracy", "sigma", "uniformity",
)  # fmt: skip
#: The program and the method to which all ratios relate.
REFERENCE, GREEDY = "autd3", "greedy 16 phases"
#: The rows of the README's table.
BRIEF = (("midair", "fast"), ("midair", "uniform"), (REFERENCE, GREEDY))
#: The form of call that the tables show for each program: from and to NumPy arrays, if the program has it.
_FORMS = {"midair": "solve", "autd3": "full", "autd3-rs": "full", "acoustools": "full"}
_SIZES, _JUDGED = (1, 4, 8, 16, 64), (16, 64)
_COUNT = "996"

Row = dict[str, str]
#: Rows of a table by program, method, grid and M.
_Found = dict[tuple[str, str, str, int], Row]


def cpu() -> str:
    """Returns the architecture and the widest vector instructions that the CPU reports."""
    try:
        flags = Path("/proc/cpuinfo").read_text("utf-8").split()
    except OSError:
        flags = []
    widest = next((name for name in ("avx512f", "avx2", "asimd", "sse2") if name in flags), "")
    return f"{platform.machine()} {widest}".strip()


def write(path: Path, rows: Sequence[Mapping[str, object]], fields: Iterable[str] = FIELDS) -> None:
    """Writes the file completely or not at all."""
    path.parent.mkdir(exist_ok=True)
    output.write(path, output.to_csv(rows, fields))


def add(name: str, rows: Sequence[Mapping[str, object]]) -> None:
    """Adds rows to a file of records; the date, the processor and the version stand before them."""
    path = Path(__file__).with_name("records") / name
    common = {"date": datetime.date.today(), "cpu": platform.machine(), "version": midair.__version__}
    new = [common | row for row in rows]
    write(path, [*(read(path) if path.exists() else []), *new], new[0])


def read(path: Path) -> list[Row]:
    """Returns the rows of a file that `write` wrote."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def tables(rows: Sequence[Row]) -> dict[str, str]:
    """Returns the table of each page that has one, by the page's path in the repository."""
    return {"README.md": brief(rows), "docs/performance.md": table(rows, "../bench")}


def brief(rows: Sequence[Row]) -> str:
    """Returns three rows as Markdown: speeds on the boards' grid, then the unevenness for the most points."""
    found, first, most = _found(rows), rows[0], _SIZES[-1]
    reference = {m: found.get((REFERENCE, GREEDY, "board", m)) for m in _SIZES}
    caption = (
        f"Speed relative to {REFERENCE}'s greedy search (= 1), for M points and {_COUNT} transducers on the"
        " grid of AUTD3 boards. Unevenness is sigma, the spread of the pressures over the points: 0 means"
        " equal."
    )
    body = []
    for rival, method in BRIEF:
        mine = {m: found.get((rival, method, "board", m)) for m in _SIZES}
        sigma = f"{float(mine[most]['sigma']):.3f}" if mine[most] else "-"
        speeds = " | ".join(_ratio(reference[m], mine[m]) for m in _SIZES)
        body.append(f"| {rival}, {method} | {speeds} | {sigma} |")
    times = "".join(f" M = {m} |" for m in _SIZES)
    head = [f"| |{times} unevenness, M = {most} |", "|---|" + "---:|" * (len(_SIZES) + 1)]
    version = next(row["version"] for row in rows if row["rival"] == "midair")
    details = f"{first['date']}, midair {version}, {first['cpu']}, one thread, medians of CPU time."
    return "\n".join([_wrapped(caption), "", *head, *body, "", _wrapped(details)])


def _found(rows: Sequence[Row]) -> _Found:
    shown = [row for row in rows if row["N"] == _COUNT and row["form"] == _FORMS.get(row["rival"], "call")]
    return {(row["rival"], row["method"], row["grid"], int(row["M"])): row for row in shown}


def table(rows: Sequence[Row], bench: str = "bench") -> str:
    """Returns the table as Markdown.

    The row of a method has ratios of median times at each M, and the quality of its results.
    """
    found = _found(rows)
    first = rows[0]
    caption = (
        f"Speed relative to {REFERENCE}'s greedy search (= 1), for M points and {_COUNT} transducers. In"
        " brackets: without rounding to the boards' grid of 256 phases x 256 amplitudes. The last two columns"
        " are accuracy / sigma; 1 / 0 means that every point has its target pressure."
    )
    rivals = {rival for rival, *_ in found}
    versions = dict.fromkeys(f"{row['rival']} {row['version']}" for row in rows if row["rival"] in rivals)
    details = (
        f"{first['date']}, {first['cpu']}, one thread, 2 x 2 AUTD3 boards of point sources, with the"
        f" computation of the propagation matrix; medians of CPU time over {first['rounds']} rounds; midair is"
        f" `midair.solve` from NumPy arrays.{_beside_gspat(found)}"
        " One forward model judges all drives, after rounding if there is a grid. The values are means over"
        f" {first['scenes']} scenes. {'; '.join(versions)}."
        f" [What the numbers include]({bench}/README.md)."
    )
    times = "".join(f" M = {m} |" for m in _SIZES)
    answers = "".join(f" answer, M = {m} |" for m in _JUDGED)
    rule = "|---|" + "---:|" * len(_SIZES) + "---|" * len(_JUDGED)
    head = [_wrapped(caption), "", f"| |{times}{answers}", rule]
    named = dict.fromkeys((rival, method) for rival, method, *_ in found)
    body = [f"| {rival}, {method} | {' | '.join(_cells(found, rival, method))} |" for rival, method in named]
    return "\n".join([*head, *body, "", *_setting(rows), _wrapped(details)])


def _setting(rows: Sequence[Row]) -> list[str]:
    """Returns the lines of another table, for the setting of the GS-PAT paper, if it was measured."""
    own = [
        f"| midair, {row['method']}, `solve_batch`, {row['form'].removeprefix('batch, ')} |"
        f" {1e9 / float(row['ns_median']):,.0f} |"
        for row in rows
        if row["form"].startswith("batch")
    ]
    theirs = "| GS-PAT on a GTX 1660 (Plasencia et al., ACM Trans. Graphics 39(4), 2020) | 17,000 |"
    head = "| GS-PAT's own setting: 32 points, here of 512 transducers on their grid | solutions a second |"
    return [head, "|---|---:|", *own, theirs, ""] if own else []


def _cells(found: _Found, rival: str, method: str) -> list[str]:
    def both(m: int) -> list[Row | None]:
        return [found.get((rival, method, grid, m)) for grid in ("board", "none")]

    def ratios(m: int) -> str:
        reference = found.get((REFERENCE, GREEDY, "board", m))
        board, free = (_ratio(reference, row) for row in both(m))
        return board if free == "-" else f"{board} ({free})"

    return [*(ratios(m) for m in _SIZES), *(_answer(*both(m)) for m in _JUDGED)]


def _beside_gspat(found: _Found) -> str:
    """Returns a sentence on the fastest method of midair and of autd3, for few points."""
    ours, theirs = (
        [found.get((*name, "board", m)) for m in (1, 4, 8)] for name in (("midair", "fast"), (REFERENCE, "gspat"))
    )
    ratios = [_ratio(*pair) for pair in zip(theirs, ours, strict=True)]
    parts = ", ".join(f"1/{ratio}" for ratio in ratios)
    return "" if "-" in ratios else f" `fast` takes {parts} of the time of autd3's gspat at M = 1, 4, 8."


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 118, break_long_words=False, break_on_hyphens=False)


def _answer(board: Row | None, free: Row | None) -> str:
    row = board or free
    return " / ".join(f"{float(row[metric]):.3f}" for metric in ("accuracy", "sigma")) if row else "-"


def _ratio(reference: Row | None, row: Row | None) -> str:
    if reference is None or row is None:
        return "-"
    ratio = float(reference["ns_median"]) / float(row["ns_median"])
    return f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.2g}"
