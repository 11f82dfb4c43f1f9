"""Boundary: the sound on a mesh's elements, E linear equations by LAPACK; Ctrl-C arrives meanwhile.

The solved sound is kept in files, by what it depends on.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from .._midair import Boundary, SceneError
from .._support import kept
from .._support.ctrl_c import interruptibly

#: Elements from which on a solve takes long enough for a progress bar.
LONG = 600

#: Of the sound at places inside, what may be left there: bodies that are solved well leave up to 13 %.
LEFT = 0.25

#: Bytes that are kept; beyond, the oldest go.
MOST = 1_000_000_000

#: Names of files that are ours, and of those of former versions.
OWN = re.compile(r"[0-9a-f]{32}\.np[yz]")


def sound(boundary: Boundary) -> NDArray[np.complex64]:
    """The sound (E, N) on the elements in Pa: solved, or as it was kept."""
    stored = load(boundary.content(), boundary.shape)
    if stored is not None:
        return stored
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
    store(boundary.content(), solved)
    return solved


def lapack() -> Any:
    """SciPy's linear algebra."""
    try:
        from scipy import linalg
    except ImportError as error:
        raise SceneError('a Mesh needs SciPy: pip install "midair[mesh]"') from error
    return linalg


def folder() -> Path:
    """Where files are kept: the system's place for what can be made again."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "midair" / "meshes"


def path(content: bytes) -> tuple[Path, str]:
    """The file of what depends on this content, and what its digest names."""
    key = hashlib.sha256(version("midair").encode() + content).hexdigest()
    return folder() / f"{key[:32]}.npz", key


def load(content: bytes, shape: tuple[int, int]) -> NDArray[np.complex64] | None:
    """Load what was kept, if it is whole."""
    arrays = kept.load(*path(content)) or {}
    found = arrays.get("sound")
    return found if found is not None and found.dtype == np.complex64 and found.shape == shape else None


def store(content: bytes, sound: NDArray[np.complex64]) -> None:
    """Store it, if there is space: the computation does not need it."""
    target, identity = path(content)
    with suppress(SceneError, OSError):
        kept.save(target, identity, {"sound": sound})
        prune(target.parent)


def prune(where: Path) -> None:
    """Leave the newest files, up to MOST bytes."""
    files = [file for file in kept.inside(where) if OWN.fullmatch(file.name)]
    size = 0
    for file in sorted(files, key=lambda file: file.stat().st_mtime, reverse=True):
        size += file.stat().st_size
        if size > MOST:
            file.unlink()
