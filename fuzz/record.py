"""Records of tests: a row of fuzz.csv or sanitize.csv for each run. docs/reliability.md sums them up."""

import csv
import datetime
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

Row = list[str]


def today() -> str:
    """Returns the date in the form of the tables."""
    return datetime.date.today().isoformat()


def code(*folders: str) -> str:
    """Returns the state of some folders: git's short hash of each folder, with a plus if it has uncommitted
    changes.
    """
    names = []
    for folder in folders:
        name = _git("rev-parse", "--short=8", f"HEAD:{folder}")
        names.append(name + ("+" if _git("status", "--porcelain", "--", folder) else ""))
    return " ".join(names)


def _git(*arguments: str) -> str:
    command = ["git", *arguments]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, encoding="utf-8").stdout.strip()


def rows(name: str) -> list[Row]:
    """Returns the rows of a record, without its head."""
    with _file(name).open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))[1:]


def append(name: str, row: Row) -> None:
    """Appends a row to a record."""
    with _file(name).open("a", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerow(row)


def _file(name: str) -> Path:
    return ROOT / "fuzz" / f"{name}.csv"


def first(ends: Sequence[str], text: str, otherwise: str) -> str:
    """Returns the words by which a program's log says why it ended: of the first pattern that it contains."""
    found = next((found for end in ends if (found := re.search(end, text))), None)
    words = otherwise if found is None else found[found.lastindex or 0]
    return re.sub(r"[|`\s]+", " ", words)[:120]
