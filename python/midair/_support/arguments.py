"""Checks of arguments; errors state name, value and cure."""

import json
import math
import os
import reprlib
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from os import PathLike
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError, SceneWarning, frame_rate as plausible, numbers, stated

#: Sizes of numbers within which products of a few of them neither overflow nor vanish.
SMALLEST, GREATEST = 1e-100, 1e100

#: Largest size in bytes of a drawing or a scene file.
MOST_BYTES = 64 << 20


def refused(item: str, value: Any, cure: str, code: str = "invalid") -> SceneError:
    """Return the error for an argument, in one line."""
    given = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    return stated(item, f"is {shown(given)}", cure, code)


#: Function that takes the warnings of this thread instead of Python's filters.
_taker: ContextVar[Callable[[str], None] | None] = ContextVar("taker", default=None)


@contextmanager
def warnings_to(take: Callable[[str], None]) -> Iterator[None]:
    """Pass the warnings of a block in this thread to a function; Python does not show them."""
    before = _taker.set(take)
    try:
        yield
    finally:
        _taker.reset(before)


def warn(text: str) -> None:
    """Emit a SceneWarning that points to the line of the caller's code."""
    if take := _taker.get():
        take(str(text))
        return
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and _is_inside(frame):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, SceneWarning, stacklevel=level)


@contextmanager
def without_warnings() -> Iterator[None]:
    """Suppress the SceneWarnings of a block, which were given before or do not concern the caller."""
    with warnings.catch_warnings(), warnings_to(lambda text: None):
        warnings.simplefilter("ignore", SceneWarning)
        yield


def _is_inside(frame: FrameType) -> bool:
    """Return whether a stack frame belongs to this package, or to NumPy, which decorates some functions."""
    return frame.f_globals.get("__name__", "").partition(".")[0] in ("midair", "numpy")


def shown(value: Any) -> str:
    """Return a short text of a value."""
    if isinstance(value, str | PathLike):
        # A terminal does not display code 0, so it is written as \0, and half of a surrogate pair as \ud800.
        text = str(value).replace(chr(0), chr(92) + "0").encode("utf-8", "backslashreplace")
        return f'"{text.decode()}"'
    return reprlib.repr(value)


def number(item: str, value: Any, *, above: float | None = None, least: float | None = None) -> float:
    """Check a finite number, above or at least a bound; return it as a float."""
    bound = "" if above is None else f" above {above:g}"
    bound = bound if least is None else f" of at least {least:g}"
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
        raise refused(item, value, f"give a number{bound}", "type")
    try:
        finite = math.isfinite(value)
    except OverflowError:
        finite = False
    if not finite:
        raise refused(item, value, "give a finite number", "not-finite")
    if (above is not None and value <= above) or (least is not None and value < least):
        raise refused(item, value, f"give a number{bound}", "out-of-range")
    real = float(value)
    if real and not SMALLEST <= abs(real) <= GREATEST:
        raise refused(item, value, f"give a number from {SMALLEST:g} to {GREATEST:g} in size", "out-of-range")
    return real


def frame_rate(rate: Any) -> float:
    """Return a plausible number of frames per second."""
    return plausible(number("rate", rate, above=0))


def sized(item: str, values: NDArray[Any]) -> NDArray[Any]:
    """Check that no number is so large that its square overflows."""
    if np.abs(values).max(initial=0.0) > GREATEST:
        raise stated(item, f"holds a number above {GREATEST:g}", "give smaller ones", "out-of-range")
    return values


def whole(item: str, value: Any, *, least: int, most: int | None = None) -> int:
    """Check a whole number; return it as an int."""
    integer = isinstance(value, int | np.integer) and not isinstance(value, bool | np.bool_)
    if not integer or value < least or (most is not None and value > most):
        limits = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise refused(item, value, f"give a whole number {limits}", "out-of-range")
    return int(value)


def word(item: str, value: Any) -> str:
    """Check that a value is text, and return it."""
    if not isinstance(value, str):
        raise refused(item, value, "give text in quotes", "type")
    return value


def flag(item: str, value: Any) -> bool:
    """Check that a value is true or false; return it as a bool."""
    if not isinstance(value, bool | np.bool_):
        raise refused(item, value, "give true or false", "type")
    return bool(value)


def is_array(value: Any) -> bool:
    """Return whether a value is an array of NumPy or of another library."""
    signs = ("__dlpack__", "__array_interface__")
    return not isinstance(value, np.generic) and any(hasattr(value, name) for name in signs)


def vector(item: str, value: Any) -> NDArray[np.float64]:
    """Check three finite numbers; return them as an array."""
    return numbers(item, value, [(3,)], "give three finite numbers")


def vectors(item: str, value: Any, least: int = 2) -> NDArray[np.float64]:
    """Check vectors (K, 3), at least `least`; return them as an array."""
    cure = f"give {f'at least {least} ' if least > 1 else ''}points [x, y, z] in m"
    return numbers(item, value, [(-least, 3)], cure)


def path_of(item: str, value: Any, cure: str = "give the name of a file") -> Path:
    """Check the name of a file, which need not exist; return it as a Path."""
    if not isinstance(value, str | PathLike) or "\0" in os.fsdecode(value):
        raise refused(item, value, cure)
    return Path(value)


def json_object(item: str, text: str | bytes, cure: str) -> dict[str, Any]:
    """Parse a JSON object; rejects NaN and infinity."""

    def nan(name: str) -> float:
        raise stated(item, f"holds {name}", "give finite numbers")

    try:
        found = json.loads(text, parse_constant=nan)
    except SceneError:
        raise
    except (ValueError, RecursionError) as error:
        raise stated(item, "is no JSON", cure) from error
    if not isinstance(found, dict):
        raise stated(item, "is no JSON object", cure)
    return found


@contextmanager
def needs(what: str, extra: str, kind: type[Exception] | None = None) -> Iterator[None]:
    """Name the extra of midair that installs what the block imports, if it is missing."""
    try:
        yield
    except ImportError as error:
        cure = f'pip install "midair[{extra}]"'
        raise (kind(f"{what}: {cure}") if kind else stated("", what, cure, "missing")) from error


def callback(value: Any, arguments: str) -> None:
    """Raise SceneError if `progress` cannot be called; `arguments` describes how it will be called."""
    if value is not None and not callable(value):
        raise refused("progress", value, f"give a function of ({arguments})")


def existing(item: str, value: Any, cure: str) -> Path:
    """Check a file that exists and is not too large; return it as a Path."""
    path = path_of(item, value, cure)
    if not path.is_file():
        raise refused(item, path, f"there is no such file, {cure}")
    if path.stat().st_size > MOST_BYTES:
        raise refused(item, path, "it is larger than 64 MB, give a smaller one")
    return path
