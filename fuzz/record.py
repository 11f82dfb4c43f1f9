"""Writes the tables of docs/reliability.md: one row for each test, state of the code and day."""

from __future__ import annotations

import datetime
import subprocess
import sys
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
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()


def rows(name: str) -> list[Row]:
    """Returns the rows of a table of the page."""
    return [cells(line) for line in parts(PAGE, name)[1].splitlines()[2:]]


def add(name: str, row: Row, keys: int) -> None:
    """Replaces the row of a table whose first `keys` cells are the same, or appends the row."""
    found = rows(name)
    same = [index for index, other in enumerate(found) if other[:keys] == row[:keys]]
    found[same[0] if same else len(found) : (same[0] + 1) if same else len(found)] = [row]
    put(PAGE, name, table(cells(parts(PAGE, name)[1].splitlines()[0]), found))
