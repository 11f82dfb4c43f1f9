"""Files of a sequence (.npz): written completely or not at all, and read without executing anything."""

import json
import os
import shutil
import struct
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .._midair import Array, Scene, drive_to_csv
from .._support import output
from .._support.arguments import path_of
from .._support.text import arrays
from .drives import Stored

#: Drives of at least this many bytes are read from the file block by block instead of at once.
LARGE = 1 << 28

#: Arrays that a file must contain.
KEYS = ("points", "targets", "drives", "scene", "setting")


@contextmanager
def whole(path: str | PathLike[str], endings: tuple[str, ...]) -> Iterator[Path]:
    """Yield a temporary file. It replaces `path` if no error occurs; otherwise it is removed."""
    requested = path_of("path", path)
    output.check(requested, endings)
    target = output.real(requested)
    # The file is in a temporary folder, so that it can have the ending of `path`, which tells programs the
    # format.
    folder = output.part_of(target)
    try:
        with output.refusing(f'output "{path}"', "make room or choose another folder"):
            folder.mkdir()
            part = folder / f"part{requested.suffix.lower()}"
            yield part
            output.put(part, target)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def save(path: str | PathLike[str], arrays: dict[str, Any], scene: Scene, setting: dict[str, Any]) -> None:
    """Write arrays; array, air and obstacles as the JSON text of a scene; and the settings as JSON."""
    with whole(path, (".npz",)) as part:
        np.savez(part, **arrays, scene=scene.json(), setting=output.to_json(setting))


def write_csv(path: Path, array: Array | None, drives: Iterable[NDArray[Any]], frames: int) -> None:
    """Write a row frame,index,x,y,z,amplitude,phase per transducer of each frame.

    A single frame has no column frame, an unknown array no x, y and z.
    """
    places = None if array is None else array.positions
    with path.open("w", encoding="utf-8") as stream:
        for frame, drive in enumerate(drives):
            rows = drive_to_csv(drive, places).splitlines(keepends=True)
            for k, row in enumerate(rows[frame > 0 :], frame > 0):
                stream.write(f"{frame if k else 'frame'},{row}" if frames > 1 else row)


def _stored(path: str | PathLike[str]) -> Stored | None:
    """Return the drives of a large uncompressed file, to be read block by block; None for other files."""
    with zipfile.ZipFile(path) as archive:
        entry = archive.getinfo("drives.npy")
    if entry.compress_type != zipfile.ZIP_STORED or entry.file_size < LARGE:
        return None
    with open(path, "rb") as stream:
        # A local header of zip: after 26 bytes follow the lengths of the name and of the extra field.
        stream.seek(entry.header_offset + 26)
        stream.seek(sum(struct.unpack("<HH", stream.read(4))), os.SEEK_CUR)
        version = npy.read_magic(stream)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read(stream)
        if fortran or dtype.hasobject:
            return None
        return Stored(path, dtype, shape, stream.tell()) if len(shape) == 2 else None


def load(path: str | PathLike[str]) -> dict[str, Any]:
    """Return the arguments of `Sequence` that a file contains. They are not checked here."""
    kept: dict[str, Any] = arrays(path, [key for key in KEYS if key != "drives"])
    stored = _stored(path)
    kept["drives"] = arrays(path, ["drives"])["drives"] if stored is None else stored
    scene: Scene = Scene.parse(str(kept.pop("scene")))
    setting = dict(json.loads(str(kept.pop("setting"))))
    around = {name: getattr(scene, name) for name in ("array", "obstacles", "signature", "bead")}
    return {**around, **kept, **setting}
