"""Writes docs/columns.md: every column of every printed table, from the package's columns.toml:
`make generated`.
"""

import re
import tomllib
from pathlib import Path

from marked import table
from midair._cli.app import TABLES

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "python" / "midair" / "_support" / "columns.toml"

HEAD = """\
# Columns of tables

This page explains each column of the tables that commands print. `midair COMMAND --help` prints the same
lines. [Metrics](conventions.md#how-good-an-answer-is) has the formulas. [Sweeps](sweeps.md#the-table) has the
columns of a sweep's file.
"""


def anchor(table: str, head: str) -> str:
    """Returns the anchor of a column, such as solutions-complex-error."""
    return re.sub(r"\W+", "-", f"{table} {head}").strip("-").lower()


def page() -> str:
    """Returns the page: a section for each table, a row for each column."""
    tables = tomllib.loads(SOURCE.read_text("utf-8"))
    sections = [HEAD]
    for name, columns in tables.items():
        commands = [f"`midair {command}`" for command, of in TABLES.items() if of == name]
        rows = [(f'<a id="{anchor(name, head)}"></a>`{head}`', about) for head, about in columns.items()]
        sections.append(f"## {' and '.join(commands)}\n\n{table(('column', 'meaning'), rows)}")
    return "\n".join(sections)


if __name__ == "__main__":
    ROOT.joinpath("docs", "columns.md").write_text(page(), encoding="utf-8")
