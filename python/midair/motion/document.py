"""Scene files of what moves: the table [motion] and its paths, beside array, medium and solver."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import path as paths
from .._midair import Array, Scene, SceneError
from ..drawing import called
from ..path import Path as Moving
from ..shape.arguments import existing, refused, word

#: What a path of a file may be.
KINDS: dict[str, Callable[..., Moving]] = {
    "circle": paths.circle,
    "line": paths.line,
    "polyline": paths.polyline,
    "lissajous": paths.lissajous,
    "svg": paths.svg,
    "morph": paths.morph,
}

#: What [motion] may say beside its paths, as `midair.sequence` takes it.
SETTINGS = ("rate", "change", "change_rate", "tau", "closed", "ahead")


@dataclass(frozen=True)
class Document:
    """What `midair.sequence` is called with."""

    array: Array
    path: Moving | NDArray[np.float64]
    air: dict[str, Any]
    settings: dict[str, Any]
    solver: str
    options: dict[str, Any]


def moves(file: Path) -> bool:
    """Whether a scene file has the table [motion]; one that cannot be read has not."""
    try:
        given = _parsed(file)
    except (OSError, ValueError):
        return False
    return isinstance(given, dict) and "motion" in given


def _parsed(file: Path) -> Any:
    text = file.read_text(encoding="utf-8")
    return json.loads(text) if file.suffix.lower() == ".json" else tomllib.loads(text)


def read(file: Path) -> Document:
    """The sequence that a scene file asks for. Its errors name the file."""
    try:
        return _read(existing("path", file, "give a .toml or .json file"), file.parent)
    except (tomllib.TOMLDecodeError, json.JSONDecodeError, UnicodeDecodeError) as error:
        raise SceneError(f'scene file "{file}": {" ".join(str(error).split())}') from error
    except SceneError as error:
        raise SceneError(f'scene file "{file}": {error}') from error


def _read(file: Path, folder: Path) -> Document:
    given = _parsed(file)
    motion = given.pop("motion", None) if isinstance(given, dict) else None
    if not isinstance(motion, dict):
        raise SceneError("[motion] is left out: it says what moves, as docs/motion.md shows")
    for name in ("points", "shape", "image"):
        if name in given:
            raise SceneError(f"{name} is given: points that move stand in [motion], leave it out")
    if "path" in motion and "file" in motion:
        raise refused("motion.file", motion["file"], "[[motion.path]] is given, too: give one of them")
    moving = (
        _points(motion.pop("file"), folder) if "file" in motion else _paths(motion.pop("path", []), folder)
    )
    for name in motion:
        if name not in SETTINGS:
            known = ", ".join((*SETTINGS, "path", "file"))
            raise refused(f"motion.{name}", motion[name], f"[motion] has {known}, leave it out")
    if "rate" not in motion:
        raise SceneError("motion.rate is left out: give frames a second, such as rate = 10e3")
    first = moving.at([0.0])[0] if isinstance(moving, Moving) else moving[0]
    points = [{"position": list(point)} for point in np.asarray(first).tolist()]
    scene: Scene = Scene.parse(json.dumps({**given, "points": points}), name=file.name, folder=folder)
    names = ("frequency", "sound_speed", "absorption", "density", "obstacles")
    air = {name: getattr(scene, name) for name in names}
    solver, options = scene.solver or ("glide", {})
    return Document(scene.array, moving, air, motion, solver, dict(options))


def _points(name: Any, folder: Path) -> NDArray[np.float64]:
    """Points (T, M, 3) in m of a .npy file, or of a .csv file with the columns frame, point, x, y, z."""
    file = existing("motion.file", folder / word("motion.file", name), "give a .npy or .csv file")
    try:
        if file.suffix.lower() == ".npy":
            found: NDArray[np.float64] = np.load(file, allow_pickle=False)
            return found
        rows = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2)
        frames, count = int(rows[:, 0].max()) + 1, int(rows[:, 1].max()) + 1
        points = np.full((frames, count, 3), np.nan)
        points[rows[:, 0].astype(int), rows[:, 1].astype(int)] = rows[:, 2:5]
        return points
    except (ValueError, IndexError, EOFError, OSError) as error:
        cure = "give points (T, M, 3) as .npy, or .csv with the columns frame, point, x, y, z"
        raise refused("motion.file", file, cure) from error


def _paths(tables: Any, folder: Path) -> Moving:
    """All paths of a document at the same time."""
    if not isinstance(tables, list) or not tables:
        raise SceneError("motion.path is left out: give [[motion.path]] tables, each with a kind, or a file")
    return reduce(lambda one, other: one & other, [_path(k, table, folder) for k, table in enumerate(tables)])


def _path(index: int, table: Any, folder: Path) -> Moving:
    try:
        if not isinstance(table, dict) or "kind" not in table:
            raise SceneError(f"kind is left out: give one of {', '.join(KINDS)}")
        kind = word("kind", table.pop("kind"))
        if kind not in KINDS:
            raise refused("kind", kind, f"give one of {', '.join(KINDS)}")
        modulation = table.pop("am", None)
        if "pressure" in table:
            table["pressures"] = table.pop("pressure")
        path: Moving = called(KINDS[kind], kind, table, folder)
        if modulation is not None and not isinstance(modulation, dict):
            raise refused("am", modulation, 'give am = { frequency = 200, shape = "sqrt" }')
        return path if modulation is None else called(path.with_am, "am", modulation, folder)
    except SceneError as error:
        raise SceneError(f"motion.path[{index}]: {error}") from error
