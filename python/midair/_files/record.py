"""Solutions as files: reads the files of `solution.save`, and never executes anything in them."""

from __future__ import annotations

import errno
import json
import os
from os import PathLike
from typing import Any

import numpy as np

from .._midair import Scene, SceneError, Solution
from .._support import output
from .._support.arguments import path_of
from .._support.text import arrays, content

#: Keys that a file needs for a solution.
KEYS = ("drive", "pressures", "targets", "scale", "steps", "elapsed")


def save(solution: Solution, path: str | PathLike[str]) -> None:
    """Write the solution as .npz, .json or (the drive alone) .csv, by the path's ending, whole or not at all.

    Raises SceneError for another ending, and for a path that cannot be written. docs/conventions.md
    lists the keys of a file.
    """
    scene = solution.scene
    if scene is None:
        raise SceneError(
            "solution.scene is None: a matrix of your own has no scene file, pickle the solution instead"
        )
    target = path_of("path", path)
    output.check(target, output.DRIVES)
    output.write_drive(target, scene, solution)


def load(path: str | PathLike[str]) -> Solution:
    """Read an equal solution from a .npz or .json file of `save` or `midair solve -o`. Never executes a file.

    Raises SceneError for a file with an error or whose drive does not give its pressures,
    FileNotFoundError for a missing file.
    """
    path = path_of("path", path)
    name = " ".join(str(path).split())
    ending = path.suffix.lower()
    if ending not in {".npz", ".json"}:
        raise SceneError(f'solution file "{name}" has no known ending: give .npz or .json')
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    try:
        record = arrays(path) if ending == ".npz" else json.loads(content(path))
        solution: Solution = Solution._restore(_parts(record))  # type: ignore[attr-defined]
    except SceneError as error:
        raise SceneError(f'solution file "{name}": {error}') from error
    # Any error of zip, NumPy and JSON with a damaged file.
    except Exception as error:
        raise SceneError(
            f'solution file "{name}" is damaged, or none: give what solution.save or midair solve -o wrote'
        ) from error
    return solution


def _parts(record: dict[str, Any]) -> dict[str, Any]:
    """Parts of a solution; the solver and the status are in the scene's text."""
    text = json.loads(str(record["scene"]))
    status, solver = text.pop("status"), text.pop("solver")
    if "scene_solver" in record:
        name, options = json.loads(str(record["scene_solver"]))
        text["solver"] = {"name": name, **options}
    scene: Scene = Scene.parse(json.dumps(text))
    parts: dict[str, Any] = {key: _number(record[key]) for key in KEYS}
    trace = _number(record["trace"]) if "trace" in record else None
    return parts | {
        "drive": _complex(record["drive"]),
        "pressures": _complex(record["pressures"]),
        "trace": trace,
        "scene": scene,
        "status": status,
        "solver": solver.pop("name"),
        "options": solver,
    }


def _number(value: Any) -> Any:
    """Numbers as they are; an array of no dimensions is one."""
    array = np.asarray(value)
    return array if array.ndim else array.item()


def _complex(value: Any) -> np.ndarray[Any, Any]:
    """Complex numbers, in JSON as [re, im]."""
    array = np.asarray(value)
    return array if np.iscomplexobj(array) else np.array(array, np.float64).view(np.complex128)[:, 0]
