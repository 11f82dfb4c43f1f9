"""`midair.read`: reads drives or control points by ending and content of a file."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from .._boards.board import Board
from .._midair import Array, Solution, drive_from_csv
from .._motion import Sequence
from .._support.arguments import path_of
from .._support.text import content, fault, number, rows, text
from . import acoustools, archive, control_points, holo, pair
from . import played as board_frames
from .control_points import ControlPoints
from .played import known

CSV = (
    "give index,x,y,z,amplitude,phase, or t,x,y,z,intensity, or AcousTools' frames,transducers,"
    " or Ultraino's pair ...0_Phase.csv and ...0_Amp.csv"
)


def read(
    path: str | PathLike[str], *, board: Board | str | PathLike[str] | None = None
) -> Solution | Sequence | NDArray[np.complex64] | ControlPoints:
    """Read a file of `midair.write`, `save` or another program.

    | file | result |
    |---|---|
    | `.npz`, `.json` | the Solution or Sequence, or drives alone |
    | `.holo`, `.csv` of AcousTools or Ultraino, `.bin` | drives, complex64: (N,) of one frame, else (T, N) |
    | `.csv` of a drive | the drive (N,) |
    | `.csv` of control points | times, points, intensities and frequencies: midair._files.ControlPoints |

    board : the midair.Board of the frames of a .bin, its name or .pat file

    The first row of a .csv identifies its kind; Ultraino's has none and is identified by its name. Drives
    of 512 transducers from AcousTools are in the order of the board's array, by default `openmpd_pair`.
    Nothing in a file is executed. Raises SceneError for a file with an error, naming the line.
    """
    ending, player = path_of("path", path).suffix.lower(), known(board)
    array = None if player is None else player.array
    if ending == ".npz":
        return archive.read(path)
    if ending == ".json":
        content(path)
        return Solution.load(path)
    if ending == ".holo":
        return holo.read(path, array)
    if ending == ".bin":
        return board_frames.read(path, player)
    if ending == ".csv":
        return _csv(path, array)
    raise fault(path, None, "it has no known ending: give .npz, .json, .csv, .holo or .bin")


def _csv(path: str | PathLike[str], array: Array | None) -> NDArray[np.complex64] | ControlPoints:
    data = content(path)
    line, head = next(rows(text(path, data)), (0, [""]))
    if not line:
        raise fault(path, None, f"no row is in it: {CSV}")
    names = {name.lower() for name in head}
    if names >= {"amplitude", "phase"}:
        return drive_from_csv(data, f'file "{path}"')
    if "intensity" in names:
        return control_points.read(path, data)
    values = [number(cell) for cell in head]
    both = pair.partners(path)
    counted = len(values) == 2 and all(
        value is not None and value >= 1 and value % 1 == 0 for value in values
    )
    if both is not None and (not counted or all(one.exists() for one in both)):
        return pair.read(*both)
    if counted:
        return acoustools.read(path, data, array)
    if names >= {"x", "y", "z"}:
        raise fault(path, line, "it holds transducers: read them by midair._files.read_array")
    raise fault(path, line, f'"{",".join(head)[:60]}" begins no table of drives: {CSV}')
