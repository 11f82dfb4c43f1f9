"""Expands arrays, medium, points and scenes of a sweep along its axes: settings and columns of each block."""

import json
import math
import re
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .. import _midair
from .._midair import Array, Scene, SceneError, memory_limit, restated, stated, sweep_keys, unknown_name
from .._support.arguments import warn, without_warnings
from .block import array_and_medium, first_scene, trial_seed

Tables = dict[str, Any]

#: The key of a solver, which may be a function.
METHOD = re.compile(r"solver(\[\d+\])?\.name")


def plain(value: Any, name: str = "") -> Any:
    """Return a value as dicts, lists, finite numbers, text; scenes, paths and functions stay as they are."""
    if isinstance(value, float) and not math.isfinite(value):
        raise stated(f"{name or 'sweep'}", f"is {float(value)}", "give a finite number")
    if isinstance(value, str):
        return _word(value, name)
    if value is None or isinstance(value, bool | int | float):
        return value
    if (isinstance(value, Scene | PathLike) and name.startswith("scenes[")) or (
        callable(value) and METHOD.fullmatch(name)
    ):
        return value
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, Array):
        return array_table(value)
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), name)
    if isinstance(value, Mapping):
        return {
            _word(str(key), name): plain(inner, f"{name}.{key}" if name else str(key)) for key, inner in value.items()
        }
    if isinstance(value, Sequence):
        return [plain(inner, f"{name}[{index}]") for index, inner in enumerate(value)]
    cure = "give numbers, words, lists and tables as a sweep file has them"
    raise stated(f"{name or 'sweep'}", f"is {short(value)}", cure)


def _word(text: str, name: str) -> str:
    if not text.isprintable():
        raise stated(f"{name or 'sweep'}", f"has {short(text)}", "give words that can be printed")
    return text


def array_table(array: Array) -> dict[str, Any]:
    """Return the table of an array, as in a scene file."""
    table = _full_table(array)
    # Values that a preset sets itself are left out, so that an axis with other presets uses their own values.
    usual = Array.preset(table["preset"]) if "preset" in table else Array.grid(1, 1, 0.01)
    same = {key for key, value in _full_table(usual).items() if table.get(key) == value}
    dropped = same & {"source_pressure", "directivity"}
    return {key: value for key, value in table.items() if key not in dropped}


def _full_table(array: Array) -> dict[str, Any]:
    with without_warnings():
        scene = Scene(array, array.positions[:1] + 0.1 * array.normals[:1])
    table: dict[str, Any] = json.loads(scene.json())["array"]
    return table


def short(value: Any) -> str:
    """Return a value as text for an error, in one line."""
    try:
        text = " ".join(repr(value).split())
    except RecursionError:
        text = "nested too deep"
    return text if len(text) <= 60 else f"{text[:57]}..."


#: Tables that can have axes, and their keys that take a single number or word; a list there is an axis too.
_SINGLE = {
    "array": (
        "preset",
        *(name for name, kind in _midair.array_parts().items() if kind not in ("complexes", "flags", "indices")),
    ),
    "medium": tuple(_midair.scene_keys()["medium"]),
    "points": (),
}

#: Keys that are alternatives: an axis of one of them replaces the others in the request.
_INSTEAD = {
    "array": ({"grid"}, {"preset", "tiles"}, {"positions", "normals"}),
    "medium": ({"sound_speed"}, {"temperature"}),
    "points": ({"pressure"}, {"pressures"}),
}


def read_axes(tables: Tables) -> dict[str, list[Any]]:
    """Return every axis by its name, in order: lists in place of single values, then those of [axes]."""
    axes: dict[str, list[Any]] = {}
    for name, values in [*_lists(tables), *_flat(tables.get("axes", {}))]:
        root, _, key = name.partition(".")
        if root not in _SINGLE or not key:
            lists = "options of a solver and points.count take lists where they stand"
            cure = f"give a key of array, medium or points, such as medium.temperature; {lists}"
            raise stated("", f'unknown axis "{name}"', cure)
        if not isinstance(values, list) or not values:
            raise stated(f"axis {name}", f"is {short(values)}", "give a list of values")
        if name in axes:
            raise stated(f"axis {name}", "is given twice", "leave one out", code="conflict")
        axes[name] = values
    return axes


def _lists(tables: Tables) -> Iterator[tuple[str, Any]]:
    for root, keys in _SINGLE.items():
        table = tables.get(root)
        for key in keys:
            if isinstance(table, Mapping) and isinstance(table.get(key), list):
                yield f"{root}.{key}", table[key]


def _flat(table: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield (name, values) of each axis. Names have dots, even if the file has nested tables instead."""
    if not isinstance(table, Mapping):
        cure = "give a table [axes] such as medium.temperature = [15, 25]"
        raise stated("axes", f"is {short(table)}", cure)
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def put(tables: Tables, name: str, value: Any) -> Tables:
    """Return the tables with one key changed, and without the alternative keys (`_INSTEAD`)."""
    root, key, *inner = name.split(".")
    mine = next((group for group in _INSTEAD[root] if key in group), None)
    gone = set() if mine is None else set().union(*_INSTEAD[root]) - mine
    table = {other: kept for other, kept in tables[root].items() if other not in gone}
    return {**tables, root: _within(table, [key, *inner], value)}


def _within(table: Any, path: list[str], value: Any) -> Any:
    if not path:
        return value
    kept = table if isinstance(table, Mapping) else {}
    return {**kept, path[0]: _within(kept.get(path[0]), path[1:], value)}


def column(values: list[Any]) -> list[Any]:
    """Return an axis's values for the table: numbers and words, else JSON, else their indices."""
    if not any(isinstance(value, list | Mapping) for value in values):
        return values
    texts = [value if isinstance(value, str) else json.dumps(value) for value in values]
    return texts if max(map(len, texts)) <= 60 else list(range(len(values)))


#: For each block its settings without the solver, and the cells that its rows have in common.
Sets = list[tuple[dict[str, Any], dict[str, Any]]]

#: A sweep with more combinations of axes is rejected as a mistake.
MOST_BLOCKS = 10**6

#: Bytes of memory per random point and its target while they are drawn.
POINT = 64

#: Largest number of different warnings that are emitted before the work starts.
MOST_REPORTED = 3

_FIXED = ("positions", "pressures", "weights")
_RANDOM = ("count", "x", "y", "z")


def known(table: Mapping[str, Any], keys: Collection[str], where: str) -> None:
    """Raise SceneError if a table has a key that is not in `keys`."""
    for key in table:
        if key not in keys:
            raise unknown_name(f"key of {where}", str(key), list(keys))


def few(blocks: int) -> None:
    """Raise SceneError for too many blocks, before they are made."""
    if blocks > MOST_BLOCKS:
        raise stated("the sweep", f"has {blocks} combinations of its axes", "at most 10^6, shorten an axis")


def table_of(tables: Tables, key: str) -> Tables:
    """Return a table of the request, empty if it is missing."""
    table = tables.get(key, {})
    if not isinstance(table, Mapping):
        raise stated(key, f"is {short(table)}", f"give a table [{key}]")
    return dict(table)


def tables_of(tables: Tables, key: str) -> list[Tables]:
    """Return one table or several as a list."""
    found = tables.get(key, [])
    found = [found] if isinstance(found, Mapping) else found
    if not isinstance(found, list) or not all(isinstance(table, Mapping) for table in found):
        raise stated(key, f"is {short(found)}", f"give a table [{key}] or several [[{key}]]")
    return [dict(table) for table in found]


def whole(value: Any, name: str, *, least: int = 0) -> int:
    """Check a whole number and return it."""
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value < 2**63:
        raise stated(name, f"is {short(value)}", f"give a whole number, {least} or above")
    return value


def read_sets(
    tables: Tables, axes: Mapping[str, list[Any]], folder: Path, common: Mapping[str, Any]
) -> tuple[Sets, list[Path]]:
    """Return settings and columns for each array or scene along all axes, and the files that were read.

    Parameters
    ----------
    common
        Settings that all blocks have: seed, seeds and drives.
    """
    with warnings.catch_warnings(record=True) as reported:
        warnings.simplefilter("always")
        bases, files = _scenes(tables, folder) if "scenes" in tables else (_arrays(tables), [])
        few(math.prod([len(bases), *map(len, axes.values())]))
        shown = {name: column(values) for name, values in axes.items()}
        sets: Sets = []
        ways = list(product(*(range(len(axis)) for axis in axes.values())))
        for (where, base, columns), places in product(bases, ways):
            changed = base
            for (name, values), place in zip(axes.items(), places, strict=True):
                changed = put(changed, name, values[place])
            own = {name: column[place] for (name, column), place in zip(shown.items(), places, strict=True)}
            at = "".join(f", {name} = {short(value)}" for name, value in own.items())
            changed, read = _with_positions(changed, folder)
            files += read
            settings, transducers = _settings(changed, common, where, at)
            counts = {"transducers": transducers, "points": settings["count"]}
            sets.append((settings, {**columns, **counts, **own}))
    warned = (one for one in reported if issubclass(one.category, _midair.SceneWarning))
    texts = dict.fromkeys(str(one.message) for one in warned)
    for text in list(texts)[:MOST_REPORTED]:
        warn(text)
    return sets, list(dict.fromkeys(files))


Base = tuple[str, Tables, dict[str, Any]]


def _arrays(tables: Tables) -> list[Base]:
    """Return (words for errors, tables, columns) for each array with each number of points."""
    arrays, medium = tables_of(tables, "array"), table_of(tables, "medium")
    if not arrays:
        raise stated("array", "is missing", "give [array] as in a scene file, or scenes", code="missing")
    given = tables.get("points")
    if isinstance(given, list):
        given = _listed(given)
    if not isinstance(given, Mapping):
        cure = "give [points] with count, x, y and z, or scenes"
        raise stated("points", "is missing", cure, code="missing")
    counts = given.get("count")
    if counts == []:
        raise stated("points.count", "is an empty list", "give a number of points or some")
    several = [{**given, "count": count} for count in counts] if isinstance(counts, list) else [given]
    return [
        (f"array {index}", {"array": array, "medium": medium, "points": points}, {"array": index})
        for index, array in enumerate(arrays)
        for points in several
    ]


def _listed(points: list[Any]) -> Tables:
    """Return the fixed points of [[points]], as in a scene file."""
    for index, point in enumerate(points):
        if not isinstance(point, Mapping) or "position" not in point:
            raise stated(f"points[{index}]", f"is {short(point)}", "give a table with a position = [x, y, z]")
        known(point, ("position", "pressure", "weight"), f"points[{index}]")
    table: Tables = {"positions": [point["position"] for point in points]}
    given = [point["pressure"] for point in points if "pressure" in point]
    if given and len(given) < len(points):
        cure = "give it to every point, or none"
        raise stated("points:", f"{len(given)} of {len(points)} have a pressure", cure)
    if given:
        table["pressures"] = given
    if any("weight" in point for point in points):
        table["weights"] = [point.get("weight", 1.0) for point in points]
    return table


def _scenes(tables: Tables, folder: Path) -> tuple[list[Base], list[Path]]:
    """Return the base of each scene, and the scenes' files. A scene's own solver is ignored."""
    for key in ("array", "medium", "points"):
        if key in tables:
            raise stated(key, "is given beside scenes", "a scene has its own", code="conflict")
    scenes = tables["scenes"]
    if not isinstance(scenes, list) or not all(isinstance(one, str | PathLike | Scene) for one in scenes):
        raise stated("scenes", f"is {short(scenes)}", "give a list of scene files, or of midair.Scene")
    if not scenes:
        raise stated("scenes", "is empty", "give a list of scene files", code="missing")
    bases: list[Base] = []
    files: list[Path] = []
    for index, one in enumerate(scenes):
        name: int | str = index
        if isinstance(one, Scene):
            scene = one
        else:
            files += _midair.scene_files(folder / one)
            scene, name = Scene.load(folder / one), str(one)
        own = json.loads(scene.json())
        if "obstacles" in own:
            words = f"{name} has obstacles, which sweeps do not take"
            raise stated("scenes:", words, "leave them out, or solve it by midair.solve")
        base = {"array": array_table(scene.array), "medium": own["medium"], "points": _listed(own["points"])}
        bases.append((f"scene {name}", base, {"scene": name}))
    return bases, files


def _settings(tables: Tables, common: Mapping[str, Any], where: str, at: str) -> tuple[dict[str, Any], int]:
    """Return the settings of a block without its solver, and the number of transducers."""
    points = table_of(tables, "points")
    known(points, sweep_keys()["points"], "points")
    shift = points.get("shift", [0.0, 0.0, 0.0])
    if not _numbers(shift, 3):
        raise stated("points.shift", f"is {short(shift)}", "give three numbers, in metres")
    settings = {**common, "array": tables["array"], "medium": tables["medium"]}
    settings |= _fixed(points, shift) if "positions" in points else _random(points, shift)
    if "pressure" in points:
        if "pressures" in points:
            raise stated("points.pressure", "is given beside pressures", "leave one out", code="conflict")
        settings["pressure"] = _range(points, "pressure")
    try:
        array, _ = array_and_medium(settings)
    except SceneError as error:
        raise restated(error, place=f"{where} or medium of the sweep{at}") from error
    try:
        first_scene(settings)
    except SceneError as error:
        raise restated(error, inside=f"{where}{at}, seed {trial_seed(settings, 0)}") from error
    return settings, len(array)


def _with_positions(tables: Tables, folder: Path) -> tuple[Tables, list[Path]]:
    """Return the tables with the positions from an array's file inserted, and that file."""
    array = tables["array"]
    if not isinstance(array, Mapping) or not isinstance(array.get("positions"), Mapping):
        return tables, []
    named = {key: array[key] for key in ("positions", "normals") if key in array}
    read = _array_of(json.dumps({"array": named, "points": [{"position": [0.0, 0.0, 1.0]}]}), folder)
    own = {"positions": read.positions.tolist(), "normals": read.normals.tolist()}
    return {**tables, "array": {**array, **own}}, [folder / array["positions"]["file"]]


@lru_cache(maxsize=16)
def _array_of(text: str, folder: Path) -> Array:
    return Scene.parse(text, name="sweep", folder=folder).array


def _fixed(points: Tables, shift: list[float]) -> dict[str, Any]:
    for key in _RANDOM:
        if key in points:
            cure = "leave it out; shift moves all points"
            raise stated(f"points.{key}", "is given beside positions", cure, code="conflict")
    positions = points["positions"]
    if not isinstance(positions, list) or not positions or not all(_numbers(place, 3) for place in positions):
        raise stated("points.positions", f"is {short(positions)}", "give a list of [x, y, z], in metres")
    for key in ("pressures", "weights"):
        if key in points and not _numbers(points[key], len(positions)):
            cure = f"give {len(positions)} numbers, one a point"
            raise stated(f"points.{key}", f"is {short(points[key])}", cure)
    return {
        "count": len(positions),
        "points": [[x + dx for x, dx in zip(place, shift, strict=True)] for place in positions],
        "pressures": points.get("pressures"),
        "weights": points.get("weights"),
    }


def _random(points: Tables, shift: list[float]) -> dict[str, Any]:
    for key in _FIXED:
        if key in points:
            cure = "it goes with fixed points"
            raise stated(f"points.{key}", "is given without positions", cure, code="conflict")
    region = [[end + by for end in _range(points, key)] for key, by in zip("xyz", shift, strict=True)]
    count = whole(points.get("count"), "points.count", least=1)
    if count * POINT > memory_limit():
        most = memory_limit() // POINT
        raise stated("points.count", f"is {count}", f"give at most {most} points, or raise MIDAIR_MEMORY")
    return {"count": count, "region": region}


def _numbers(value: Any, count: int) -> bool:
    return isinstance(value, list) and len(value) == count and all(map(_number, value))


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _range(points: Tables, key: str) -> list[float]:
    """Return a number, or the two ends of a random range, as [low, high]."""
    value: Any = points.get(key)
    ends: list[Any] = value if isinstance(value, list) else [value, value]
    if not _numbers(ends, 2) or ends[0] > ends[1]:
        cure = f"several go into an axis, points.{key} = [...] in [axes]" if isinstance(value, list) else ""
        raise stated(f"points.{key}", f"is {short(value)}", f"give a number or [low, high]{cure and '; '}{cure}")
    return [float(end) for end in ends]
