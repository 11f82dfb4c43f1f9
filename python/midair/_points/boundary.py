"""Boundary element method: solves for the sound on a mesh with LAPACK, and caches the solutions in files.

Ctrl-C takes effect during the solve. A file's name is a hash of everything that its content depends on.
"""

import hashlib
import os
import re
import sys
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from .._midair import Boundary, SceneError, stated
from .._support import cache
from .._support.arguments import needs
from .._support.ctrl_c import interruptibly

#: A solve with at least this number of elements shows a progress bar.
LONG = 600

#: Largest relative sound inside of a mesh, where it should be 0; accurately solved meshes have up to 13 %.
LEFT = 0.25

#: Largest size in bytes of all cached files together; beyond that, the oldest are removed.
MOST = 1_000_000_000

#: Names of cached files, also of earlier versions.
OWN = re.compile(r"[0-9a-f]{32}\.np[yz]")


def sound(boundary: Boundary) -> NDArray[np.complex64]:
    """Return the sound (E, N) on the elements in Pa, from the cache or by a solve."""
    stored = load(boundary.content(), boundary.shape)
    if stored is not None:
        return stored
    with needs("a Mesh needs SciPy", "mesh"):
        from scipy import linalg
    elements, transducers = boundary.shape
    # LAPACK needs the right-hand sides in column order, which takes a second copy.
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
        # LAPACK reports no progress, so the bar only shows activity.
        bar.update(task, total=None)
        # The transpose is in LAPACK's memory order, and is factored in place.
        factors = interruptibly(linalg.lu_factor, matrix.T, overwrite_a=True, check_finite=False)
        solved = interruptibly(linalg.lu_solve, factors, incident, trans=1, check_finite=False)
    if not np.isfinite(solved).all():
        cure = "the equations of this mesh have no answer: leave out faces that are nearly none"
        raise stated("obstacles", f"is a mesh of {elements} elements", cure)
    solved = np.ascontiguousarray(solved)
    if (left := boundary.left_inside(solved)) > LEFT:
        cure = "mend the surface, give finer faces, or leave out thin parts"
        reported = f"is a mesh of {elements} elements that lets {left:.0%} of the sound into its inside"
        raise stated("obstacles", reported, cure)
    store(boundary.content(), solved)
    return solved


def folder() -> Path:
    """Return the folder of the cache: the system's folder for data that can be computed again."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "midair" / "meshes"


def path(content: bytes) -> tuple[Path, str]:
    """Return the cache file of results that depend on `content`, and their identity, the full hash."""
    key = hashlib.sha256(version("midair").encode() + content).hexdigest()
    return folder() / f"{key[:32]}.npz", key


def load(content: bytes, shape: tuple[int, int]) -> NDArray[np.complex64] | None:
    """Load a cached solution; None if it is missing or damaged."""
    arrays = cache.load(*path(content)) or {}
    found = arrays.get("sound")
    return found if found is not None and found.dtype == np.complex64 and found.shape == shape else None


def store(content: bytes, sound: NDArray[np.complex64]) -> None:
    """Store a solution if possible; errors are ignored, because the cache is only an aid."""
    target, identity = path(content)
    with suppress(SceneError, OSError):
        cache.save(target, identity, {"sound": sound})
        prune(target.parent)


def prune(where: Path) -> None:
    """Remove the oldest files beyond MOST bytes."""
    files = [file for file in cache.inside(where) if OWN.fullmatch(file.name)]
    size = 0
    for file in sorted(files, key=lambda file: file.stat().st_mtime, reverse=True):
        size += file.stat().st_size
        if size > MOST:
            file.unlink()
