"""Files of other programs and of boards, arrays and drives: `midair.read` and `midair.write`.

Each other module here reads or writes one format.
"""

from __future__ import annotations

import re
import tomllib
from os import PathLike
from pathlib import Path as File
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from .. import _midair
from .._boards import pat
from .._boards.board import Board, Layout
from .._midair import Array, Solution, array_parts, drive_from_csv, read_table, stated
from .._sequence import Sequence
from .._sequence.files import whole, write_csv
from .._support import output
from .._support.arguments import path_of, refused, shown, word
from .._support.text import ARRAYS, TEXTS, cells, content, fault, number, table, text, unpacked
from ..path import Path
from . import acoustools, control_points, geometry, played as board_frames, record, ultraino, xml
from .control_points import ControlPoints
from .played import Played, known, played

if TYPE_CHECKING:
    from .._midair import _Parts

__all__ = ["ControlPoints", "read", "read_array", "write"]


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
    | `.csv` of a drive, of frames (T, N); `.xml.gz` or `.xml` of Ultraino | the drive (N,) |
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
        if head[0].lower() != "frame":
            return drive_from_csv(data, f'file "{path}"')
        _, rows = read_table(data, f'file "{path}"', ["frame", "index", "amplitude", "phase"], units="")
        frames, rest = divmod(len(rows), max(int(rows[:, 1].max()) + 1, 1))
        if rest or (rows[:, :2] != np.argwhere(np.ones((frames, len(rows) // frames)))).any():
            raise fault(path, None, "its rows are not all transducers of one frame after another", CSV)
        drives: NDArray[np.complex64] = (rows[:, 2] * np.exp(1j * rows[:, 3])).astype(np.complex64)
        return drives.reshape(frames, -1)
    if "intensity" in names:
        return control_points.read(path, data)
    values = [number(cell) for cell in head]
    both = ultraino.partners(path)
    counted = len(values) == 2 and all(value is not None and value >= 1 and value % 1 == 0 for value in values)
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


def read_array(path: str | PathLike[str], *, unit: str | None = None, **parts: Unpack[_Parts]) -> Array:
    """Read an array from a file; a keyword replaces the values of the file or its format.

    Parameters
    ----------
    path : str or path
        File to read; its ending chooses the format, below.
    unit : {"m", "cm", "mm", "um"}, optional
        Unit of a table's positions; by default m. Columns whose names state a unit keep it.
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
    found = _layout(path, unit)
    given: dict[str, Any] = {name: value for name, value in parts.items() if value is not None}
    own = {name: getattr(found, name, None) for name in array_parts()}
    try:
        made = Array(found.positions, found.normals, **{**own, **given})
    except _midair.SceneError as error:
        raise fault(path, None, error) from error
    # Formats with a directivity describe real boards.
    return made._with_hardware(None if found.directivity is None else found.frequency)


def array_of(keys: str, folder: File | None) -> Array:
    """Read the array of a scene file's table `array.positions`; `keys` is its TOML."""
    given = tomllib.loads(keys)
    name = given["file"]
    if folder is None:
        cure = "this document has no folder to find files in, list the positions themselves"
        raise refused("file", name, cure)
    return read_array(folder / name, unit=given.get("unit"))


def _layout(path: str | PathLike[str], unit: str | None) -> Layout:
    ending = "".join(path_of("path", path).suffixes[-2:]).lower()
    listed = ending.endswith(".json") and LISTED.match(content(path, empty=True))
    if listed or ending.endswith((*TEXTS, *ARRAYS)):
        _, found = read_table(table(path), str(path), length="m" if unit is None else word("unit", unit))
        return Layout(found[:, :3], found[:, 3:] if found.shape[1] == 6 else None)
    if unit is not None:
        raise refused("unit", unit, "the file's format states its own, leave it out")
    if ending.endswith(".pat"):
        return _openmpd(path)
    if ending.endswith((".xml.gz", ".xml")):
        root = _xml(path)
        return ultraino.read(path, root) if root.name == "java" else geometry.read_handybeam(path, root)
    if ending.endswith(".json"):
        return geometry.read_autd3(path)
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


WRITTEN = (".npz", ".csv", ".json", ".holo", ".bin")
#: Formats that `Solution.save` writes.
SAVED = (".npz", ".json", "drive")
LAYOUTS = ("drive", "acoustools", "ultraino", "points")


def write(
    path: str | PathLike[str],
    drives: Any,
    *,
    board: Board | str | PathLike[str] | None = None,
    layout: str | None = None,
    rate: float | None = None,
    modulate: float | None = None,
) -> None:
    """Write drives (or control points) to a file, whole or not at all.

    Parameters
    ----------
    path : str or path
        File to write; its ending chooses the format, below.
    drives : midair.Solution, midair.Sequence, (N,) or (T, N) array_like, or midair.path.Path
        Complex drives of |q| <= 1; for "points" places (M, 3) or (T, M, 3) in m, a path or a sequence.
    board : midair.Board, str or path, optional
        A board, its name or .pat file; needed for .bin. Drives without an array get the board's array.
    layout : str, optional
        Layout of a .csv, see Notes; by default it follows from the content.
    rate : float, optional
        Frames per second of "points".
    modulate : float, optional
        Frequency in Hz at which the device modulates "points".

    Raises
    ------
    SceneError
        For data that a format cannot store and for a path that cannot be written.

    See Also
    --------
    midair.read : reads these files.

    Notes
    -----
    | ending | content | of |
    |---|---|---|
    | `.npz` | the file of `save` of a Solution or Sequence; of numbers `drive` or `drives` | any |
    | `.json` | the file of `Solution.save` | a Solution |
    | `.holo` | AcousTools: phases of 32 steps, amplitudes of 32 steps | any |
    | `.bin` | the board's frames, one after another | any, with `board` |
    | `.csv`, "drive" | [frame,]index,x,y,z,amplitude,phase; x,y,z if the array is known | any |
    | `.csv`, "acoustools" | a line frames,transducers, then phases in rad; amplitudes are lost | any |
    | `.csv`, "ultraino" | phases to ...0_Phase.csv, amplitudes to ...0_Amp.csv | any |
    | `.csv`, "points" | t,x,y,z,intensity[,frequency]: for Ultraleap's devices, no drives | points |

    Drives of 256 or 512 transducers in `.holo` and "acoustools" are those of one or two OpenMPD boards and
    are put into AcousTools' order; other numbers keep their order, with a warning. Without a layout, a name
    with 0_Phase means "ultraino".

    Examples
    --------
    >>> import midair, pathlib, tempfile
    >>> solution = midair.solve(midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.15]]))
    >>> path = pathlib.Path(tempfile.gettempdir(), "frame.bin")
    >>> midair.write(path, solution, board="sonicsurface")
    >>> path.stat().st_size
    258
    """
    file = path_of("path", path)
    output.check(file, WRITTEN)
    chosen = _layout_of(file, drives, layout)
    for name, value in (("rate", rate), ("modulate", modulate)):
        if value is not None and chosen != "points":
            raise refused(name, value, 'it is of control points: give layout="points", or leave it out')
    saves = isinstance(drives, Solution) and drives.scene is not None and chosen in SAVED
    if chosen == "points":
        given = control_points.control_points(drives, rate, modulate)
        with whole(file, (".csv",)) as part:
            control_points.write(part, given)
    elif saves or (isinstance(drives, Sequence) and chosen == ".npz"):
        drives.save(file)
    else:
        player = known(board)
        _write(file, chosen, played(drives, player), player)


def _layout_of(file: File, drives: Any, layout: str | None) -> str:
    """Return the layout of a .csv; for other files the ending."""
    ending = file.suffix.lower()
    if ending != ".csv":
        if layout is not None:
            raise refused("layout", layout, f"a {ending} file has but one, leave it out")
        return ending
    if layout is None:
        if isinstance(drives, Path | ControlPoints):
            return "points"
        return "ultraino" if ultraino.NAMED in file.name else "drive"
    found = word("layout", layout).lower().replace("-", "").replace("_", "")
    if found not in LAYOUTS:
        raise refused("layout", layout, f"give {', '.join(LAYOUTS[:-1])} or {LAYOUTS[-1]}")
    return found


def _write(file: File, layout: str, drives: Played, board: Board | None) -> None:
    if layout == "ultraino":
        ultraino.write_pair(file, drives)
        return
    if layout == ".json":
        cure = ".json holds a Solution of a scene, give .npz, .csv or .holo"
        raise stated("", f"output {shown(file)}", cure)
    with whole(file, WRITTEN) as part:
        if layout == ".bin":
            board_frames.write(part, drives, board)
        else:
            plain = {
                ".npz": record.write,
                ".holo": acoustools.write_holo,
                "acoustools": acoustools.write,
                "drive": _drive,
            }
            plain[layout](part, drives)


def _drive(path: File, drives: Played) -> None:
    write_csv(path, drives.array, drives, drives.frames)
