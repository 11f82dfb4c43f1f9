"""`.csv` of positions: the core reads it, as it reads those that a scene file names (docs/conventions.md)."""

from __future__ import annotations

from os import PathLike

from .._midair import read_table
from .content import content
from .layout import Layout


def read(path: str | PathLike[str]) -> Layout:
    """Read a row for each transducer."""
    _, table = read_table(content(path, empty=True), str(path))
    return Layout(table[:, :3], table[:, 3:] if table.shape[1] == 6 else None)
