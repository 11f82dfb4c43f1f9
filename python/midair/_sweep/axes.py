"""Axes of a sweep: lists of values for a key of the request, such as medium.temperature; each is a column."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from .._midair import SceneError
from .plain import short

Tables = dict[str, Any]

#: Tables that have axes, and their keys of which each takes one number or word: a list there is an axis too.
_SINGLE = {
    "array": ("preset", "source_pressure", "directivity", "quantization"),
    "medium": ("frequency", "sound_speed", "temperature", "absorption", "density"),
    "points": (),
}

#: Keys that say the same thing in other words: an axis of one takes the place of the others.
_INSTEAD = {
    "array": ({"grid"}, {"preset", "tiles"}, {"positions", "normals"}),
    "medium": ({"sound_speed"}, {"temperature"}),
    "points": ({"pressure"}, {"pressures"}),
}


def read_axes(tables: Tables) -> dict[str, list[Any]]:
    """Every axis by its name, in order: lists where one value is meant, then those of [axes]."""
    axes: dict[str, list[Any]] = {}
    for name, values in [*_lists(tables), *_flat(tables.get("axes", {}))]:
        root, _, key = name.partition(".")
        if root not in _SINGLE or not key:
            raise SceneError(
                f'unknown axis "{name}": give a key of array, medium or points, such as medium.temperature;'
                " options of a solver and points.count take lists where they stand"
            )
        if not isinstance(values, list) or not values:
            raise SceneError(f"axis {name} is {short(values)}: give a list of values")
        if name in axes:
            raise SceneError(f"axis {name} is given twice: leave one out")
        axes[name] = values
    return axes


def _lists(tables: Tables) -> Iterator[tuple[str, Any]]:
    for root, keys in _SINGLE.items():
        table = tables.get(root)
        for key in keys:
            if isinstance(table, Mapping) and isinstance(table.get(key), list):
                yield f"{root}.{key}", table[key]


def _flat(table: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    """Names with dots, whether they were written so or as tables within tables."""
    if not isinstance(table, Mapping):
        raise SceneError(f"axes is {short(table)}: give a table [axes] such as medium.temperature = [15, 25]")
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def put(tables: Tables, name: str, value: Any) -> Tables:
    """The tables with one key changed, and without those that say the same thing in other words."""
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
    """What the table shows of an axis: numbers and words, else JSON, else the place in the list."""
    if not any(isinstance(value, list | Mapping) for value in values):
        return values
    texts = [value if isinstance(value, str) else json.dumps(value) for value in values]
    return texts if max(map(len, texts)) <= 60 else list(range(len(values)))
