"""`.csv` of one drive, as `Solution.save` writes it: a row index,x,y,z,amplitude,phase a transducer.

Positions are in m, amplitudes 0 to 1, phases in rad. Without a known array there are no positions.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError, drive_from_csv, drive_to_csv
from .played import Played


def write(path: Path, drives: Played) -> None:
    """Write one drive."""
    if drives.frames != 1:
        cure = 'give layout="acoustools" or "ultraino", or a name that ends in .npz'
        raise SceneError(f"{drives.frames} frames: this .csv holds one drive, {cure}")
    (drive,) = drives
    positions = None if drives.array is None else drives.array.positions
    path.write_bytes(drive_to_csv(drive, positions).encode())


def read(path: str | PathLike[str], data: bytes) -> NDArray[np.complex64]:
    """Read the drive (N,)."""
    return drive_from_csv(data, f'file "{path}"')
