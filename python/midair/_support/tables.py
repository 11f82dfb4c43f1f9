"""Tables of numbers in files: the core reads text, JSON and .npy; .npz and .mat are converted for it."""

import io
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .._midair import SceneError
from .arguments import needs
from .text import array, arrays, content, fault

#: Endings of tables that are text or lists in JSON; and of arrays of NumPy and MATLAB.
TEXTS, ARRAYS = (".csv", ".txt", ".tsv", ".dat"), (".npy", ".npz", ".mat")


def table(path: str | PathLike[str]) -> bytes:
    """Return the bytes of a table as the core reads it: text, JSON or .npy."""
    ending = Path(path).suffix.lower()
    if ending not in ARRAYS:
        return content(path, empty=True)
    try:
        if ending == ".npy":
            found = array(path)
        else:
            found = _only(path, arrays(path) if ending == ".npz" else _matlab(path))
        if np.iscomplexobj(found):
            raise fault(path, None, "its numbers are complex", "give real numbers in m")
        numbers = np.ascontiguousarray(found, "<f8")
    except SceneError:
        raise
    except (ValueError, TypeError) as error:
        raise fault(path, None, f"its numbers cannot be read ({error})", "give an array (N, 3)") from error
    packed = io.BytesIO()
    np.save(packed, numbers)
    return packed.getvalue()


def _matlab(path: str | PathLike[str]) -> dict[str, Any]:
    """Return the arrays of a .mat file; those of version 7.3 are HDF5, which SciPy does not read."""
    with needs("a .mat file needs SciPy", "mesh"):
        from scipy.io import loadmat
    try:
        found = loadmat(io.BytesIO(content(path)))
    except SceneError:
        raise
    # SciPy raises errors of many kinds for a damaged file, and NotImplementedError for version 7.3.
    except Exception as error:
        cure = 'save it by save(name, variable, "-v7")'
        raise fault(path, None, "SciPy cannot read it, damaged or of version 7.3", cure) from error
    return {name: value for name, value in found.items() if not name.startswith("__")}


def _only(path: str | PathLike[str], found: dict[str, Any]) -> Any:
    """Return the positions among named arrays: `positions`, x, y and z, or the only one."""
    if "positions" in found:
        return found["positions"]
    if {"x", "y", "z"} <= set(found):
        return np.stack([np.ravel(found[axis]) for axis in "xyz"], axis=1)
    if len(found) == 1:
        return next(iter(found.values()))
    names = ", ".join(found) or "none"
    raise fault(path, None, f"its arrays are {names}", "give one array (N, 3), or name it positions")
