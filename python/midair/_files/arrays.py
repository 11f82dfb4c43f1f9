"""`midair._files.read_array`: an array from a file of its maker's format."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np

from .._boards import pat
from .._boards.layout import Layout
from .._midair import Array, SceneError, array_parts, read_table
from .._support.arguments import path_of
from .._support.text import content, fault, unpacked
from . import arrays as positions
from . import autd3, handybeam, ultraino, xml


def read(path: str | PathLike[str]) -> Layout:
    """Read a row for each transducer."""
    _, table = read_table(content(path, empty=True), str(path))
    return Layout(table[:, :3], table[:, 3:] if table.shape[1] == 6 else None)


#: Larger files are of no array; the largest known, Ultraino's, unpacks to 5 MB.
MOST_BYTES = 64 << 20

ENDINGS = (
    ".pat (OpenMPD), .xml.gz or .xml (Ultraino), .xml (HandyBeam), .json (AUTD3) or .csv (x,y,z,nx,ny,nz)"
)


def read_array(path: str | PathLike[str], **parts: Any) -> Array:
    """An array from a file, in m: a keyword that is given counts, else what the file or its format says.

    - `.pat`, a board of OpenMPD: P0 3.4 Pa m, piston of 4.5 mm, the board's grid; gains are responses.
    - `.xml.gz` or `.xml` of Ultraino, by orderNumber: P0 is `power`, else 2.53; sinc of
      `apperture`, else 9 mm. Its y is up: (x, y, z) is here (x, -z, y).
    - `.xml` of HandyBeam, by Index: cos 3.376; a transducer with ABX "X" is off in the mask.
    - `.json` of AUTD3, as Geometry.to_json writes, board after board: as the preset `autd3`.
    - `.csv`: x,y,z or x,y,z,nx,ny,nz, as scene files read them.

    What no file says is that of `midair.Array`. All but `.csv` are of boards: scenes on them that state no
    medium have air of 25 degrees C. Positions are those of the file, not centred; a flat board
    of OpenMPD, Ultraino or HandyBeam lies in z = 0 and radiates to +z. Phase corrections are no part of an
    array: a board applies them when it plays.

    Raises SceneError for a file that is not in order, naming the line; FileNotFoundError where there is none.
    """
    found = _layout(path)
    given = {name: value for name, value in parts.items() if value is not None}
    own = {name: getattr(found, name, None) for name in array_parts()}
    try:
        made = Array(found.positions, found.normals, **{**own, **given})
    except SceneError as error:
        raise fault(path, None, str(error)) from error
    # A format that says how its transducers radiate is of a board.
    return made._with_hardware(None if found.directivity is None else 40e3)


def _layout(path: str | PathLike[str]) -> Layout:
    ending = "".join(path_of("path", path).suffixes[-2:]).lower()
    if ending.endswith(".pat"):
        return _openmpd(path)
    if ending.endswith((".xml.gz", ".xml")):
        return _xml(path)
    if ending.endswith(".json"):
        return autd3.read(path)
    if ending.endswith(".csv"):
        return positions.read(path)
    raise fault(path, None, f"it has no known ending: give {ENDINGS}")


def _openmpd(path: str | PathLike[str]) -> Layout:
    """P0 as AcousTools has it, Murata's MA40S4S as a piston."""
    found = pat.read(path)
    grid = Array.preset("openmpd_board").quantization or {}
    return Layout(
        found.positions,
        source_pressure=3.4,
        directivity={"piston": 4.5e-3},
        response=None if np.all(found.gains == 1) else found.gains,
        quantization={**grid, "phases": found.divisions},
    )


def _xml(path: str | PathLike[str]) -> Layout:
    data = content(path, MOST_BYTES)
    if data[:2] == b"\x1f\x8b":
        data = unpacked(path, data, "gzip", MOST_BYTES)
    root = xml.parse(path, data)
    return ultraino.read(path, root) if root.name == "java" else handybeam.read(path, root)
