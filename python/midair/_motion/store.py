"""A sequence on its way to disk: pieces beside the file, the state after each, and the file made of them."""

from __future__ import annotations

import json
import os
import shutil
import warnings
import zipfile
from collections.abc import Callable
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .._midair import Scene, SceneError, SceneWarning
from .._support import output
from .._support.arguments import path_of
from . import files
from .horizon import Found
from .request import Request
from .sequence import Sequence

#: What the folder beside the file is called.
ENDING = ".resume"


def solved(
    path: str | PathLike[str],
    asked: Request,
    setting: dict[str, Any],
    found: Found,
    block: int,
    progress: Callable[[int, int], object] | None,
) -> Sequence:
    """Solve what is not yet there of a sequence, piece after piece, and put the file together."""
    target = path_of("resume", path)
    output.check(target, (".npz",))
    folder = target.with_name(target.name + ENDING)
    own = _fingerprint(asked, setting, block)
    total = len(asked.points)
    done = _begin(folder, own, found)
    for first in range(done, total, block):
        _keep(folder, first, found.block(slice(first, first + block)), found)
        if progress is not None:
            progress(min(first + block, total), total)
    _assemble(target, folder, asked, setting, found.board, block)
    shutil.rmtree(folder)
    return Sequence.load(target)


def _fingerprint(asked: Request, setting: dict[str, Any], block: int) -> str:
    """All that the bits of the answer depend on."""
    digest = sha256()
    for values in (asked.points, asked.targets):
        digest.update(np.ascontiguousarray(values).tobytes())
    scene = Scene(asked.array, asked.points[0], **asked.air).json()
    rest = [scene, asked.rate, asked.change, setting, block]
    digest.update(json.dumps(rest, sort_keys=True, default=repr).encode())
    return digest.hexdigest()


def _begin(folder: Path, own: str, found: Found) -> int:
    """The frames that are done already, the rest to be found from there."""
    told = folder / "request"
    if not folder.exists():
        folder.mkdir()
        output.write(told, own.encode())
        return 0
    if not told.exists() or told.read_text() != own:
        raise SceneError(
            f'resume folder "{folder}" belongs to another request: remove it, or give another file'
        )
    state = folder / "state.npz"
    if not state.exists():
        return 0
    with np.load(state, allow_pickle=False) as kept:
        done = int(kept["done"])
        found.restore(done, {name: kept[name] for name in kept.files if name != "done"})
        return done


def _keep(folder: Path, first: int, drives: NDArray[Any], found: Found) -> None:
    """Write a piece, then that it is done."""
    part = folder / "piece.part"
    with part.open("wb") as stream:
        np.save(stream, drives)
    part.replace(folder / f"{first:012d}.npy")
    with part.open("wb") as stream:
        np.savez(stream, done=first + len(drives), **found.state())
        stream.flush()
        os.fsync(stream.fileno())
    part.replace(folder / "state.npz")


def _assemble(
    target: Path,
    folder: Path,
    asked: Request,
    setting: dict[str, Any],
    board: dict[str, Any] | None,
    block: int,
) -> None:
    """The file that `Sequence.save` writes, its drives copied piece after piece."""
    pieces = [folder / f"{first:012d}.npy" for first in range(0, len(asked.points), block)]
    shape = (len(asked.points), len(asked.array))
    with warnings.catch_warnings():
        # Told of the request.
        warnings.simplefilter("ignore", SceneWarning)
        empty = Sequence(
            asked.array,
            asked.points[:2],
            np.ones(asked.targets[:2].shape),
            np.ones((2, shape[1]), np.complex64),
            rate=asked.rate,
            closed=asked.closed,
            change=asked.change,
            solver=setting["solver"],
            quantization=board,
            **asked.air,
        )
    texts = {"scene": empty.scene(0).json(), "setting": output.to_json(empty.setting())}
    with files.whole(target, (".npz",)) as part, zipfile.ZipFile(part, "w", allowZip64=True) as archive:
        small = {"points": asked.points, "targets": asked.targets}
        for name, values in {**small, **{name: np.asarray(text) for name, text in texts.items()}}.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as stream:
                npy.write_array(stream, np.asanyarray(values), allow_pickle=False)
        with archive.open("drives.npy", "w", force_zip64=True) as stream:
            descr = npy.dtype_to_descr(np.load(pieces[0], mmap_mode="r").dtype)
            header = {"descr": descr, "fortran_order": False, "shape": shape}
            npy.write_array_header_2_0(stream, header)
            for piece in pieces:
                stream.write(np.load(piece, allow_pickle=False).tobytes())
