"""Scene files with moving points: the table [motion] with its paths, beside array, medium and solver."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import path as paths
from .._midair import Array, SceneError, placed, read_motion, read_table, restated, solver_name, stated
from .._points.drawn import called
from .._support.arguments import existing, refused, word
from .._support.text import array, content
from ..path import Path as Moving
from .sequence import Sequence
from .solve import sequence

#: The kinds of paths in a scene file, and the functions that make them.
KINDS: dict[str, Callable[..., Moving]] = {
    "circle": paths.circle,
    "line": paths.line,
    "polyline": paths.polyline,
    "lissajous": paths.lissajous,
    "still": paths.still,
    "svg": paths.svg,
    "morph": paths.morph,
}


@dataclass(frozen=True)
class Document:
    """A motion read from a scene file: the arguments of `midair.sequence`."""

    array: Array
    path: Moving | NDArray[np.float64]
    settings: dict[str, Any]
    solver: str
    air: dict[str, Any]
    options: dict[str, Any]
    file: Path

    def solve(self, array: Array | None = None, solver: str | None = None, **keywords: Any) -> Sequence:
        """Solve the sequence; `array` and `solver` replace those of the file.

        The file's options apply to its own solver only. An error about a value of [motion] names the place in
        the file.
        """
        name = self.solver if solver is None else solver_name(solver)
        options = self.options if name == self.solver else {}
        given = {**self.settings, **self.air, **options, **keywords}
        try:
            return sequence(self.array if array is None else array, self.path, name, **given)
        except SceneError as error:
            named = restated(error, item=f"motion.{error.item}")
            found = placed(self.file.read_bytes(), str(self.file), named)
            if found is None or error.item in keywords:
                raise
            raise found from error


def read(file: Path) -> Document | None:
    """Read the motion of a scene file, None if it has no [motion]. Errors name the file and the line."""
    moving: list[Moving | NDArray[np.float64]] = []

    def start(name: str, text: str) -> NDArray[np.float64]:
        """Read a path or a file of frames into `moving`; return the points of its first frame."""
        folder = file.parent
        one = _points(text, folder) if name == "motion.file" else path_of(tomllib.loads(text), folder)
        moving.append(one)
        first: NDArray[np.float64] = one.at([0.0])[0] if isinstance(one, Moving) else one[0]
        return first

    found = read_motion(existing("path", file, "give a .toml or .json file"), start)
    if found is None:
        return None
    scene, settings = found
    solver, options = scene.solver or ("glide", {})
    air = {**scene.medium, "obstacles": scene.obstacles, "bead": scene.bead}
    if scene.signature is not None:
        air["signature"] = scene.signature
    return Document(scene.array, _together(moving), settings, solver, air, dict(options), file)


def _together(moving: list[Any]) -> Moving | NDArray[np.float64]:
    """Return the frames of a document's file, or all its paths played at the same time."""
    together: Moving | NDArray[np.float64] = reduce(lambda one, other: one & other, moving)
    return together


#: The columns of a .csv file of frames, a hint on their units, and an example of a correct row.
FRAMES = (["frame", "point", "x", "y", "z"], "with x, y, z in metres", "0,0,0.01,0.0,0.15")


def _points(name: str, folder: Path) -> NDArray[np.float64]:
    """Return points (T, M, 3) in m from a .npy file, or from a .csv file with columns frame, point, x, y, z.

    The core adds the key and its value to the text of an error.
    """
    file = folder / name
    if not file.is_file():
        raise stated(
            "", "there is no such file", "give a .npy or .csv file beside the scene file", code="missing"
        )
    if file.suffix.lower() == ".csv":
        return _frames(file)
    try:
        found: NDArray[np.float64] = array(file)
    except SceneError:
        raise
    except ValueError as error:
        cure = "give points (T, M, 3) as .npy, or .csv with the columns frame, point, x, y, z"
        raise stated("", cure, "", code="unreadable") from error
    if found.ndim != 3 or found.shape[2] != 3 or not found.size:
        raise stated("its shape", f"is {found.shape}", "give points (T, M, 3)")
    return found


def _frames(file: Path) -> NDArray[np.float64]:
    """Return points (T, M, 3) of a table with one row for each point of each frame, in any order."""
    lines, rows = read_table(content(file, empty=True), str(file), *FRAMES)

    def wrong(row: int, words: str, cure: str) -> SceneError:
        return restated(stated("", words, cure, "unreadable"), place=f"{file}, line {lines[row]}")

    for column, name in enumerate(("frame", "point")):
        bad = np.flatnonzero((rows[:, column] < 0) | (rows[:, column] % 1 != 0))
        if bad.size:
            value = f"{rows[bad[0], column]:g}"
            raise wrong(bad[0], f"{name} is {value}", "count them 0, 1, 2, ...")
    frames, count = (int(rows[:, column].max()) + 1 for column in (0, 1))
    if frames * count > len(rows):
        needed = f"{frames} frames of {count} points need {frames * count} rows"
        raise stated("", str(file), f"{needed}, {len(rows)} are there")
    places = rows[:, 0].astype(int) * count + rows[:, 1].astype(int)
    once, first = np.unique(places, return_index=True)
    if len(once) < len(places):
        twice = np.setdiff1d(np.arange(len(places)), first)[0]
        frame, point = divmod(int(places[twice]), count)
        raise wrong(twice, f"point {point} of frame {frame} is there twice", "give it once")
    points = np.empty((frames * count, 3))
    points[places] = rows[:, 2:]
    return points.reshape(frames, count, 3)


def path_of(table: dict[str, Any], folder: Path) -> Moving:
    """Make the path that a table of a scene file describes. `folder` contains the files that it names."""
    if "kind" not in table:
        raise stated("kind", "is left out", f"give one of {', '.join(KINDS)}", code="missing")
    kind = word("kind", table.pop("kind"))
    if kind not in KINDS:
        raise refused("kind", kind, f"give one of {', '.join(KINDS)}")
    modulation = table.pop("am", None)
    if "pressure" in table:
        table["pressures"] = table.pop("pressure")
    if modulation is not None and not isinstance(modulation, dict):
        raise refused("am", modulation, 'give am = { frequency = 200, shape = "sqrt" }')
    path: Moving = called(KINDS[kind], kind, table, folder)
    if modulation is None:
        return path
    try:
        modulated: Moving = called(path.with_am, "am", modulation, folder)
    except SceneError as error:
        # The path may have a key of the same name.
        named = error.item in modulation or error.code == "missing"
        raise (restated(error, item=f"am.{error.item}") if named else error) from None
    return modulated
