"""Requests from Python as what JSON can hold: NumPy's values, tuples, and midair.Array as its table."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np

from .._midair import Array, Scene, SceneError, SceneWarning


def plain(value: Any, name: str = "request") -> Any:
    """The same value in dicts, lists, numbers and words; scenes and paths are left as they are."""
    if value is None or isinstance(value, str | bool | int | float | Scene | PathLike):
        return value
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, Array):
        return array_table(value)
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), name)
    if isinstance(value, Mapping):
        return {str(key): plain(inner, str(key)) for key, inner in value.items()}
    if isinstance(value, Sequence):
        return [plain(inner, name) for inner in value]
    raise SceneError(
        f"{name} is {short(value)}: give numbers, words, lists and tables as a sweep file has them"
    )


def array_table(array: Array) -> dict[str, Any]:
    """The table of an array, as a scene file has it."""
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
