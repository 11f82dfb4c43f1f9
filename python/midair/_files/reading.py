"""`midair.read` and `midair.Array.from_file`: read a file by its ending and content."""

from __future__ import annotations

import re
import tomllib
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from .._boards import pat
from .._boards.board import Board
from .._boards.layout import Layout
from .._midair import Array, SceneError, Solution, array_parts, drive_from_csv, read_table
from .._sequence import Sequence
from .._support.arguments import path_of, refused
from .._support.tables import ARRAYS, TEXTS, table
from .._support.text import cells, content, fault, number, text, unpacked
from . import acoustools, autd3, control_points, handybeam, played as board_frames, record, ultraino, xml
from .control_points import ControlPoints
from .played import known

if TYPE_CHECKING:
    from .._midair import _Parts

CSV = (
    "give index,x,y,z,amplitude,phase, or t,x,y,z,intensity, or AcousTools' frames,transducers,"
    " or Ultraino's pair ...0_Phase.csv and ...0_Amp.csv"
)


def read(
    path: str | PathLike[str], *, board: Board | str | PathLike[str] | None = None
) -> Solution | Sequence | NDArray[np.complex64] | ControlPoints:
    """Read a file of `midair.write`, `save` or another program.

    Parameters
    ----------
    path : str or path
        File to read; nothing in it is executed.
    board : midair.Board, str or path, optional
        Board of the frames of a .bin, its name or .pat file.

    Returns
    -------
    midair.Solution, midair.Sequence, ndarray of complex64 or ControlPoints
        The content of the file, see Notes.

    Raises
    ------
    SceneError
        For a file with an error, naming the line.

    See Also
    --------
    midair.write : writes these files.

    Notes
    -----
    | file | result |
    |---|---|
    | `.npz`, `.json` | the Solution or Sequence, or drives alone |
    | `.holo`, `.csv` of AcousTools or Ultraino, `.bin` | drives, complex64: (N,) of one frame, else (T, N) |
    | `.csv` of a drive; `.xml.gz` or `.xml` of Ultraino | the drive (N,) |
    | `.csv` of control points | times, points, intensities and frequencies: midair._files.ControlPoints |

    The first row of a .csv identifies its kind; Ultraino's has none and is identified by its name. Drives
    of 256 or 512 transducers from AcousTools are in the order of the board's array, by default
    `openmpd_board` or `openmpd_pair`.

    Examples
    --------
    >>> import midair, tempfile
    >>> solution = midair.solve(midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]]))
    >>> path = f"{tempfile.gettempdir()}/focus.npz"
    >>> midair.write(path, solution)
    >>> midair.read(path) == solution
    True
    """
    ending, player = path_of("path", path).suffix.lower(), known(board)
    array = None if player is None else player.array
    if ending == ".npz":
        return record.read(path)
    if ending == ".json":
        content(path)
        return Solution.load(path)
    if ending == ".holo":
        return acoustools.read_holo(path, array)
    if ending == ".bin":
        return board_frames.read(path, player)
    if ending == ".csv":
        return _csv(path, array)
    if ending in (".xml", ".gz"):
        root = _xml(path)
        if root.name == "java":
            return ultraino.read_drive(path, root)
        raise fault(path, None, "no drive is in it", "read its array by midair.Array.from_file")
    raise fault(path, None, "it has no known ending", "give .npz, .json, .csv, .holo, .bin or .xml.gz")


def _csv(path: str | PathLike[str], array: Array | None) -> NDArray[np.complex64] | ControlPoints:
    data = content(path)
    each = enumerate(text(path, data).splitlines(), 1)
    line, first = next(((line, row) for line, row in each if row.strip() and not PASSED.match(row)), (0, ""))
    if not line:
        raise fault(path, None, "no row is in it", CSV)
    head = cells(first)
    names = set(re.findall("[a-z]+", first.lower()))
    if names >= {"amplitude", "phase"}:
        return drive_from_csv(data, f'file "{path}"')
    if "intensity" in names:
        return control_points.read(path, data)
    values = [number(cell) for cell in head]
    both = ultraino.partners(path)
    counted = len(values) == 2 and all(
        value is not None and value >= 1 and value % 1 == 0 for value in values
    )
    if both is not None and (not counted or all(one.exists() for one in both)):
        return ultraino.read_pair(*both)
    if counted:
        return acoustools.read(path, data, array)
    if names >= {"x", "y", "z"} or (len(values) in (3, 6) and None not in values):
        raise fault(path, line, "it holds transducers", "read them by midair.Array.from_file")
    raise fault(path, line, f'"{",".join(head)[:60]}" begins no table of drives', CSV)


#: Lines that tables pass over: comments, and the separator that Excel names.
PASSED = re.compile(r'\s*(#|%|//|"?sep=)', re.IGNORECASE)
#: JSON of a table: a list of lists, or of objects with x.
LISTED = re.compile(rb'\s*\[\s*(?:[\[\d.+-]|\{[^{}]*"[xX][" (\[_/])')
#: Largest size in bytes of a file of an array; the largest known one, Ultraino's, unpacks to 5 MB.
MOST_BYTES = 64 << 20

ENDINGS = (
    ".pat (OpenMPD), .xml.gz or .xml (Ultraino), .xml (HandyBeam), .json (AUTD3), or x,y,z,nx,ny,nz"
    f" in {', '.join((*TEXTS, '.json', *ARRAYS[:-1]))} or {ARRAYS[-1]}"
)


def read_array(path: str | PathLike[str], **parts: Unpack[_Parts]) -> Array:
    """Read an array from a file; a keyword replaces the values of the file or its format.

    Parameters
    ----------
    path : str or path
        File to read; its ending chooses the format, below.
    **parts
        Keywords of `midair.Array`, such as mask and pins.

    Returns
    -------
    midair.Array
        The array; positions are those of the file in m, not centred.

    Raises
    ------
    SceneError
        For a missing file, and one with an error, naming the line.

    Notes
    -----
    - `.pat`, a board of OpenMPD: P0 3.4 Pa m, piston of 4.5 mm, the board's grid; gains are responses.
    - `.xml.gz` or `.xml` of Ultraino, by orderNumber: P0 is `power`, else 2.53; sinc of
      `apperture`, else 9 mm; pins are `driverPinNumber`. Its y is up: (x, y, z) is here (x, -z, y).
    - `.xml` of HandyBeam, by Index: cos 3.376; a transducer with ABX "X" is off in the mask.
    - `.json` of AUTD3, as Geometry.to_json writes, board after board: as the preset `autd3`.
    - `.csv`, `.txt`, `.tsv`, `.dat`, `.json` of a list, `.npy`, `.npz`, `.mat`: x,y,z or x,y,z,nx,ny,nz
      (docs/files.md).

    Other parts have the values of `midair.Array`. All but tables are of boards: scenes on them that state no
    medium have air of 25 degrees C. A flat board of OpenMPD, Ultraino or HandyBeam lies in z = 0 and radiates
    to +z. Phase corrections are no part of an array: a board applies them when it plays.
    """
    found = _layout(path)
    given: dict[str, Any] = {name: value for name, value in parts.items() if value is not None}
    own = {name: getattr(found, name, None) for name in array_parts()}
    try:
        made = Array(found.positions, found.normals, **{**own, **given})
    except SceneError as error:
        raise fault(path, None, error) from error
    # Formats with a directivity describe real boards.
    return made._with_hardware(None if found.directivity is None else found.frequency)


def array_of(keys: str, folder: Path | None) -> Array:
    """Read the array of a scene file's table `array.positions`; `keys` is its TOML."""
    name = tomllib.loads(keys)["file"]
    if folder is None:
        cure = "this document has no folder to find files in, list the positions themselves"
        raise refused("file", name, cure)
    return read_array(folder / name)


def _layout(path: str | PathLike[str]) -> Layout:
    ending = "".join(path_of("path", path).suffixes[-2:]).lower()
    if ending.endswith(".pat"):
        return _openmpd(path)
    if ending.endswith((".xml.gz", ".xml")):
        root = _xml(path)
        return ultraino.read(path, root) if root.name == "java" else handybeam.read(path, root)
    listed = ending.endswith(".json") and LISTED.match(content(path, empty=True))
    if ending.endswith(".json") and not listed:
        return autd3.read(path)
    if listed or ending.endswith((*TEXTS, *ARRAYS)):
        _, found = read_table(table(path), str(path))
        return Layout(found[:, :3], found[:, 3:] if found.shape[1] == 6 else None)
    raise fault(path, None, "it has no known ending", f"give {ENDINGS}")


def _openmpd(path: str | PathLike[str]) -> Layout:
    """Read an OpenMPD board; source pressure as in AcousTools, Murata's MA40S4S as a piston."""
    found = pat.read(path)
    grid = Array.preset("openmpd_board").quantization or {}
    return Layout(
        found.positions,
        source_pressure=3.4,
        directivity={"piston": 4.5e-3},
        response=None if np.all(found.gains == 1) else found.gains,
        quantization={**grid, "phases": found.divisions},
        pins=found.pins,
    )


def _xml(path: str | PathLike[str]) -> xml.Element:
    """Return the root element of an XML file, unpacked."""
    data = content(path, MOST_BYTES)
    if data[:2] == b"\x1f\x8b":
        data = unpacked(path, data, "gzip", MOST_BYTES)
    return xml.parse(path, data)
