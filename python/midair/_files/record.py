"""Files of solutions, and `.npz` of drives alone, `drive` (N,) or `drives` (T, N). No file is executed."""

import errno
import json
import os
import zipfile
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, SceneError, Solution, stated
from .._sequence import Sequence
from .._support import output
from .._support.arguments import path_of
from .._support.text import MOST_BYTES, arrays, content, fault, reading
from .played import ROUNDING, Played

#: Keys that a file of a solution must have.
KEYS = ("drive", "pressures", "targets", "scale", "steps", "elapsed")

CURE = "give what Solution.save, Sequence.save or midair.write wrote"


def save(solution: Solution, path: str | PathLike[str]) -> None:
    """Write the solution as .npz, .json or (the drive alone) .csv, by the path's ending, whole or not at all.

    Parameters
    ----------
    solution : midair.Solution
        The solution to write.
    path : str or path
        File to write; docs/files.md lists its keys.

    Raises
    ------
    SceneError
        If the file's ending is unknown, or the path cannot be written.
    """
    scene = solution.scene
    if scene is None:
        cure = "a matrix of your own has no scene file, pickle the solution instead"
        raise stated("solution.scene", "is None", cure, code="missing")
    target = path_of("path", path)
    output.check(target, output.DRIVES)
    output.write_drive(target, scene, solution)


def load(path: str | PathLike[str]) -> Solution:
    """Read an equal solution from a .npz or .json file of `save` or `midair solve -o`. Never executes a file.

    Parameters
    ----------
    path : str or path
        File to read.

    Returns
    -------
    midair.Solution
        An equal solution.

    Raises
    ------
    SceneError
        For a file with an error or whose drive does not give its pressures.
    FileNotFoundError
        For a missing file.
    """
    path = path_of("path", path)
    name = " ".join(str(path).split())
    ending = path.suffix.lower()
    if ending not in {".npz", ".json"}:
        raise stated(f'solution file "{name}"', "has no known ending", "give .npz or .json")
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    with reading("solution", path, "give what solution.save or midair solve -o wrote"):
        record = arrays(path) if ending == ".npz" else json.loads(content(path))
        solution: Solution = Solution._restore(_parts(record))  # type: ignore[attr-defined]
    return solution


def _parts(record: dict[str, Any]) -> dict[str, Any]:
    """Return the parts of a solution. Solver and status are in the text of its scene."""
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
    """Return an array; an array without dimensions as a number."""
    array = np.asarray(value)
    return array if array.ndim else array.item()


def _complex(value: Any) -> np.ndarray[Any, Any]:
    """Return complex numbers, which JSON stores as [re, im]."""
    array = np.asarray(value)
    return array if np.iscomplexobj(array) else np.array(array, np.float64).view(np.complex128)[:, 0]


def write(path: Path, drives: Played) -> None:
    """Write drives without a solution."""
    name: Any = {"drive" if drives.alone else "drives": drives.all()}
    np.savez(path, **name)


def read(path: str | PathLike[str]) -> Solution | Sequence | NDArray[np.complex64]:
    """Read a solution, a sequence or drives, by the file's content. Nothing in it is executed."""
    try:
        with zipfile.ZipFile(path) as found:
            sizes = {entry.filename.removesuffix(".npy"): entry.file_size for entry in found.infolist()}
    except OSError as error:
        reason = error.strerror or str(error)
        raise fault(path, None, f"it cannot be read ({reason})", "give a file that is there") from error
    # zip raises errors of many kinds for a damaged file.
    except Exception as error:
        raise fault(path, None, "it is damaged, or no .npz", CURE) from error
    if "setting" in sizes:
        return Sequence.load(path)
    if "scene" in sizes:
        return Solution.load(path)
    alone = "drive" in sizes
    name = "drive" if alone else "drives"
    if name not in sizes:
        raise fault(path, None, "there is no drive in it", CURE)
    if sizes[name] > MOST_BYTES:
        raise fault(path, None, f"{name} unpacks to more than {MOST_BYTES >> 20} MB", "give a smaller one")
    return _drives(path, name, 1 if alone else 2)


def _drives(path: str | PathLike[str], name: str, dimensions: int) -> NDArray[np.complex64]:
    try:
        drives = arrays(path, [name])[name]
    except SceneError as error:
        raise fault(path, None, error) from error
    except (ValueError, KeyError) as error:
        raise fault(path, None, f"{name} is damaged, or no numbers", CURE) from error
    if drives.dtype.kind not in "fc" or drives.ndim != dimensions or not drives.size:
        reported = f"{drives.dtype} of shape {drives.shape}"
        cure = f"give complex64, {('(N,)' if dimensions == 1 else '(T, N)')}"
        raise fault(path, None, f"{name} is {reported}", cure)
    wrong = np.argwhere(~(np.abs(drives) <= 1 + ROUNDING))
    if len(wrong):
        place = tuple(wrong[0].tolist())
        reported = f"{name}{list(place)} is {drives[place]}"
        raise fault(path, None, reported, "give finite numbers, at most 1 in modulus")
    return np.asarray(drives, np.complex64)
