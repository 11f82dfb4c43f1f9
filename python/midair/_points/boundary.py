"""Boundary: the sound on a mesh's elements, E linear equations by LAPACK; Ctrl-C arrives meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from .._midair import Boundary, SceneError
from .._support.ctrl_c import interruptibly
from . import cache

#: Elements from which on a solve takes long enough for a progress bar.
LONG = 600

#: Of the sound at places inside, what may be left there: bodies that are solved well leave up to 13 %.
LEFT = 0.25


def sound(boundary: Boundary) -> NDArray[np.complex64]:
    """The sound (E, N) on the elements in Pa: solved, or as it was kept."""
    kept = cache.load(boundary.content(), boundary.shape)
    if kept is not None:
        return kept
    linalg = lapack()
    elements, transducers = boundary.shape
    # LAPACK wants the right-hand sides column by column: a second copy.
    memory = 8e-6 * elements * (elements + 2 * transducers)
    text = f"sound on a mesh of {elements:,} elements, {memory:,.0f} MB"
    terminal = Console(stderr=True)
    shown = elements > LONG and terminal.is_terminal
    with Progress(
        TextColumn("{task.description}"), BarColumn(), console=terminal, transient=True, disable=not shown
    ) as bar:
        task = bar.add_task(text, total=1.0)

        def filled(step: int, steps: int, _: float) -> None:
            bar.update(task, completed=step / steps)

        matrix, incident = boundary.matrix(filled), boundary.incident()
        # LAPACK reports no progress: the bar pulses.
        bar.update(task, total=None)
        # The transpose lies in memory as LAPACK wants it, and is factored there.
        factors = interruptibly(linalg.lu_factor, matrix.T, overwrite_a=True, check_finite=False)
        solved = interruptibly(linalg.lu_solve, factors, incident, trans=1, check_finite=False)
    if not np.isfinite(solved).all():
        cure = "the equations of this mesh have no answer: leave out faces that are nearly none"
        raise SceneError(f"obstacles is a mesh of {elements} elements: {cure}")
    solved = np.ascontiguousarray(solved)
    if (left := boundary.left_inside(solved)) > LEFT:
        cure = "mend the surface, give finer faces, or leave out thin parts"
        raise SceneError(
            f"obstacles is a mesh of {elements} elements that lets {left:.0%} of the sound into its inside:"
            f" {cure}"
        )
    cache.store(boundary.content(), solved)
    return solved


def lapack() -> Any:
    """SciPy's linear algebra."""
    try:
        from scipy import linalg
    except ImportError as error:
        raise SceneError('a Mesh needs SciPy: pip install "midair[mesh]"') from error
    return linalg
