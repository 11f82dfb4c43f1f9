"""Writes the tables of docs/reliability.md: one row for each test, state of the code and day."""

from __future__ import annotations

import datetime
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
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


def rows(table: str) -> list[Row]:
    """Returns the rows of a table, which is found by its markers."""
    _, inside, _ = _parts(table)
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in inside.splitlines()[2:]]


def put(table: str, row: Row, keys: int) -> None:
    """Replaces the row whose first `keys` cells are the same, or appends the row.
    The file is never left incomplete.
    """
    before, inside, after = _parts(table)
    found = rows(table)
    same = [index for index, other in enumerate(found) if other[:keys] == row[:keys]]
    found[same[0] if same else len(found) : (same[0] + 1) if same else len(found)] = [row]
    head = inside.splitlines()[:2]
    lines = [*head, *(f"| {' | '.join(cells)} |" for cells in found)]
    new = PAGE.with_suffix(".new")
    new.write_text(before + "\n".join(lines) + "\n" + after, encoding="utf-8")
    os.replace(new, PAGE)


def _parts(table: str) -> tuple[str, str, str]:
    text = PAGE.read_text(encoding="utf-8")
    before, begin, rest = text.partition(f"<!-- {table}:begin -->\n")
    inside, end, after = rest.partition(f"<!-- {table}:end -->")
    if not begin or not end:
        raise SystemExit(f"{PAGE} has no table between <!-- {table}:begin --> and <!-- {table}:end -->")
    return before + begin, inside, end + after
