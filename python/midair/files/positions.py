"""`.csv` of positions, by the rules of a scene file's `positions = { file = ... }` (docs/conventions.md)."""

from __future__ import annotations

from os import PathLike

import numpy as np

from .content import fault, text
from .layout import Layout
from .table import columns, number, picked, rows

AXES = ("x", "y", "z")
NORMALS = ("nx", "ny", "nz")
CURE = "give x,y,z in m, or x,y,z,nx,ny,nz"


def read(path: str | PathLike[str]) -> Layout:
    """Read a row for each transducer."""
    names: tuple[str, ...] = ()
    where: dict[str, int] = {}
    found = []
    for line, row in rows(text(path)):
        if not names:
            names, where, header = _columns(path, line, row)
            if header:
                continue
        found.append(picked(path, line, row, where, names))
    if not found:
        raise fault(path, None, f"no row is in it: {CURE} for each transducer")
    table = np.array(found)
    return Layout(table[:, :3], table[:, 3:] if len(names) == 6 else None)


def _columns(
    path: str | PathLike[str], line: int, row: list[str]
) -> tuple[tuple[str, ...], dict[str, int], bool]:
    """Which columns are read, where they are, and whether this is a row of names."""
    every = AXES + NORMALS
    if number(row[0]) is not None:
        if len(row) not in (3, 6):
            raise fault(path, line, f"{len(row)} columns: {CURE}")
        names = every[: len(row)]
        return names, dict(zip(names, range(6), strict=False)), False
    given = [name.lower() for name in row]
    names = every if any(name in given for name in NORMALS) else AXES
    return names, columns(path, line, row, names, CURE), True
