"""Tables of a scene file that the core cannot read alone: [shape] and [image], and files of obstacles."""

import io
import os
import re
import tomllib
from collections.abc import Callable
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError, memory_limit, restated, rotation as turned, stated
from .._support.arguments import needs, number, path_of, refused, shown, vector, warn, word
from .._support.text import content
from ..shape import svg, text
from ..shape._figures import Points
from ..shape._vector_graphics import one_outline
from .image import image

#: Formats of 3D models that trimesh reads without further packages.
ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb")

#: Bytes of memory per byte of a file, measured for all formats.
EACH = 16

Faces: TypeAlias = NDArray[np.int64]

#: Axis of a file that points up: the order of its coordinates in a frame with z up, and their signs.
UP = {"x": ([1, 2, 0], [1, 1, 1]), "y": ([0, 2, 1], [1, -1, 1]), "z": ([0, 1, 2], [1, 1, 1])}


def read(
    path: str | os.PathLike[str],
    scale: float = 1.0,
    offset: Any = (0.0, 0.0, 0.0),
    rotation: Any = None,
    up: str | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return vertices (V, 3) in m without duplicates, and faces (F, 3), of all bodies of a file together.

    Parameters
    ----------
    scale
        Length of the file's unit in m.
    offset
        Vector (3,) in m that is added after scaling and rotating.
    rotation
        Rotation about the origin: axis times angle in rad (3,), quaternion w, x, y, z (4,), matrix (3, 3).
    up
        Axis of the file that becomes z: "x", "y" or "z"; by default "y" for glTF (its standard), else "z".
    """
    scale = number("scale", scale, least=0)
    if scale == 0:
        raise refused("scale", scale, "give the metres of the file's unit, such as 1e-3")
    away, turn = vector("offset", offset), turned(rotation)
    file = path_of("path", path)
    with needs("Mesh.from_file needs trimesh", "mesh"):
        import trimesh
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
        data = io.BytesIO(_trimmed(content(file, empty=True), ending))
        found: Any = trimesh.load(data, file_type=ending[1:], force="mesh", process=False)
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
    faces = _joined(vertices, faces)
    # Faces with two equal corners have no area and are left out; the mesh stays closed without them.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    if copies := len(faces) - len(first):
        warn(f"{shown(path)}: {copies} copies of faces are left out")
    faces = faces[np.sort(first)]
    if up not in (None, *UP):
        raise refused("up", up, 'give "x", "y" or "z", the axis of the file that becomes z')
    order, signs = UP[up or ("y" if ending == ".glb" else "z")]
    with np.errstate(over="ignore", invalid="ignore"):
        return vertices[:, order] * signs * scale @ turn.T + away, faces


def _trimmed(data: bytes, ending: str) -> bytes:
    """Return a file without the bytes behind its last face, where its format states its length."""
    if ending == ".glb":
        return data[: int.from_bytes(data[8:12], "little")]
    if ending == ".stl":
        # In a file of text, the four bytes are letters: more faces than it could have.
        most = 84 + 50 * int.from_bytes(data[80:84], "little")
        if 84 <= most <= len(data) or data.lstrip()[:5].lower() != b"solid":
            return data[:most]
    if ending == ".ply":
        head, mark, body = data.partition(b"end_header")
        if b"format ascii" not in head:
            return data
        counts = [int(count) for count in re.findall(rb"element \w+ (\d+)", head)]
        return b"\n".join([head + mark, *body.split(b"\n")[1 : sum(counts) + 1], b""])
    return data.decode("utf-8", "replace").encode()


def _joined(vertices: Points, faces: Faces) -> Faces:
    """Return faces whose corners are one vertex where they differ by rounding.

    They are joined within a tenth of the shortest edge, but within 1e-6 to 1e-4 of the size of the mesh.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    edges = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2)
    size = float(np.ptp(vertices, axis=0).max())
    near = np.clip(0.1 * edges[edges > 0].min(initial=np.inf), 1e-6 * size, 1e-4 * size)
    pairs = KDTree(vertices).query_pairs(near, output_type="ndarray")
    if not len(pairs):
        return faces
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(vertices),) * 2)
    _, groups = connected_components(graph, directed=False)
    _, first = np.unique(groups, return_index=True)
    return np.asarray(first[groups][faces])


def _formats(wrong: str) -> str:
    return f"{wrong}, export it again, as {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"


def reason(error: BaseException) -> str:
    """Return the text of an error in one line."""
    if isinstance(error, ImportError) and isinstance(error.__context__, UnicodeError):
        # If a file is no text, trimesh reports a missing package for guessing encodings; its context has the
        # real cause.
        error = error.__context__
    return " ".join(f"{type(error).__name__}: {error}".split())


SHAPES: dict[str, Callable[..., Points]] = {"text": text, "svg": svg}

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
