"""`.npz`: a Solution or Sequence as it saves itself, or complex64 alone: `drive` (N,) or `drives` (T, N)."""

from __future__ import annotations

import zipfile
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError, Solution
from .._motion import Sequence
from .._support.text import MOST_BYTES, arrays, fault
from .played import ROUNDING, Played

CURE = "give what Solution.save, Sequence.save or midair.write wrote"


def write(path: Path, drives: Played) -> None:
    """Write drives alone."""
    name: Any = {"drive" if drives.alone else "drives": drives.all()}
    np.savez(path, **name)


def read(path: str | PathLike[str]) -> Solution | Sequence | NDArray[np.complex64]:
    """Read what is in it; nothing in it is run."""
    try:
        with zipfile.ZipFile(path) as found:
            sizes = {entry.filename.removesuffix(".npy"): entry.file_size for entry in found.infolist()}
    except OSError as error:
        reason = error.strerror or str(error)
        raise fault(path, None, f"it cannot be read ({reason}): give a file that is there") from error
    # Whatever a damaged file makes zip raise.
    except Exception as error:
        raise fault(path, None, f"it is damaged, or no .npz: {CURE}") from error
    if "setting" in sizes:
        return Sequence.load(path)
    if "scene" in sizes:
        return Solution.load(path)
    alone = "drive" in sizes
    name = "drive" if alone else "drives"
    if name not in sizes:
        raise fault(path, None, f"there is no drive in it: {CURE}")
    if sizes[name] > MOST_BYTES:
        raise fault(path, None, f"{name} unpacks to more than {MOST_BYTES >> 20} MB: give a smaller one")
    return _drives(path, name, 1 if alone else 2)


def _drives(path: str | PathLike[str], name: str, dimensions: int) -> NDArray[np.complex64]:
    try:
        drives = arrays(path, [name])[name]
    except SceneError as error:
        raise fault(path, None, str(error)) from error
    except (ValueError, KeyError) as error:
        raise fault(path, None, f"{name} is damaged, or no numbers: {CURE}") from error
    if drives.dtype.kind not in "fc" or drives.ndim != dimensions or not drives.size:
        reported = f"{drives.dtype} of shape {drives.shape}"
        raise fault(
            path, None, f"{name} is {reported}: give complex64, {'(N,)' if dimensions == 1 else '(T, N)'}"
        )
    wrong = np.argwhere(~(np.abs(drives) <= 1 + ROUNDING))
    if len(wrong):
        place = tuple(wrong[0].tolist())
        reported = f"{name}{list(place)} is {drives[place]}"
        raise fault(path, None, f"{reported}: give finite numbers, at most 1 in modulus")
    return np.asarray(drives, np.complex64)
