"""Stores the pieces of an unfinished sequence in a folder beside its file, so that a solve can be resumed."""

import json
import re
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .._midair import Moving, stated
from .._support import cache, output
from .._support.arguments import path_of, refused
from .._support.text import arrays
from . import files
from .sequence import Sequence

#: Suffix of the name of the folder.
ENDING = ".resume"

#: Name of the file, and of the array of a finished file, that identifies the request; prefix of the names of
#: arrays that store the solver's state.
REQUEST, STATE = "request", "state."

#: Names of files that this module writes.
OWN = re.compile(r"request|\d{12}\.npz")


@dataclass(frozen=True)
class Output(PathLike[str]):
    """Name of a file that may be replaced, whatever it contains, like the outputs of commands."""

    path: Path

    def __fspath__(self) -> str:
        return str(self.path)


def solved(
    path: str | PathLike[str],
    moving: Moving,
    setting: dict[str, Any],
    block: int,
    progress: Callable[[int, int], object] | None,
) -> Sequence:
    """Solve the missing frames of a sequence piece by piece, then join the pieces into the file.

    `setting` has the arguments of the solve that `moving` lacks. Returns the sequence of a file that already
    contains the result, and rejects any other file.
    """
    target = path_of("resume", path)
    output.check(target, (".npz",))
    request = _fingerprint(moving, setting, block)
    if target.exists():
        if _finished(target) == request:
            return Sequence.load(target)
        if not isinstance(path, Output):
            cure = "it does not contain the result of this request, give another file or remove it"
            raise refused("resume", target, cure)
    folder = target.with_name(target.name + ENDING)
    total = len(moving)
    with cache.locked(folder):
        pieces = Pieces(folder, request)
        done = 0
        while done < total and (piece := pieces.load(done)) is not None:
            state, done = piece[1], done + block
        if done:
            moving.restore(min(done, total), state)
        for first in range(done, total, block):
            stop = min(first + block, total)
            pieces.save(first, moving.block(first, stop), moving.state())
            if progress is not None:
                progress(stop, total)
        _assemble(target, pieces, moving, block)
        cache.remove(folder, OWN)
    return Sequence.load(target)


def _finished(target: Path) -> str:
    """Return the hash of the request whose result a file contains; "" for any other file."""
    try:
        return str(arrays(target, [REQUEST])[REQUEST])
    except (KeyError, OSError, ValueError):
        return ""


def _fingerprint(moving: Moving, setting: dict[str, Any], block: int) -> str:
    """Return a hash of all arguments on which the result depends."""
    digest = sha256()
    for values in (moving.points, moving.targets):
        digest.update(np.ascontiguousarray(values).tobytes())
    setting = {
        **setting,
        "solver": moving.solver,
        "aim": moving.aim,
        "ahead": moving.ahead,
        "closed": moving.closed,
    }
    rest = [moving.scene.json(), moving.rate, moving.change, setting, block]
    digest.update(json.dumps(rest, sort_keys=True, default=repr).encode())
    return digest.hexdigest()


class Pieces:
    """The pieces of one request in a folder: drives (frames, N), and the state from which to continue."""

    def __init__(self, folder: Path, request: str) -> None:
        self._folder = folder
        self.request = request
        path = folder / REQUEST
        with output.refusing(f'"{path}"'):
            other = path.read_bytes() if path.is_file() else b""
            # A damaged request file is ignored: each piece also identifies its request.
            if re.fullmatch(rb"[0-9a-f]{64}", other) and other != request.encode():
                cure = "remove it, or give another file"
                raise stated(f'resume folder "{folder}"', "belongs to another request", cure)
            output.write(path, request.encode())

    def save(self, first: int, drives: NDArray[Any], state: dict[str, Any]) -> None:
        """Save the piece that begins with frame `first`."""
        state = {f"{STATE}{name}": np.asarray(value) for name, value in state.items()}
        cache.save(*self._named(first), {"drives": drives, **state})

    def load(self, first: int) -> tuple[NDArray[Any], dict[str, Any]] | None:
        """Load the piece that begins with frame `first`; None if it is missing or damaged."""
        arrays = cache.load(*self._named(first))
        if arrays is None:
            return None
        drives = arrays.pop("drives")
        return drives, {name.removeprefix(STATE): value for name, value in arrays.items()}

    def _named(self, first: int) -> tuple[Path, str]:
        return self._folder / f"{first:012d}.npz", f"{self.request}/{first}"


def _assemble(target: Path, pieces: Pieces, moving: Moving, block: int) -> None:
    """Write the file as `Sequence.save` does, copying the drives piece by piece."""
    shape = (len(moving), len(moving.scene.array))
    setting = Sequence._solved(moving, np.empty((0, shape[1]), np.complex64)).setting()
    small = {
        "points": moving.points,
        "targets": moving.targets,
        "scene": moving.scene.json(),
        "setting": output.to_json(setting),
        REQUEST: pieces.request,
    }
    with files.whole(target, (".npz",)) as part, zipfile.ZipFile(part, "w", allowZip64=True) as archive:
        for name, values in small.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as stream:
                npy.write_array(stream, np.asanyarray(values), allow_pickle=False)
        with archive.open("drives.npy", "w", force_zip64=True) as stream:
            for first in range(0, shape[0], block):
                piece = pieces.load(first)
                if piece is None:
                    reported = f'of "{target}{ENDING}" was damaged meanwhile'
                    raise stated("a piece", reported, "run this again", code="unreadable")
                if first == 0:
                    descr = npy.dtype_to_descr(piece[0].dtype)
                    header = {"descr": descr, "fortran_order": False, "shape": shape}
                    npy.write_array_header_2_0(stream, header)
                stream.write(piece[0].tobytes())
