"""Files of a sequence: .npz, written whole or not at all, and read again without running anything."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .. import output
from .._midair import Scene, SceneError

#: What a file has to hold.
KEYS = ("points", "targets", "drives", "scene", "setting")


@contextmanager
def whole(path: str | PathLike[str], endings: tuple[str, ...]) -> Iterator[Path]:
    """A file that becomes `path` if all goes well, and is removed otherwise."""
    asked = Path(path)
    output.check(asked, endings)
    target = output.real(asked)
    # A folder, because the ending tells programs what to write.
    folder = output.part_of(target)
    try:
        folder.mkdir()
        part = folder / f"part{asked.suffix.lower()}"
        yield part
        if target.exists():
            part.chmod(target.stat().st_mode & 0o7777)
        part.replace(target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise SceneError(
            f'output "{path}" cannot be written ({reason}): make room or choose another folder'
        ) from error
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def save(path: str | PathLike[str], arrays: dict[str, Any], scene: Scene, setting: dict[str, Any]) -> None:
    """Write arrays, the array and air as the JSON text of a scene, and what else there is as JSON."""
    with whole(path, (".npz",)) as part:
        np.savez(part, **arrays, scene=scene.json(), setting=output.to_json(setting))


def load(path: str | PathLike[str]) -> dict[str, Any]:
    """The arguments of the sequence that a file holds, not checked."""
    with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as file:
        arrays = {key: file[key] for key in KEYS}
    scene: Scene = Scene.parse(str(arrays.pop("scene")))
    setting = dict(json.loads(str(arrays.pop("setting"))))
    return {"array": scene.array, **arrays, **setting}
