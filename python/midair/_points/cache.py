"""Cache: sound on meshes that has been solved, in files by what it depends on."""

from __future__ import annotations

import hashlib
import os
import re
import sys
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from .._support import kept

#: Bytes that are kept; beyond, the oldest go.
MOST = 1_000_000_000

#: Names of files that are ours, and of those of former versions.
OWN = re.compile(r"[0-9a-f]{32}\.np[yz]")


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
    """Keep it, if there is room: nobody needs it to go on."""
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
