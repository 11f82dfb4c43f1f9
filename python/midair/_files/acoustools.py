"""AcousTools' order of transducers, and its `.csv` of phases (JoshuaMukherjee/AcousTools 1.2, Export/CSV.py).

Two boards of OpenMPD, 512 transducers: its own order is the top board first, x slow, then y, both from the
lowest. In its .csv, which OpenMPD reads, the top board is reversed, and so is each run of 16 of the bottom
board. Our drives are those of `Array.preset("openmpd_pair")`, or of an array whose transducers stand like
these. Arrays of any other number of transducers keep their order. The first line is `frames,transducers`,
then there are phases in rad, a line a frame; there are no amplitudes.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, SceneError
from .._support.arguments import warn
from .._support.text import fault, number, numbers, rows, text
from .played import Played, one_or_more

#: Transducers of two boards, of one, and of a side.
PAIR, BOARD, SIDE = 512, 256, 16

#: In m: transducers of a pair stand so near to their places.
NEAR = 2e-3

#: Amplitudes below this give a warning that they are lost.
FULL = 1 - 1e-3


def own_order(array: Array | None, transducers: int) -> NDArray[np.intp]:
    """Indices (N,) of our transducers in AcousTools' order."""
    if array is not None and len(array) != transducers:
        raise SceneError(f"drives of {transducers} transducers, an array of {len(array)}: give another board")
    if transducers != PAIR:
        return np.arange(transducers)
    array = Array.preset("openmpd_pair") if array is None else array
    places, down = array.positions, array.normals[:, 2] < 0
    side = (np.arange(SIDE) - (SIDE - 1) / 2) * 10.5e-3
    found = []
    for board in (down, ~down):
        for x in side:
            for y in side:
                away = np.hypot(places[:, 0] - x, places[:, 1] - y)
                found.append(np.where(board, away, np.inf).argmin())
                if not (board.any() and away[found[-1]] < NEAR):
                    cure = "give drives of openmpd_pair, or another format"
                    raise SceneError(
                        f"the array has 512 transducers, but not those of two OpenMPD boards: {cure}"
                    )
    return np.array(found)


def csv_order(array: Array | None, transducers: int) -> NDArray[np.intp]:
    """Indices (N,) of our transducers in the order of the columns."""
    own = own_order(array, transducers)
    if transducers != PAIR:
        return own
    runs = own[BOARD:].reshape(SIDE, SIDE)
    return np.concatenate([own[:BOARD][::-1], runs[:, ::-1].ravel()])


def write(path: Path, drives: Played) -> None:
    """Write phases; amplitudes are lost, and it is said so."""
    order = csv_order(drives.array, drives.transducers)
    least = 1.0
    with path.open("w", encoding="ascii", newline="\n") as stream:
        stream.write(f"{drives.frames},{drives.transducers}\n")
        for drive in drives:
            least = min(least, float(np.abs(drive).min()))
            stream.write(",".join(f"{phase:.9g}" for phase in np.angle(drive[order]).tolist()) + "\n")
    if least < FULL:
        reported = f"amplitudes down to {least:.3g} are not written"
        cure = "AcousTools' .csv holds phases alone, and plays them at full amplitude; .holo keeps amplitudes"
        warn(f"{reported}: {cure}")


def read(path: str | PathLike[str], data: bytes, array: Array | None = None) -> NDArray[np.complex64]:
    """Read drives of an array, of amplitude 1, (N,) of one frame, else (T, N)."""
    table = rows(text(path, data))
    line, head = next(table)
    frames, transducers = (int(number(cell) or 0) for cell in head)
    # A number takes two bytes at least, with what follows it.
    if not 2 <= 2 * frames * transducers <= len(data):
        reported = f"{frames} frames of {transducers} transducers are stated, more than the file can contain"
        raise fault(path, line, f"{reported}: get the file again")
    order = csv_order(array, transducers)
    drives = np.empty((frames, transducers), np.complex64)
    frame = 0
    for line, cells in table:
        if frame == frames:
            raise fault(path, line, f"{frames} frames are stated and more are there: get the file again")
        if len(cells) != transducers:
            raise fault(path, line, f"{len(cells)} phases: give one for each of {transducers} transducers")
        drives[frame, order] = np.exp(1j * numbers(path, line, cells))
        frame += 1
    if frame < frames:
        raise fault(path, line, f"{frames} frames are stated and {frame} are there: get the file again")
    return one_or_more(drives)
