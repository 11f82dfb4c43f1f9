"""Requests from Python as what JSON can hold: NumPy's values, tuples, and midair.Array as its table."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np

from .._midair import Array, Scene, SceneError, SceneWarning


def plain(value: Any, name: str = "") -> Any:
    """The same value in dicts, lists, finite numbers and words; scenes and paths among `scenes` stay."""
    if isinstance(value, float) and not math.isfinite(value):
        raise SceneError(f"{name or 'sweep'} is {float(value)}: give a finite number")
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
    raise SceneError(f"{name or 'sweep'} is {short(value)}: {cure}")


def _word(text: str, name: str) -> str:
    if not text.isprintable():
        raise SceneError(f"{name or 'sweep'} has {short(text)}: give words that can be printed")
    return text


def array_table(array: Array) -> dict[str, Any]:
    """The table of an array, as a scene file has it."""
    table = _full_table(array)
    # What comes with a preset, or with none, is left out: an axis of other presets brings its own.
    usual = Array.preset(table["preset"]) if "preset" in table else Array.grid(1, 1, 0.01)
    same = {key for key, value in _full_table(usual).items() if table.get(key) == value}
    return {
        key: value for key, value in table.items() if key not in same & {"source_pressure", "directivity"}
    }


def _full_table(array: Array) -> dict[str, Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)
        scene = Scene(array, array.positions[:1] + 0.1 * array.normals[:1])
    table: dict[str, Any] = json.loads(scene.json())["array"]
    return table


def short(value: Any) -> str:
    """A value for an error's one line."""
    try:
        text = " ".join(repr(value).split())
    except RecursionError:
        text = "nested too deep"
    return text if len(text) <= 60 else f"{text[:57]}..."
