"""The record of a run as CSV, and the README's table made from it."""

import csv
import os
import platform
import textwrap
from collections.abc import Sequence
from pathlib import Path

FIELDS = (
    "date", "cpu", "rival", "version", "method", "form", "N", "M", "rounds", "ns_median", "ns_min",
    "scenes", "accuracy", "sigma", "uniformity",
)  # fmt: skip
BEGIN, END = "<!-- bench:begin -->", "<!-- bench:end -->"
#: What the README's ratios refer to: rival, method, form.
REFERENCES = (("autd3", "greedy", "full"), ("textbook f64", "greedy", "call"))
#: The README's rows: NumPy in, NumPy out, or the call itself where there is no other.
_FORMS = {"midair": ("solve", "Solver"), "autd3": ("full",), "acoustools": ("full",)}
_SIZES = (16, 64)
_COUNT = "996"

Row = dict[str, str]


def cpu() -> str:
    """Architecture and the widest vectors that the CPU reports."""
    try:
        flags = Path("/proc/cpuinfo").read_text().split()
    except OSError:
        flags = []
    widest = next((name for name in ("avx512f", "avx2", "asimd", "sse2") if name in flags), "")
    return f"{platform.machine()} {widest}".strip()


def write(path: Path, rows: Sequence[Row]) -> None:
    """Whole or not at all."""
    path.parent.mkdir(exist_ok=True)
    new = path.with_suffix(".new")
    with new.open("w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    os.replace(new, path)


def read(path: Path) -> list[Row]:
    """What `write` wrote."""
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def table(rows: Sequence[Row]) -> str:
    """Markdown: a row a method at M = 16 and 64, medians as ratios, quality of the answers."""
    boards = [row for row in rows if row["N"] == _COUNT]
    found = {(row["rival"], row["method"], row["form"], int(row["M"])): row for row in boards}
    named = list(dict.fromkeys(key[:3] for key in found if key[2] in _FORMS.get(key[0], (key[2],))))
    versions = dict.fromkeys(f"{row['rival']} {row['version']}" for row in rows)
    first = rows[0]
    caption = (
        f"{first['date']}, {first['cpu']}, one thread, N = {_COUNT} (2 x 2 AUTD3 boards), G included. Ratios:"
        " how many times as fast as autd3's greedy, and as the textbook's in double precision, by medians of"
        f" CPU time over {first['rounds']} rounds. Answer: accuracy / sigma / uniformity by one forward"
        f" model, means over {first['scenes']} scenes."
        " [What the numbers include and whom they favour](bench/README.md)."
    )
    head = [
        _wrapped(caption),
        "",
        "| | " + " | ".join(f"M = {m}: x autd3 | x textbook | answer" for m in _SIZES) + " |",
        "|---" + "|---:|---:|---" * len(_SIZES) + "|",
    ]
    body = [
        f"| {_label(*name)} | " + " | ".join(_cells(found, name, m) for m in _SIZES) + " |" for name in named
    ]
    return "\n".join([*head, *body, "", _wrapped("; ".join(versions) + ".")])


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 118, break_long_words=False, break_on_hyphens=False)


def _label(rival: str, method: str, form: str) -> str:
    return f"`midair.{form}`, {method}" if rival == "midair" else f"{rival}, {method}"


def _cells(found: dict[tuple[str, str, str, int], Row], name: tuple[str, str, str], m: int) -> str:
    row = found.get((*name, m))
    if row is None:
        return "- | - | -"
    ratios = [_ratio(found.get((*reference, m)), row) for reference in REFERENCES]
    quality = " / ".join(f"{float(row[metric]):.3f}" for metric in ("accuracy", "sigma", "uniformity"))
    return " | ".join([*ratios, quality])


def _ratio(reference: Row | None, row: Row) -> str:
    if reference is None:
        return "-"
    ratio = float(reference["ns_median"]) / float(row["ns_median"])
    return f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.2g}"


def place(readme: Path, text: str) -> None:
    """Puts the table between the README's markers."""
    page = readme.read_text()
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise SystemExit(f"{readme} has no lines {BEGIN} and {END} to put the table between")
    new = readme.with_suffix(".new")
    new.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}")
    os.replace(new, readme)
