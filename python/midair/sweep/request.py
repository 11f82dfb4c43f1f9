"""The sweep file, read and checked before anything is solved: blocks of problems in the table's order."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .._midair import Array, Scene, SceneError, solve, solvers
from .block import Settings, count_of

#: More problems than this are a slip of the pen.
MOST = 10**9

_KEYS = ("seed", "seeds", "scenes", "array", "medium", "points", "solver")
_POINTS = ("count", "x", "y", "z", "pressure")


@dataclass(frozen=True)
class Block:
    """Problems that differ only in their trial; `columns` are what its rows of the table have in common."""

    settings: Settings
    columns: Mapping[str, Any]
    trials: int


@dataclass(frozen=True)
class Request:
    """The blocks in order, and the names of the columns that are the same within each."""

    blocks: Sequence[Block]
    names: tuple[str, ...]

    @property
    def problems(self) -> int:
        """How many rows the table has."""
        return sum(block.trials for block in self.blocks)


def read(source: str | PathLike[str] | Mapping[str, Any], *, drives: bool = False) -> Request:
    """A sweep file, TOML or JSON by its ending, or a mapping of the same keys.

    Paths of scenes are relative to the file's folder. Raises SceneError for whatever is not in order.
    """
    if isinstance(source, Mapping):
        tables, folder = dict(source), Path()
    else:
        tables, folder = _parse(Path(source)), Path(source).parent
    _known(tables, _KEYS, "sweep")
    seed = _whole(tables.get("seed", 0), "seed")
    trials, seeds = _trials(tables.get("seeds", 1))
    methods = [method for table in _tables(tables, "solver") for method in _methods(table)]
    if not methods:
        raise SceneError("solver is missing: give one or more [[solver]] with a name")
    sets = _scenes(tables, folder) if "scenes" in tables else _arrays_and_points(tables)
    if len(sets) * len(methods) * trials > MOST:
        raise SceneError(
            f"the sweep has {len(sets)} x {len(methods)} x {trials} problems: at most 10^9, shorten an axis"
        )
    options = list(dict.fromkeys(key for _, chosen in methods for key in chosen))
    for name, chosen in methods:
        _check_method(name, chosen)
    common = {"seed": seed, "seeds": seeds, "drives": drives}
    blocks = [
        Block(
            {**settings, **common, "solver": name, "options": chosen},
            {**columns, "solver": name, **{key: chosen.get(key) for key in options}},
            trials,
        )
        for (settings, columns), (name, chosen) in product(sets, methods)
    ]
    return Request(blocks, (*sets[0][1], "solver", *options))


def _parse(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        tables = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    except ValueError as error:
        raise SceneError(f'sweep file "{path}" cannot be read: {error}') from error
    if not isinstance(tables, dict):
        raise SceneError(f'sweep file "{path}" holds no tables')
    return tables


def _known(table: Mapping[str, Any], keys: Sequence[str], where: str) -> None:
    for key in table:
        if key not in keys:
            raise SceneError(f'unknown key of {where} "{key}": known are {", ".join(keys)}')


def _tables(tables: Mapping[str, Any], key: str) -> list[dict[str, Any]]:
    """One table or a list of them."""
    found = tables.get(key, [])
    found = [found] if isinstance(found, Mapping) else found
    if not isinstance(found, Sequence) or not all(isinstance(table, Mapping) for table in found):
        raise SceneError(f"{key} is {_short(found)}: give a table [{key}] or several [[{key}]]")
    return [dict(table) for table in found]


def _trials(given: Any) -> tuple[int, list[int] | None]:
    """How many trials, and their seeds where they are listed."""
    if isinstance(given, Sequence) and not isinstance(given, str):
        if not given:
            raise SceneError("seeds is empty: give a count or a list of seeds")
        return len(given), [_whole(seed, f"seeds[{index}]") for index, seed in enumerate(given)]
    return _whole(given, "seeds", least=1), None


def _whole(value: Any, name: str, *, least: int = 0) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not least <= value < 2**63:
        raise SceneError(f"{name} is {_short(value)}: give a whole number, {least} or above")
    return int(value)


def _short(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


def _methods(table: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """A solver's table; a list for an option is an axis."""
    name = table.pop("name", None)
    if name not in solvers():
        raise SceneError(f"unknown solver {_short(name)}: known are {', '.join(solvers())}")
    axes = []
    for key, value in table.items():
        values = value if isinstance(value, list | tuple) else [value]
        if not values:
            raise SceneError(f"option {key} of {name} is an empty list: give a value or some")
        axes.append(values)
    return [(name, dict(zip(table, chosen, strict=True))) for chosen in product(*axes)]


def _check_method(name: str, options: Mapping[str, Any]) -> None:
    """Let the solver itself refuse an option, on a scene of no effort."""
    order = options.get("order")
    if not isinstance(order, list | tuple):
        array = Array.grid(2, 2, 0.01)
        solve(Scene(array, [[0.0, 0.0, 0.1]]), name, **options)


Sets = list[tuple[dict[str, Any], dict[str, Any]]]


def _arrays_and_points(tables: Mapping[str, Any]) -> Sets:
    """Settings and columns of each array with each number of random points."""
    arrays, medium, table = _tables(tables, "array"), tables.get("medium", {}), tables.get("points")
    if not arrays:
        raise SceneError("array is missing: give [array] as in a scene file, or scenes")
    if not isinstance(table, Mapping):
        raise SceneError("points is missing: give [points] with count, x, y and z, or scenes")
    _known(table, _POINTS, "points")
    counts = table.get("count")
    counts = counts if isinstance(counts, list | tuple) else [counts]
    if not counts:
        raise SceneError("points.count is an empty list: give a number of points or some")
    region = [_range(table, key) for key in "xyz"]
    pressure = _range(table, "pressure") if "pressure" in table else None
    sets: Sets = []
    for index, array in enumerate(arrays):
        transducers = _count(array, medium, index)
        for count in counts:
            settings = {
                "array": array,
                "medium": medium,
                "count": _whole(count, "points.count", least=1),
                "region": region,
                "pressure": pressure,
            }
            sets.append((settings, {"array": index, "transducers": transducers, "points": count}))
    return sets


def _range(table: Mapping[str, Any], key: str) -> list[float]:
    """A number, or the two ends of what it is drawn from."""
    value: Any = table.get(key)
    ends: list[Any] = list(value) if isinstance(value, list | tuple) else [value, value]
    real = all(isinstance(end, int | float) and not isinstance(end, bool) for end in ends)
    if len(ends) != 2 or not real or not all(map(math.isfinite, ends)) or ends[0] > ends[1]:
        raise SceneError(f"points.{key} is {_short(value)}: give a number or [low, high]")
    return [float(end) for end in ends]


def _count(array: Mapping[str, Any], medium: Mapping[str, Any], index: int) -> int:
    try:
        return count_of(array, medium)
    except (SceneError, TypeError) as error:
        reason = str(error).removeprefix("scene file, line 1: ")
        raise SceneError(f"array {index} or medium of the sweep: {reason}") from error


def _scenes(tables: Mapping[str, Any], folder: Path) -> Sets:
    """Settings and columns of each scene file; its own solver is not asked for."""
    for key in ("array", "medium", "points"):
        if key in tables:
            raise SceneError(f"{key} is given beside scenes: a scene file has its own")
    scenes = tables["scenes"]
    if not isinstance(scenes, list | tuple) or not all(isinstance(scene, str | PathLike) for scene in scenes):
        raise SceneError(f"scenes is {_short(scenes)}: give a list of scene files")
    if not scenes:
        raise SceneError("scenes is empty: give a list of scene files")
    sets: Sets = []
    for name in scenes:
        scene = Scene.load(folder / name)
        tables = json.loads(scene.json())
        settings = {
            "array": tables["array"],
            "medium": tables["medium"],
            "count": len(scene.points),
            "points": scene.points.tolist(),
            "pressures": None if scene.pressures is None else scene.pressures.tolist(),
            "weights": None if scene.weights is None else scene.weights.tolist(),
        }
        columns = {"scene": str(name), "transducers": len(scene.array), "points": len(scene.points)}
        sets.append((settings, columns))
    return sets
