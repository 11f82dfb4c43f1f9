"""Array data from files for `midair.Array`, copies with changed parts, and detection of AUTD3 boards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, array_parts, stated

#: Largest errors of a transducer that still counts as part of an AUTD3 board: of its place in mm, of its
#: normal in rad.
TOLERANCE_MM = 0.01
LEAN = 1e-3


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions and normals (N, 3) in m, and other data of a file, named as in `midair.Array`."""

    positions: NDArray[np.float64]
    normals: NDArray[np.float64] | None = None
    source_pressure: float | None = None
    directivity: Any = None
    response: NDArray[np.float64] | None = None
    mask: NDArray[np.bool_] | None = None
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


def autd3_boards(array: Array) -> int:
    """Return the number of AUTD3 boards in an array. Each board has the preset's order and may lie anywhere.

    Each block of 249 transducers is compared with the preset after the best rotation in least squares (Kabsch
    1976, "A solution for the best rotation to relate two sets of vectors"). Raises SceneError if a transducer
    is more than 0.01 mm from its place, or does not face the direction of its board.
    """
    sites = 1e3 * Array.preset("autd3").positions
    boards, rest = divmod(len(array), len(sites))
    if rest or not boards:
        cure = f'each has {len(sites)}, in the order of midair.Array.preset("autd3")'
        raise stated("array", f"of {len(array)} transducers is none of AUTD3 boards", cure)
    centred = sites - sites.mean(0)
    for first in range(0, len(array), len(sites)):
        block = slice(first, first + len(sites))
        places = 1e3 * array.positions[block]
        left, _, right = np.linalg.svd(centred.T @ (places - places.mean(0)))
        # The determinant excludes mirror images.
        axes = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
        off = np.linalg.norm(places.mean(0) + centred @ axes - places, axis=1)
        lean = np.linalg.norm(array.normals[block] - axes[2], axis=1)
        refused = f"transducers {first} to {block.stop - 1} are no AUTD3 board"
        if off.max() > TOLERANCE_MM:
            found = f"transducer {first + int(off.argmax())} lies {off.max():.3g} mm off its place"
            cure = f'give them in the order of midair.Array.preset("autd3"), to {TOLERANCE_MM} mm'
            raise stated("", refused, f"{found}; {cure}")
        if lean.max() > LEAN:
            at = first + int(lean.argmax())
            facing, board = ((np.round(each, 4) + 0.0).tolist() for each in (array.normals[at], axes[2]))
            cure = "give normals that way, or count the rows from the other end"
            raise stated("", refused, f"transducer {at} faces {facing}, the board {board}; {cure}")
    return boards
