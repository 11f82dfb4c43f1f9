"""Writes the tables of docs/reliability.md: one row for each run of a test with its newest code."""

import datetime
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "book"))
from marked import cells, parts, put, table

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reliability.md"

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
    """Returns the rows of a table of the page."""
    return [cells(line) for line in parts(PAGE, name)[1].splitlines()[2:]]


def append(name: str, row: Row) -> None:
    """Appends a row to a table of the page. It replaces the rows of the same test with other code."""
    kept = [old for old in rows(name) if old[0] != row[0] or old[1] == row[1]]
    put(PAGE, name, table(cells(parts(PAGE, name)[1].splitlines()[0]), [*kept, row]))


def first(ends: Sequence[str], text: str, otherwise: str) -> str:
    """Returns the words by which a program's log says why it ended: of the first pattern that it contains."""
    found = next((found for end in ends if (found := re.search(end, text))), None)
    words = otherwise if found is None else found[found.lastindex or 0]
    return re.sub(r"[|`\s]+", " ", words)[:120]
