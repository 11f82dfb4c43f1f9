"""Arguments of shapes and pictures, each checked; errors state name, value and cure."""

from __future__ import annotations

import json
import math
import os
import reprlib
import sys
import warnings
from contextlib import suppress
from os import PathLike
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError, SceneWarning

#: A file larger than this is no drawing, as with scene files.
MOST_BYTES = 64 << 20


def refused(item: str, value: Any, cure: str) -> SceneError:
    """A refusal, as one line."""
    given = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    return SceneError(" ".join(f"{item} is {shown(given)}: {cure}".split()))


def warn(text: str) -> None:
    """Warns by a SceneWarning, at the line that called the package."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and _is_inside(frame):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, SceneWarning, stacklevel=level)


def _is_inside(frame: FrameType) -> bool:
    """Returns whether a frame is of the package, or of a decorator of NumPy around one of its functions."""
    return frame.f_globals.get("__name__", "").partition(".")[0] in ("midair", "numpy")


def shown(value: Any) -> str:
    """A short text of a value."""
    if isinstance(value, str | PathLike):
        # A character that a terminal does not show is shown as its code.
        return f'"{str(value).replace(chr(0), chr(92) + "0")}"'
    return reprlib.repr(value)


def number(item: str, value: Any, *, above: float | None = None, least: float | None = None) -> float:
    """A finite number, above or at least a bound."""
    bound = "" if above is None else f" above {above:g}"
    bound = bound if least is None else f" of at least {least:g}"
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
        raise refused(item, value, f"give a number{bound}")
    try:
        finite = math.isfinite(value)
    except OverflowError:
        finite = False
    if not finite:
        raise refused(item, value, "give a finite number")
    if (above is not None and value <= above) or (least is not None and value < least):
        raise refused(item, value, f"give a number{bound}")
    return float(value)


def whole(item: str, value: Any, *, least: int) -> int:
    """A whole number."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer) or value < least:
        raise refused(item, value, f"give a whole number of at least {least}")
    return int(value)


def word(item: str, value: Any) -> str:
    """Text."""
    if not isinstance(value, str):
        raise refused(item, value, "give text in quotes")
    return value


def flag(item: str, value: Any) -> bool:
    """True or false."""
    if not isinstance(value, bool | np.bool_):
        raise refused(item, value, "give true or false")
    return bool(value)


def vector(item: str, value: Any) -> NDArray[np.float64]:
    """Three finite numbers."""
    return _numbers(item, value, (3,), "give three finite numbers")


def vectors(item: str, value: Any) -> NDArray[np.float64]:
    """At least two times three finite numbers."""
    found = _numbers(item, value, (-1, 3), "give a list of [x, y, z] in m")
    if len(found) < 2:
        raise refused(item, found, "give at least two")
    return found


def as_array(value: Any) -> NDArray[Any]:
    """An array of anything that numpy reads, or that has `__dlpack__`, in place where its memory allows.

    What lies on a GPU is copied. Raises whatever the other library raises for what it does not give away.
    """
    if isinstance(value, np.ndarray) or not hasattr(type(value), "__dlpack__"):
        return np.asarray(value)
    # Memory of a GPU, types that numpy does not have; and numpy 1.26 knows no device.
    with suppress(Exception):
        return np.from_dlpack(value)
    with suppress(Exception):
        return np.from_dlpack(value, device="cpu")
    return np.asarray(value)


def real(item: str, value: Any, cure: str) -> NDArray[np.float64]:
    """Real numbers of any shape, a read-only copy."""
    try:
        found = as_array(value)
    except ValueError:
        raise refused(item, value, cure) from None
    if found.dtype.kind not in "iuf":
        raise refused(item, value, cure)
    found = found.astype(np.float64)
    found.flags.writeable = False
    return found


def _numbers(item: str, value: Any, shape: tuple[int, ...], cure: str) -> NDArray[np.float64]:
    found = real(item, value, cure)
    same = found.ndim == len(shape) and all(n in (-1, m) for n, m in zip(shape, found.shape, strict=True))
    if not same or not np.isfinite(found).all():
        raise refused(item, value, cure)
    return found


def path_of(item: str, value: Any, cure: str = "give the name of a file") -> Path:
    """The name of a file, which need not be there."""
    if not isinstance(value, str | PathLike) or "\0" in os.fsdecode(value):
        raise refused(item, value, cure)
    return Path(value)


def json_object(item: str, text: str | bytes, cure: str) -> dict[str, Any]:
    """A JSON object without NaN and infinity."""

    def nan(name: str) -> float:
        raise SceneError(f"{item} holds {name}: give finite numbers")

    try:
        found = json.loads(text, parse_constant=nan)
    except SceneError:
        raise
    except (ValueError, RecursionError) as error:
        raise SceneError(f"{item} is no JSON: {cure}") from error
    if not isinstance(found, dict):
        raise SceneError(f"{item} is no JSON object: {cure}")
    return found


def callback(value: Any, arguments: str) -> None:
    """Refuse a `progress` that cannot be called with `arguments`."""
    if value is not None and not callable(value):
        raise refused("progress", value, f"give a function of ({arguments})")


def existing(item: str, value: Any, cure: str) -> Path:
    """A file that can be read."""
    path = path_of(item, value, cure)
    if not path.is_file():
        raise refused(item, path, f"there is no such file, {cure}")
    if path.stat().st_size > MOST_BYTES:
        raise refused(item, path, "it is larger than 64 MB, give a smaller one")
    return path
