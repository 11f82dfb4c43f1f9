"""Axes of a sweep: lists of values for a key of the request, such as medium.temperature. Each is a column."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np

from .._midair import Array, Scene, array_parts, scene_keys, stated
from .._support.arguments import without_warnings


def plain(value: Any, name: str = "") -> Any:
    """Return a value as dicts, lists, finite numbers and text; scenes and paths in `scenes` do not change."""
    if isinstance(value, float) and not math.isfinite(value):
        raise stated(f"{name or 'sweep'}", f"is {float(value)}", "give a finite number")
    if isinstance(value, str):
        return _word(value, name)
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, Scene | PathLike) and name.startswith("scenes["):
        return value
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, Array):
        return array_table(value)
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), name)
    if isinstance(value, Mapping):
        return {
            _word(str(key), name): plain(inner, f"{name}.{key}" if name else str(key))
            for key, inner in value.items()
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
    return {
        key: value for key, value in table.items() if key not in same & {"source_pressure", "directivity"}
    }


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


Tables = dict[str, Any]

#: Tables that can have axes, and their keys that take a single number or word; a list there is an axis too.
_SINGLE = {
    "array": (
        "preset",
        *(name for name, kind in array_parts().items() if kind not in ("complexes", "flags", "indices")),
    ),
    "medium": tuple(scene_keys()["medium"]),
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
        raise stated(
            "axes", f"is {short(table)}", "give a table [axes] such as medium.temperature = [15, 25]"
        )
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
