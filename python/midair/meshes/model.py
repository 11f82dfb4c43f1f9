"""Model: a file of a modeller as vertices and faces, by trimesh."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from ..shape.arguments import number, path_of, refused

#: Formats that modellers write and trimesh reads without further packages.
ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb")


def read(
    path: str | os.PathLike[str], scale: float = 1.0, offset: Any = (0.0, 0.0, 0.0)
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (V, 3) in m, each place once, and faces (F, 3), all bodies of the file together.

    scale : metres of the file's unit
    offset : what is added then (3,), in m
    """
    scale = number("scale", scale, least=0)
    if scale == 0:
        raise refused("scale", scale, "give the metres of the file's unit, such as 1e-3")
    away = np.asarray(offset, float)
    if away.shape != (3,) or not np.isfinite(away).all():
        raise refused("offset", offset, "give three finite numbers")
    file = path_of("path", path)
    trimesh = library()
    if not file.is_file():
        told = "it is a folder, device or pipe, give a file" if file.exists() else "there is no such file"
        raise SceneError(f'path is "{file}": {told}')
    try:
        found = trimesh.load(file, force="mesh", process=False)
        if not len(getattr(found, "faces", ())):
            raise SceneError(f'path is "{file}": it has no faces, give a surface')
        if not np.isfinite(found.vertices).all():
            raise SceneError(f'path is "{file}": it has vertices that are no finite numbers, export it again')
        # .stl lists the corners of each face anew, .obj and .glb those with a texture's or normal's seam.
        found.merge_vertices(merge_tex=True, merge_norm=True)
    except (KeyboardInterrupt, SceneError):
        raise
    except BaseException as error:
        cure = f"export it again, as {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"
        raise SceneError(f'path is "{file}": trimesh cannot read it ({reason(error)}), {cure}') from None
    vertices, faces = np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)
    # Faces two of whose corners have become one have no area, and their neighbours meet without them.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    with np.errstate(over="ignore"):
        return vertices * scale + away, faces


def library() -> Any:
    """The package trimesh."""
    try:
        import trimesh
    except ImportError as error:
        raise SceneError('Mesh.from_file needs trimesh: pip install "midair[mesh]"') from error
    return trimesh


def reason(error: BaseException) -> str:
    """What an error says, in a line."""
    if isinstance(error, ImportError) and isinstance(error.__context__, UnicodeError):
        # Of bytes that are no text, trimesh says that a package is missing which would guess their letters.
        error = error.__context__
    return " ".join(f"{type(error).__name__}: {error}".split())
