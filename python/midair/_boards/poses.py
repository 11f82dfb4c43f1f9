"""Poses of AUTD3 boards: where each board of an array of 249, 498, ... lies, and how it is turned."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, SceneError
from .layout import turned

_Rows = NDArray[np.float64]

#: How far a transducer may lie off its place on a board.
TOLERANCE_MM = 0.01
#: How far its normal may lean, in rad.
LEAN = 1e-3


class Pose(NamedTuple):
    """Where a board lies: its first transducer in mm, and the unit quaternion (w, x, y, z) that turns it."""

    origin: tuple[float, float, float]
    rotation: tuple[float, float, float, float]


def poses(array: Array) -> list[Pose]:
    """The pose of each board of an array of AUTD3 boards, 249 transducers each, ordered as preset "autd3".

    Raises `SceneError` where a block of 249 is no such board: a transducer lies more than 0.01 mm off its
    place, or faces elsewhere than the board does.
    """
    board = Array.preset("autd3").positions
    boards, rest = divmod(len(array), len(board))
    if rest or not boards:
        raise SceneError(
            f"array of {len(array)} transducers is none of AUTD3 boards: each has {len(board)}, "
            'in the order of midair.Array.preset("autd3")'
        )
    sites = 1e3 * (board - board[0])
    blocks = zip(np.split(1e3 * array.positions, boards), np.split(array.normals, boards), strict=True)
    return [_pose(sites, places, normals, k) for k, (places, normals) in enumerate(blocks)]


def _pose(sites: _Rows, places: _Rows, normals: _Rows, k: int) -> Pose:
    """The pose that brings the sites of a board, in mm, to the places; refused where none does."""
    first, last = k * len(sites), (k + 1) * len(sites) - 1
    rotation = _rotation(sites - sites.mean(0), places - places.mean(0))
    axes = np.stack([turned(rotation[None], axis)[0] for axis in np.eye(3).tolist()])
    origin = places.mean(0) - sites.mean(0) @ axes
    off = np.linalg.norm(origin + sites @ axes - places, axis=1)
    lean = np.linalg.norm(normals - axes[2], axis=1)
    refused = f"transducers {first} to {last} are no AUTD3 board"
    if off.max() > TOLERANCE_MM:
        raise SceneError(
            f"{refused}: transducer {first + int(off.argmax())} lies {off.max():.3g} mm off its place; "
            f'give them in the order of midair.Array.preset("autd3"), to {TOLERANCE_MM} mm'
        )
    if lean.max() > LEAN:
        at = int(lean.argmax())
        raise SceneError(
            f"{refused}: transducer {first + at} faces {_told(normals[at])}, the board {_told(axes[2])}; "
            "give normals that way, or count the rows from the other end"
        )
    x, y, z = origin.tolist()
    w, qx, qy, qz = rotation.tolist()
    return Pose((x, y, z), (w, qx, qy, qz))


def _told(direction: _Rows) -> list[float]:
    rounded: list[float] = (np.round(direction, 4) + 0.0).tolist()
    return rounded


def _rotation(start: _Rows, end: _Rows) -> _Rows:
    """The unit quaternion (w, x, y, z), w >= 0, that turns centred points (N, 3) to others in least squares.

    Eigenvector of the largest eigenvalue of a symmetric 4 x 4 matrix: Horn 1987, "Closed-form solution of
    absolute orientation using unit quaternions", section 4. For points in a plane, too, it is a turn and no
    mirror image.
    """
    s = start.T @ end
    matrix = np.empty((4, 4))
    matrix[0, 0] = np.trace(s)
    matrix[0, 1:] = matrix[1:, 0] = s[1, 2] - s[2, 1], s[2, 0] - s[0, 2], s[0, 1] - s[1, 0]
    matrix[1:, 1:] = s + s.T - np.trace(s) * np.eye(3)
    largest: _Rows = np.linalg.eigh(matrix).eigenvectors[:, -1]
    return largest if largest[0] >= 0 else -largest
