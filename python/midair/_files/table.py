"""Tables of text: rows of cells between commas, semicolons or tabs, told by line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from .content import fault


def rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Line numbers and cells; empty lines and those that begin with # are passed over."""
    for line, row in enumerate(text.splitlines(), 1):
        if row.strip() and not row.lstrip().startswith("#"):
            yield line, cells(row)


def cells(row: str) -> list[str]:
    """The cells of a row."""
    separator = next((mark for mark in ";\t" if mark in row), ",")
    return [cell.strip().strip('"').strip() for cell in row.split(separator)]


def number(cell: str) -> float | None:
    """A finite number, None for anything else."""
    try:
        found = float(cell) if "_" not in cell else np.nan
    except ValueError:
        return None
    return found if np.isfinite(found) else None


def numbers(
    path: str | PathLike[str], line: int, found: Sequence[str], names: Sequence[str] = ()
) -> NDArray[np.float64]:
    """A row of finite numbers; `names` are those of its columns, else they are counted."""
    try:
        row = np.array(found, np.float64)
    except ValueError:
        row = np.array([np.nan])
    # Python's numbers may have underscores.
    if not np.isfinite(row).all() or "_" in "".join(found):
        for index, cell in enumerate(found):
            if number(cell) is None:
                name = names[index] if names else f"column {index + 1}"
                raise fault(path, line, f'{name} is "{cell}": give a finite number')
    return row


def columns(
    path: str | PathLike[str], line: int, header: Sequence[str], needed: Sequence[str], cure: str
) -> dict[str, int]:
    """Where a row of names has its columns; those that are needed must be there, none twice."""
    found = [name.lower() for name in header]
    for name in needed:
        if name not in found:
            raise fault(path, line, f'there is no column "{name}": {cure}')
        if found.count(name) > 1:
            raise fault(path, line, f'column "{name}" is there twice: {cure}')
    return {name: index for index, name in reversed(list(enumerate(found)))}


def picked(
    path: str | PathLike[str], line: int, row: Sequence[str], where: dict[str, int], names: Sequence[str]
) -> NDArray[np.float64]:
    """Some columns of a row, by name."""
    cell = [row[where[name]] if where[name] < len(row) else "" for name in names]
    return numbers(path, line, cell, names)
