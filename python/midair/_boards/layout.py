"""Array data from files for `midair.Array`, and copies with changed parts."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, array_parts


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions and normals (N, 3) in m, other data of a file, named as in `midair.Array`; Hz of hardware."""

    positions: NDArray[np.float64]
    normals: NDArray[np.float64] | None = None
    source_pressure: float | None = None
    directivity: Any = None
    response: NDArray[np.float64] | None = None
    mask: NDArray[np.bool_] | None = None
    pins: NDArray[np.int64] | None = None
    quantization: Any = None
    frequency: float = 40e3


def changed(array: Array, **parts: Any) -> Array:
    """Return a copy of an array with some of its parts replaced."""
    own = {name: getattr(array, name) for name in ("positions", "normals", *array_parts())}
    return Array(**{**own, **parts})._with_hardware(array._hardware)
