"""`.pat`: file of a measured OpenMPD board (RMResearch/OpenMPD, Docs/GS_PAT_BoardFileFormat).

It has seven lines: the serial number; 256, the number of transducers; 128, the number of phases in a period;
positions "(x, y, z)," in m; the pin of each transducer; phase corrections in degrees; gains, which are 1, or
0 for a dead transducer. Lists end with a comma.
"""

import re
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._support.text import fault, numbers, text

#: Number of transducers of a board.
COUNT = 256

LINES = ["serial number", "number of transducers", "divisions of a period", "positions", "pins"]
LINES += ["corrections", "gains"]


class Pat(NamedTuple):
    """Data of an OpenMPD board; the transducers are in the order of the file, index t = 16 x + y.

    Attributes
    ----------
    positions
        (256, 3) in m, in z = 0; the transducers radiate to +z.
    divisions
        Number of phases in a period.
    pins
        (256,): the index of each transducer's byte in a frame.
    corrections
        (256,) in degrees; phase sent = wanted phase - correction.
    gains
        (256,): 1, or 0 for a dead transducer.
    """

    serial: str
    positions: NDArray[np.float64]
    divisions: int
    pins: NDArray[np.int64]
    corrections: NDArray[np.float64]
    gains: NDArray[np.float64]


def read(path: str | PathLike[str]) -> Pat:
    """Read a .pat file. Errors name the line."""
    lines = text(path).rstrip().splitlines()
    lines += [""] * (len(LINES) - len(lines))
    for line, (what, found) in enumerate(zip(LINES, lines, strict=False), 1):
        if not found.strip():
            raise fault(path, line, f"the {what} are missing", "a .pat file has seven lines")
    count = _whole(path, 2, lines[1], COUNT, COUNT)
    divisions = _whole(path, 3, lines[2], 2, 65536)
    positions = _positions(path, lines[3])
    pins = _list(path, 5, lines[4])
    wrong = (pins != np.rint(pins)) | (pins < 0) | (pins >= count)
    if wrong.any():
        raise fault(path, 5, f"pin {pins[wrong][0]:g} is none", f"give each of 0 to {count - 1} once")
    often = np.bincount(pins.astype(np.int64), minlength=count)
    if (often != 1).any():
        twice, missing = int(often.argmax()), int(often.argmin())
        cure = f"give each of 0 to {count - 1} once"
        raise fault(path, 5, f"pin {twice} is there {often[twice]} times, pin {missing} is missing", cure)
    corrections, gains = _list(path, 6, lines[5]), _list(path, 7, lines[6])
    if (gains < 0).any():
        raise fault(path, 7, f"gain {gains[gains < 0][0]:g} is negative", "give 1, or 0 where it is dead")
    if len(lines) > len(LINES):
        raise fault(path, 8, f"{len(lines)} lines", "a .pat file has seven")
    board = Pat(lines[0].strip(), positions, divisions, pins.astype(np.int64), corrections, gains)
    for values in (board.positions, board.pins, board.corrections, board.gains):
        values.flags.writeable = False
    return board


def _whole(path: str | PathLike[str], line: int, found: str, least: int, most: int) -> int:
    what, value = LINES[line - 1], found.strip().rstrip(",")
    if not (value.isascii() and value.isdecimal() and least <= int(value[:9]) <= most):
        bound = f"{least}" if least == most else f"a whole number from {least} to {most}"
        raise fault(path, line, f'{what} is "{value[:40]}"', f"give {bound}")
    return int(value)


def _positions(path: str | PathLike[str], found: str) -> NDArray[np.float64]:
    triples = re.findall(r"\(([^()]*)\)", found)
    rest = re.sub(r"\([^()]*\)", "", found).replace(",", "").strip()
    if rest:
        raise fault(path, 4, f'"{rest[:40]}" is no position', "give (x, y, z) in m, with commas between")
    if len(triples) != COUNT:
        cure = f"give (x, y, z) in m for each of {COUNT} transducers"
        raise fault(path, 4, f"{len(triples)} positions", cure)
    for index, triple in enumerate(triples):
        if triple.count(",") != 2:
            raise fault(path, 4, f"position {index} is ({triple})", "give three numbers, x, y, z in m")
    names = [f"{axis} of position {index}" for index in range(COUNT) for axis in "xyz"]
    cells = [cell.strip() for triple in triples for cell in triple.split(",")]
    return numbers(path, 4, cells, names).reshape(COUNT, 3)


def _list(path: str | PathLike[str], line: int, found: str) -> NDArray[np.float64]:
    cells = [cell.strip() for cell in found.strip().removesuffix(",").split(",")]
    what = LINES[line - 1]
    if len(cells) != COUNT:
        cure = f"give one for each of {COUNT} transducers in this line, with commas between"
        raise fault(path, line, f"{len(cells)} {what}", cure)
    return numbers(path, line, cells, [f"{what.removesuffix('s')} {index}" for index in range(COUNT)])
