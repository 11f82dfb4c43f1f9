"""Tables of a scene file that the core cannot draw: [shape] and [image], and obstacles in files."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._midair import SceneError
from .picture import image
from .shape import circle, line, polyline, svg, text
from .shape.arguments import number, refused, word
from .shape.contour import Points

SHAPES: dict[str, Callable[..., Points]] = {
    "line": line,
    "circle": circle,
    "polyline": polyline,
    "text": text,
    "svg": svg,
}

Faces: TypeAlias = NDArray[np.int64]
Drawn: TypeAlias = tuple[Points, Any, Any]


def points(table: str, keys: str, folder: Path | None) -> Drawn:
    """Points (M, 3), pressures and weights of a table by its name; keys is TOML, its files in folder."""
    given = tomllib.loads(keys)
    weight = number("weight", given.pop("weight"), least=0) if "weight" in given else None
    if table == "image":
        picture = called(image, "image", given, folder)
        return picture.points, picture.pressures, weight
    if "kind" not in given:
        raise SceneError(f"kind is left out: give one of {', '.join(SHAPES)}")
    kind = word("kind", given.pop("kind"))
    if kind not in SHAPES:
        raise refused("kind", kind, f"give one of {', '.join(SHAPES)}")
    pressure = number("pressure", given.pop("pressure"), least=0) if "pressure" in given else None
    return called(SHAPES[kind], kind, given, folder), pressure, weight


def mesh(keys: str, folder: Path | None) -> tuple[Points, Faces]:
    """Vertices (V, 3) and faces (F, 3) of an obstacle's file; keys is TOML."""
    from .meshes.model import read

    given = tomllib.loads(keys)
    given.pop("kind", None)
    found: tuple[Points, Faces] = called(read, "an obstacle's file", given, folder)
    return found


def called(draw: Callable[..., Any], kind: str, given: dict[str, Any], folder: Path | None) -> Any:
    """What a function makes of a table's keys, which are its arguments; `file` is its path."""
    named = {("file" if name == "path" else name): one for name, one in signature(draw).parameters.items()}
    needed = [name for name, one in named.items() if one.default is Parameter.empty]
    for name, value in given.items():
        if name not in named:
            raise refused(name, value, f"{kind} has {', '.join(named)}, leave it out")
    for name in needed:
        if name not in given:
            raise SceneError(f"{name} is left out: {kind} needs {', '.join(needed)}")
    if "file" not in given:
        return draw(**given)
    if folder is None:
        cure = "this document has no folder to find files in, list the points themselves"
        raise refused("file", given["file"], cure)
    file = folder / word("file", given.pop("file"))
    try:
        return draw(file, **given)
    except SceneError as error:
        raise SceneError(str(error).replace("path is ", "file is ", 1)) from error
