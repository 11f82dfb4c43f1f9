"""Array data from files for `midair.Array`, and copies with changed parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, array_parts


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions and normals (N, 3) in m, and other data of a file, named as in `midair.Array`."""

    positions: NDArray[np.float64]
    normals: NDArray[np.float64] | None = None
    source_pressure: float | None = None
    directivity: Any = None
    response: NDArray[np.float64] | None = None
    mask: NDArray[np.bool_] | None = None
    pins: NDArray[np.int64] | None = None
    quantization: Any = None


def changed(array: Array, **parts: Any) -> Array:
    """Return a copy of an array with some of its parts replaced."""
    own = {name: getattr(array, name) for name in ("positions", "normals", *array_parts())}
    return Array(**{**own, **parts})._with_hardware(array._hardware)


def turned(quaternions: NDArray[np.float64], vector: Sequence[float]) -> NDArray[np.float64]:
    """Rotate a vector (3,) by quaternions (B, 4), w x y z, of any length: v + 2 u x (u x v + w v), (B, 3)."""
    unit = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    w, u = unit[:, :1], unit[:, 1:]
    given = np.broadcast_to(np.array(vector, np.float64), u.shape)
    found: NDArray[np.float64] = given + 2 * np.cross(u, np.cross(u, given) + w * given)
    return found
