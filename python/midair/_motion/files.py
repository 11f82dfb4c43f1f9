"""Files of a sequence: .npz, written whole or not at all, and read again without running anything."""

from __future__ import annotations

import json
import os
import shutil
import struct
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from .._midair import Scene, SceneError
from .._support import output
from .._support.arguments import path_of
from .._support.text import arrays
from .drives import Stored

#: Drives of this many bytes are read where they lie, a block at a time.
LARGE = 1 << 28

#: The arrays that a file must have.
KEYS = ("points", "targets", "drives", "scene", "setting")


@contextmanager
def whole(path: str | PathLike[str], endings: tuple[str, ...]) -> Iterator[Path]:
    """A file that becomes `path` if all goes well, and is removed otherwise."""
    requested = path_of("path", path)
    output.check(requested, endings)
    target = output.real(requested)
    # It is a folder, because the ending tells programs how to write.
    folder = output.part_of(target)
    try:
        folder.mkdir()
        part = folder / f"part{requested.suffix.lower()}"
        yield part
        output.put(part, target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise SceneError(
            f'output "{path}" cannot be written ({reason}): make room or choose another folder'
        ) from error
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def save(path: str | PathLike[str], arrays: dict[str, Any], scene: Scene, setting: dict[str, Any]) -> None:
    """Write arrays, the array, air and obstacles as the JSON text of a scene, and the rest as JSON."""
    with whole(path, (".npz",)) as part:
        np.savez(part, **arrays, scene=scene.json(), setting=output.to_json(setting))


def _stored(path: str | PathLike[str]) -> Stored | None:
    """Drives where they lie in a large file that was not compressed; None otherwise."""
    with zipfile.ZipFile(path) as archive:
        entry = archive.getinfo("drives.npy")
    if entry.compress_type != zipfile.ZIP_STORED or entry.file_size < LARGE:
        return None
    with open(path, "rb") as stream:
        # The local header: 26 bytes, then the lengths of the name and of the extra field.
        stream.seek(entry.header_offset + 26)
        stream.seek(sum(struct.unpack("<HH", stream.read(4))), os.SEEK_CUR)
        version = npy.read_magic(stream)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read(stream)
        if fortran or dtype.hasobject:
            return None
        return Stored(path, dtype, shape, stream.tell()) if len(shape) == 2 else None


def load(path: str | PathLike[str]) -> dict[str, Any]:
    """The arguments of the sequence that a file holds, not checked."""
    kept: dict[str, Any] = arrays(path, [key for key in KEYS if key != "drives"])
    stored = _stored(path)
    kept["drives"] = arrays(path, ["drives"])["drives"] if stored is None else stored
    scene: Scene = Scene.parse(str(kept.pop("scene")))
    setting = dict(json.loads(str(kept.pop("setting"))))
    return {
        "array": scene.array,
        "obstacles": scene.obstacles,
        "signature": scene.signature,
        "bead": scene.bead,
        **kept,
        **setting,
    }
