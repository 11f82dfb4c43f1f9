"""Arrays of AUTD3, `.json`, and of HandyBeam, `.xml`.

Geometry.to_json of autd3-core 0.12 writes a list of boards, {"origin": [x, y, z], "rotation": [w, x, y, z]}.
The origin, in mm, is the place of transducer 0. The rotation is a unit quaternion. A board has 249
transducers (autd3-core, devices/autd3.rs) and radiates along its +z.

HandyBeam's are those of "Acoustic Renderer" (ultraleap/HandyBeam, tx_array_library.py), in mm. Each
System/Transducers/Transducer has Index, Xmm, Ymm, Zmm, and ABX, which is "X" if the transducer is off.
Normals are +z. HandyBeam's directivity is cos(theta)^3.376.
"""

import json
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._boards.board import Layout
from .._midair import Array
from .._support.text import fault, number, text
from .xml import Element

#: Largest number of boards in a file.
MOST_BOARDS = 128


def read_autd3(path: str | PathLike[str]) -> Layout:
    """Read the boards in the order of the file, each in the order of its transducers."""
    try:
        boards = json.loads(text(path), parse_int=float)
    except json.JSONDecodeError as error:
        cure = "give what Geometry.to_json wrote"
        raise fault(path, error.lineno, f"it is no JSON ({error.msg})", cure) from error
    except RecursionError as error:
        raise fault(path, None, "its lists nest too deep", "give what Geometry.to_json wrote") from error
    if not isinstance(boards, list):
        cure = "give a list of boards, as Geometry.to_json writes"
        if isinstance(boards, dict) and "array" in boards:
            cure = "this is a scene file, read it by midair.Scene.load"
        raise fault(path, None, "it is no list", cure)
    if not 1 <= len(boards) <= MOST_BOARDS:
        raise fault(path, None, f"{len(boards)} boards", f"give 1 to {MOST_BOARDS}")
    origins = np.array([_numbers(path, index, board, "origin", "xyz") for index, board in enumerate(boards)])
    turns = np.array([_numbers(path, index, board, "rotation", "wxyz") for index, board in enumerate(boards)])
    for index, length in enumerate(np.linalg.norm(turns, axis=1)):
        if abs(length - 1) > 1e-3:
            cure = "give a unit quaternion"
            raise fault(path, None, f"rotation of board {index} has length {length:g}", cure)
    board = Array.preset("autd3")
    board = board.moved(translation=-board.positions[0])
    poses = zip(turns, origins / 1e3, strict=True)
    rig = Array.join([board.moved(rotation=turn, translation=origin) for turn, origin in poses])
    return Layout(
        rig.positions,
        rig.normals,
        source_pressure=board.source_pressure,
        directivity=board.directivity,
        quantization=board.quantization,
    )


def _numbers(path: str | PathLike[str], index: int, board: Any, name: str, axes: str) -> NDArray[np.float64]:
    found = board.get(name) if isinstance(board, dict) else None
    plain = isinstance(found, list) and len(found) == len(axes)
    if not plain or not all(type(one) is float and np.isfinite(one) for one in found or []):
        reported = json.dumps(found)[:60]
        cure = f"give [{', '.join(axes)}]{', in mm' if name == 'origin' else ', a unit quaternion'}"
        raise fault(path, None, f"{name} of board {index} is {reported}", cure)
    return np.array(found, np.float64)


def read_handybeam(path: str | PathLike[str], root: Element) -> Layout:
    """Read all System/Transducers/Transducer elements, in the order of Index."""
    found = [root]
    for name in ("System", "Transducers", "Transducer"):
        found = [child for element in found for child in element.children if child.name == name]
    if not found:
        cure = "give an array of HandyBeam or Ultraino"
        raise fault(path, None, "no System/Transducers/Transducer is in it", cure)
    positions = np.full((len(found), 3), np.nan)
    mask = np.ones(len(found), np.bool_)
    for element in found:
        index = element.attributes.get("Index", "")
        cure = f"give each of 0 to {len(found) - 1} once"
        if not (index.isascii() and index.isdecimal() and int(index[:9]) < len(found)):
            raise fault(path, element.line, f'Index is "{index[:40]}"', cure)
        place = int(index)
        if not np.isnan(positions[place, 0]):
            raise fault(path, element.line, f"Index {place} is there twice", cure)
        for axis, name in enumerate(("Xmm", "Ymm", "Zmm")):
            cell = element.attributes.get(name, "")
            value = number(cell)
            if value is None:
                raise fault(path, element.line, f'{name} is "{cell[:40]}"', "give a finite number in mm")
            positions[place, axis] = value / 1e3
        mask[place] = element.attributes.get("ABX") != "X"
    return Layout(positions, directivity={"cos": 3.376}, mask=None if mask.all() else mask)
