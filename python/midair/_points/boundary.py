"""Boundary: the sound on a mesh's elements, E linear equations by LAPACK, in steps that hear Ctrl-C."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from .._midair import Boundary, SceneError
from . import cache

#: Columns that are eliminated together.
BLOCK = 128

#: Multiplications between two looks at Ctrl-C: some tenths of a second.
STRETCH = 2 << 30

#: Elements from which on one waits long enough to be told.
LONG = 600


def sound(boundary: Boundary) -> NDArray[np.complex64]:
    """The sound (E, N) on the elements in Pa: solved, or as it was kept."""
    kept = cache.load(boundary.content(), boundary.shape)
    if kept is not None:
        return kept
    lapack()
    elements, transducers = boundary.shape
    memory = 8e-6 * elements * (elements + transducers)
    text = f"sound on a mesh of {elements:,} elements, {memory:,.0f} MB"
    terminal = Console(stderr=True)
    shown = elements > LONG and terminal.is_terminal
    with Progress(
        TextColumn("{task.description}"), BarColumn(), console=terminal, transient=True, disable=not shown
    ) as bar:
        # Filling the matrix takes as long as a few blocks.
        task = bar.add_task(text, total=1.0)

        def filled(step: int, steps: int, _: float) -> None:
            bar.update(task, completed=0.2 * step / steps)

        matrix, sent = boundary.matrix(filled), boundary.incident()
        for part in solve(matrix, sent):
            bar.update(task, completed=0.2 + 0.8 * part)
    if not np.isfinite(sent).all():
        cure = "the equations of this mesh have no answer: leave out faces that are nearly none"
        raise SceneError(f"obstacles is a mesh of {elements} elements: {cure}")
    cache.store(boundary.content(), sent)
    return sent


def lapack() -> Any:
    """SciPy's linear algebra."""
    try:
        from scipy import linalg
    except ImportError as error:
        raise SceneError('a Mesh needs SciPy: pip install "midair[mesh]"') from error
    return linalg


def solve(a: NDArray[np.complex64], b: NDArray[np.complex64]) -> Iterator[float]:
    """Solve a x = b (E, E) and (E, N) in their own memory, x in b; yields the part that is done.

    Gauss' elimination with row exchanges, a block of columns at a time.
    """
    linalg, size = lapack(), len(a)
    for first in range(0, size, BLOCK):
        last = min(first + BLOCK, size)
        below, right = slice(first, size), slice(last, size)
        block, pivots = linalg.lu_factor(a[below, first:last], check_finite=False)[:2]
        order = exchanged(pivots, size - first)
        a[below, first:last] = block
        a[below, right] = a[below, right][order]
        b[below] = b[below][order]
        lower = block[: last - first]
        for other in (a[:, right], b):
            other[first:last] = linalg.solve_triangular(
                lower, other[first:last], lower=True, unit_diagonal=True, check_finite=False
            )
            subtract(other, slice(last, size), block[last - first :], other[first:last])
        yield 1 - (1 - last / size) ** 3
    for first in reversed(range(0, size, BLOCK)):
        last = min(first + BLOCK, size)
        b[first:last] = linalg.solve_triangular(a[first:last, first:last], b[first:last], check_finite=False)
        subtract(b, slice(0, first), a[:first, first:last], b[first:last])


def exchanged(pivots: NDArray[np.int32], size: int) -> NDArray[np.intp]:
    """The order of rows after exchanges, one after another."""
    order = np.arange(size)
    for row, other in enumerate(pivots):
        order[[row, other]] = order[[other, row]]
    return order


def subtract(
    target: NDArray[np.complex64], rows: slice, left: NDArray[np.complex64], right: NDArray[np.complex64]
) -> None:
    """target[rows] -= left @ right, some rows at a time."""
    part = max(BLOCK, STRETCH // max(8 * right.size, 1))
    for first in range(rows.start, rows.stop, part):
        last = min(first + part, rows.stop)
        target[first:last] -= left[first - rows.start : last - rows.start] @ right
