"""Chunks: the kept results of a sweep's finished jobs, a folder of jobs in the folder of the sweep."""

from __future__ import annotations

import re
from pathlib import Path

from .._support import kept
from .._support.kept import Arrays

#: Names of folders and files that are ours.
_FOLDER = re.compile(r"[0-9a-f]{20}")
_FILE = re.compile(r"\d+-\d+\.npz")


def load(path: Path, rows: int) -> Arrays | None:
    """Load the arrays of a kept result, each of so many rows; None where there is none, or a damaged one."""
    found = kept.load(path, identity(path))
    if found is None or not all(array.ndim and len(array) == rows for array in found.values()):
        return None
    return found


def save(path: Path, arrays: Arrays) -> None:
    """Keep a result. Raises SceneError where that cannot be."""
    kept.save(path, identity(path), arrays)


def identity(path: Path) -> str:
    """Name the job that a file answers."""
    return f"{path.parent.name}/{path.name}"


def remove(folder: Path) -> None:
    """Remove all kept results of a folder, and each folder that holds nothing else; follow no link."""
    for part in kept.inside(folder):
        if _FOLDER.fullmatch(part.name):
            kept.remove(part, _FILE)
