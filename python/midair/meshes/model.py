"""Model: a file of a modeller as vertices and faces, by trimesh."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from ..shape.arguments import number, path_of, refused


def read(
    path: str | os.PathLike[str], scale: float = 1.0, offset: Any = (0.0, 0.0, 0.0)
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (V, 3) in m and faces (F, 3), all bodies of the file together.

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
        raise SceneError(f'path is "{file}": there is no such file')
    try:
        # Corners that are the same place are one vertex from then on: .stl lists each face's own.
        found = trimesh.load(file, force="mesh", process=True)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise SceneError(f'path is "{file}": trimesh cannot read it ({one_line(error)})') from None
    if not len(getattr(found, "faces", ())):
        raise SceneError(f'path is "{file}": it has no faces, give a surface')
    return np.asarray(found.vertices, float) * scale + away, np.asarray(found.faces, np.int64)


def library() -> Any:
    """The package trimesh."""
    try:
        import trimesh
    except ImportError as error:
        raise SceneError('Mesh.from_file needs trimesh: pip install "midair[mesh]"') from error
    return trimesh


def one_line(error: BaseException) -> str:
    """What an error says, in a line."""
    return " ".join(f"{type(error).__name__}: {error}".split())
