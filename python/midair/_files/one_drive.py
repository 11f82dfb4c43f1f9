"""`.csv` of one drive, as `Solution.save` writes it: a row index,x,y,z,amplitude,phase a transducer.

Positions are in m, amplitudes 0 to 1, phases in rad. Where no array is known, positions are left out.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from .._support.text import columns, fault, picked, rows, text
from .played import ROUNDING, Played

NEEDED = ("amplitude", "phase")
CURE = "give index,x,y,z,amplitude,phase or index,amplitude,phase"


def write(path: Path, drives: Played) -> None:
    """Write one drive."""
    if drives.frames != 1:
        cure = 'give layout="acoustools" or "ultraino", or a name that ends in .npz'
        raise SceneError(f"{drives.frames} frames: this .csv holds one drive, {cure}")
    (drive,) = drives
    places: list[Sequence[float]] = [[]] * drives.transducers
    if drives.array is not None:
        places = drives.array.positions.tolist()
    with path.open("w", encoding="ascii", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["index", *("" if drives.array is None else "xyz"), *NEEDED])
        # Twice, because -1e-17 modulo 2 pi is 2 pi.
        phases = np.angle(drive) % (2 * np.pi) % (2 * np.pi)
        values = zip(places, np.abs(drive).tolist(), phases.tolist(), strict=True)
        table.writerows([index, *place, *rest] for index, (place, *rest) in enumerate(values))


def read(path: str | PathLike[str], data: bytes) -> NDArray[np.complex64]:
    """Read the drive (N,)."""
    table = rows(text(path, data))
    head, names = next(table)
    where = columns(path, head, names, NEEDED, CURE)
    indexed = "index" in where
    wanted = (*NEEDED, "index") if indexed else NEEDED
    values = []
    for index, (line, row) in enumerate(table):
        amplitude, phase, *told = picked(path, line, row, where, wanted)
        if indexed and told[0] != index:
            raise fault(path, line, f"index is {told[0]:g}: give {index}, a row for every transducer")
        if not 0 <= amplitude <= 1 + ROUNDING:
            raise fault(path, line, f"amplitude is {amplitude:g}: give 0 to 1")
        values.append(amplitude * np.exp(1j * phase))
    if not values:
        raise fault(path, None, f"no drive is in it: {CURE}")
    return np.array(values, np.complex64)
