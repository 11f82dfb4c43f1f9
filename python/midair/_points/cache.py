"""Cache: sound on meshes that has been solved, in files by what it depends on."""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

#: Bytes that are kept; beyond, the oldest go.
MOST = 1_000_000_000


def folder() -> Path:
    """Where files are kept: the system's place for what can be made again."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "midair" / "meshes"


def path(content: bytes) -> Path:
    """The file of what depends on this content."""
    key = hashlib.sha256(version("midair").encode() + content).hexdigest()
    return folder() / f"{key[:32]}.npy"


def load(content: bytes, shape: tuple[int, int]) -> NDArray[np.complex64] | None:
    """What was kept, if it is whole."""
    try:
        found = np.load(path(content), allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    whole = found.dtype == np.complex64 and found.shape == shape and bool(np.isfinite(found).all())
    return np.ascontiguousarray(found) if whole else None


def store(content: bytes, sound: NDArray[np.complex64]) -> None:
    """Keep it, if there is room: nobody needs it to go on."""
    target = path(content)
    with suppress(OSError):
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                np.save(file, sound)
            os.replace(name, target)
        except BaseException:
            os.unlink(name)
            raise
        prune(target.parent)


def prune(where: Path) -> None:
    """Leave the newest files, up to MOST bytes."""
    files = sorted(where.glob("*.npy"), key=lambda file: file.stat().st_mtime, reverse=True)
    size = 0
    for file in files:
        size += file.stat().st_size
        if size > MOST:
            file.unlink()
