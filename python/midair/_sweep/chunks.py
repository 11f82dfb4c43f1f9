"""Kept results: a file of arrays with a digest for each finished job; what is damaged counts as not there."""

from __future__ import annotations

import hashlib
import io
import re
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from .._support import output

#: The arrays of a result, by their names.
Arrays = dict[str, NDArray[Any]]

#: No result of a job comes near this many bytes; what does is not read.
MOST_BYTES = 1 << 30

#: Bytes of the digest, the last of a file.
_DIGEST = hashlib.sha256().digest_size

#: Names of folders and files that are ours.
_FOLDER = re.compile(r"[0-9a-f]{20}")
_FILE = re.compile(r"\d+-\d+\.npz|\.\d+-\d+\.npz\.\d+\.part")


def load(path: Path, rows: int) -> Arrays | None:
    """The arrays of a kept result, each of so many rows; None where there is none, or a damaged one."""
    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            return None
        content = path.read_bytes()
        packed = content[:-_DIGEST]
        if content[-_DIGEST:] != _digest(path, packed):
            return None
        with zipfile.ZipFile(io.BytesIO(packed)) as file:
            # What is stored as it is cannot grow while it is read.
            if any(part.compress_type != zipfile.ZIP_STORED for part in file.infolist()):
                return None
        with np.load(io.BytesIO(packed), allow_pickle=False) as file:
            arrays = dict(file)
        fits = all(
            array.ndim and len(array) == rows and array.nbytes <= len(packed) for array in arrays.values()
        )
        return arrays if fits else None
    # Whatever lies there, no file ends a run.
    except Exception:
        return None


def save(path: Path, arrays: Arrays) -> None:
    """Keep a result. Raises SceneError where that cannot be."""
    if path.parent.is_symlink():
        raise SceneError(f'"{path.parent}" is a link: remove it, or choose another output')
    content = io.BytesIO()
    np.savez(content, **arrays)  # type: ignore[arg-type]
    packed = content.getvalue()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        output.write(path, packed + _digest(path, packed))
    except OSError as error:
        raise SceneError(
            f'"{path}" cannot be written ({error.strerror}): make room or choose another folder;'
            " what is done is kept"
        ) from error


def _digest(path: Path, packed: bytes) -> bytes:
    """Of the bytes and of the job that they answer: a file moved to another job's place is damaged, too."""
    return hashlib.sha256(f"{path.parent.name}/{path.name}\n".encode() + packed).digest()


def check(folder: Path) -> None:
    """Refuse a folder of kept results that is somebody's file or link."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise SceneError(
            f'"{folder}" is there and no folder of kept results: remove it, or choose another output'
        )


def remove(folder: Path) -> None:
    """Remove all kept results of a folder, and the folder if it holds nothing else; no link is followed."""
    for part in _inside(folder):
        if _FOLDER.fullmatch(part.name):
            for file in _inside(part):
                if _FILE.fullmatch(file.name):
                    with suppress(OSError):
                        file.unlink()
            with suppress(OSError):
                part.rmdir()
    with suppress(OSError):
        folder.rmdir()


def _inside(folder: Path) -> list[Path]:
    return [] if folder.is_symlink() or not folder.is_dir() else list(folder.iterdir())
