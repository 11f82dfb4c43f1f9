"""Tables of a scene file that the core cannot read alone: [shape] and [image], and files of obstacles."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError, memory_limit, restated, stated
from .._support.arguments import needs, number, path_of, refused, vector, word
from ..shape import svg, text
from ..shape._figures import Points
from ..shape._vector_graphics import one_outline
from .image import image

#: Formats of 3D models that trimesh reads without further packages.
ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb")

#: Bytes of memory per byte of a file, measured for all formats.
EACH = 16


def read(
    path: str | os.PathLike[str], scale: float = 1.0, offset: Any = (0.0, 0.0, 0.0)
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return vertices (V, 3) in m without duplicates, and faces (F, 3), of all bodies of a file together.

    Parameters
    ----------
    scale
        Length of the file's unit in m.
    offset
        Vector (3,) in m that is added after scaling.
    """
    scale = number("scale", scale, least=0)
    if scale == 0:
        raise refused("scale", scale, "give the metres of the file's unit, such as 1e-3")
    away = vector("offset", offset)
    file = path_of("path", path)
    trimesh = library()
    if not file.is_file():
        reported = "it is a folder, device or pipe, give a file" if file.exists() else "there is no such file"
        raise refused("path", file, reported)
    ending = file.suffix.lower()
    if ending not in ENDINGS:
        raise refused("path", file, _formats("it is of no known format"))
    if (needed := file.stat().st_size * EACH) > memory_limit():
        cure = f"it needs {needed >> 20} MB of {memory_limit() >> 20} allowed, give one of fewer faces"
        raise refused("path", file, cure)
    try:
        found = trimesh.load(file, file_type=ending[1:], force="mesh", process=False)
        if not len(getattr(found, "faces", ())):
            raise refused("path", file, "it has no faces, give a surface")
        if not np.isfinite(found.vertices).all():
            raise refused("path", file, "it has vertices that are no finite numbers, export it again")
        # .stl repeats the corners for each face; .obj and .glb repeat those at seams of textures and normals.
        found.merge_vertices(merge_tex=True, merge_norm=True)
    except (KeyboardInterrupt, SceneError):
        raise
    except BaseException as error:
        reported = _formats(f"trimesh cannot read it ({reason(error)})")
        raise refused("path", file, reported) from None
    vertices, faces = np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)
    # Faces with two equal corners have no area and are left out; the mesh stays closed without them.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    with np.errstate(over="ignore"):
        return vertices * scale + away, faces


def _formats(wrong: str) -> str:
    return f"{wrong}, export it again, as {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"


def library() -> Any:
    """Return the package trimesh."""
    with needs("Mesh.from_file needs trimesh", "mesh"):
        import trimesh
    return trimesh


def reason(error: BaseException) -> str:
    """Return the text of an error in one line."""
    if isinstance(error, ImportError) and isinstance(error.__context__, UnicodeError):
        # If a file is no text, trimesh reports a missing package for guessing encodings; its context has the
        # real cause.
        error = error.__context__
    return " ".join(f"{type(error).__name__}: {error}".split())


SHAPES: dict[str, Callable[..., Points]] = {"text": text, "svg": svg}

Faces: TypeAlias = NDArray[np.int64]
Drawn: TypeAlias = tuple[Points, Any, Any]


def points(table: str, keys: str, folder: Path | None) -> Drawn:
    """Return points (M, 3), pressures and weights of a table; `keys` is its TOML, `folder` has its files."""
    given = tomllib.loads(keys)
    weight = number("weight", given.pop("weight"), least=0) if "weight" in given else None
    if table == "image":
        picture = called(image, "image", given, folder)
        return picture.points, picture.pressures, weight
    kind = given.pop("kind")
    pressure = number("pressure", given.pop("pressure"), least=0) if "pressure" in given else None
    return called(SHAPES[kind], kind, given, folder), pressure, weight


def mesh(keys: str, folder: Path | None) -> tuple[Points, Faces]:
    """Return vertices (V, 3) and faces (F, 3) of an obstacle's file; `keys` is the TOML of its table."""
    given = tomllib.loads(keys)
    given.pop("kind", None)
    found: tuple[Points, Faces] = called(read, "an obstacle's file", given, folder)
    return found


def outline(keys: str, folder: Path | None) -> tuple[Points, bool]:
    """Return the vertices (K, 3) of a drawing's outline, and whether it is closed; `keys` is its TOML."""
    given = tomllib.loads(keys)
    own: dict[str, Any] = {key: given[key] for key in ("file", "size", "z") if key in given}
    found: tuple[Points, bool] = called(one_outline, "svg", own, folder)
    return found


def called(draw: Callable[..., Any], kind: str, given: dict[str, Any], folder: Path | None) -> Any:
    """Call a function whose arguments are a table's keys; the key `file` is the argument `path`."""
    named = {("file" if name == "path" else name): one for name, one in signature(draw).parameters.items()}
    needed = [name for name, one in named.items() if one.default is Parameter.empty]
    for name, value in given.items():
        if name not in named:
            raise refused(name, value, f"{kind} has {', '.join(named)}, leave it out")
    for name in needed:
        if name not in given:
            raise stated(name, "is left out", f"{kind} needs {', '.join(needed)}", code="missing")
    if "file" not in given:
        return draw(**given)
    if folder is None:
        cure = "this document has no folder to find files in, list the points themselves"
        raise refused("file", given["file"], cure)
    file = folder / word("file", given.pop("file"))
    try:
        return draw(file, **given)
    except SceneError as error:
        raise (restated(error, item="file") if error.item == "path" else error) from None
