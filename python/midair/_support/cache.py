"""Cache files: arrays that can be computed again, each with a hash; one run at a time uses a folder."""

import hashlib
import io
import os
import re
import sys
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import stated
from . import output

Arrays = dict[str, NDArray[Any]]

#: Files with more bytes are not read.
MOST_BYTES = 1 << 32

#: Bytes of the hash at the end of a file.
DIGEST = hashlib.sha256().digest_size

#: Name of the file that a process locks while it uses a folder.
LOCK = "lock"


def load(path: Path, identity: str) -> Arrays | None:
    """Load the arrays that `save` wrote for this identity; None if they are missing or damaged."""
    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            return None
        content = path.read_bytes()
        packed = content[:-DIGEST]
        if content[-DIGEST:] != digest(identity, packed):
            return None
        with zipfile.ZipFile(io.BytesIO(packed)) as file:
            # Compressed entries are rejected, because they could unpack to any size.
            if any(part.compress_type != zipfile.ZIP_STORED for part in file.infolist()):
                return None
        with np.load(io.BytesIO(packed), allow_pickle=False) as file:
            arrays = dict(file)
        return arrays if all(array.nbytes <= len(packed) for array in arrays.values()) else None
    # Whatever a file contains, it must not end a run.
    except Exception:
        return None


def save(path: Path, identity: str, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Save arrays with a hash of their bytes and of `identity`, the text that identifies their computation.

    Raises SceneError if the file cannot be written.
    """
    if path.parent.is_symlink():
        raise stated(f'"{path.parent}"', "is a link", "remove it, or choose another output")
    content = io.BytesIO()
    np.savez(content, **arrays)  # type: ignore[arg-type]
    packed = content.getvalue()
    with output.refusing(f'"{path}"'):
        path.parent.mkdir(parents=True, exist_ok=True)
        output.write(path, packed + digest(identity, packed))


def digest(identity: str, packed: bytes) -> bytes:
    """Return the hash of the bytes and the identity.

    With it, `load` also rejects a file that was renamed to the name of another result.
    """
    return hashlib.sha256(f"{identity}\n".encode() + packed).digest()


def check(folder: Path) -> None:
    """Raise SceneError if a folder for cache files is a link or no folder."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        cure = "remove it, or choose another output"
        raise stated(f'"{folder}"', "is there and no folder of kept results", cure)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Make the folder if it is missing and lock it, so that no other run uses it at the same time.

    Raises SceneError at once if another process has the lock. The system frees the lock of a killed process.
    """
    check(folder)
    with output.refusing(f'"{folder}"'):
        handle = _kept(folder)
    if handle is None:
        cure = "wait until that ends, or choose another output"
        raise stated(f'"{folder}"', "is in use by another run of the same work", cure)
    windows = os.name == "nt"
    try:
        yield
    finally:
        # Windows cannot remove an open file. Elsewhere the file must be removed while it is still locked.
        if windows:
            os.close(handle)
        with suppress(OSError):
            (folder / LOCK).unlink()
            folder.rmdir()
        if not windows:
            os.close(handle)


def _kept(folder: Path) -> int | None:
    """Open and lock the folder's lock file; None if another run has locked it."""
    path = folder / LOCK
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):
            handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
            try:
                _lock(handle)
                # A run that has just ended may have removed this file after it was opened.
                if os.path.samestat(os.fstat(handle), path.stat()):
                    return handle
            except (BlockingIOError, PermissionError):
                os.close(handle)
                return None
            except BaseException:
                os.close(handle)
                raise
            os.close(handle)


def _lock(handle: int) -> None:
    """Lock an open file; raises an OSError if another run has locked it."""
    if sys.platform == "win32":
        import msvcrt

        # Its errors have various numbers, and all mean that another run has the lock.
        with suppress(OSError):
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
            return
        raise BlockingIOError
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def remove(folder: Path, own: re.Pattern[str]) -> None:
    """Remove files with these names from a folder, and the folder if it is then empty.

    Does not follow links.
    """
    for file in inside(folder):
        if own.fullmatch(file.name) or temporary(own, file.name):
            with suppress(OSError):
                file.unlink()
    with suppress(OSError):
        folder.rmdir()


def temporary(own: re.Pattern[str], name: str) -> bool:
    """Return whether this is the temporary name, as made by `output.write`, of a name that matches `own`."""
    found = re.fullmatch(r"\.(.+)\.\d+\.part", name)
    return found is not None and own.fullmatch(found[1]) is not None


def inside(folder: Path) -> list[Path]:
    """Return the paths in a folder; a link or a missing folder counts as empty."""
    return [] if folder.is_symlink() or not folder.is_dir() else list(folder.iterdir())
