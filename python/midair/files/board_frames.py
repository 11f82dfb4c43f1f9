"""`.bin`: frames of a board one after another, the bytes that its line carries, and nothing else."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from ..boards.board import Board
from .content import content, fault
from .played import Played, one_or_more

CURE = 'give board=, such as "sonicsurface"'


def write(path: Path, drives: Played, board: Board | None) -> None:
    """Write `board.encode` of each drive."""
    if board is None:
        raise SceneError(f"board is left out, and .bin holds the frames of one: {CURE}")
    with path.open("wb") as stream:
        for drive in drives:
            stream.write(board.encode(drive.astype(np.complex64)))


def read(path: str | PathLike[str], board: Board | None) -> NDArray[np.complex64]:
    """Read drives by `board.decode`, (N,) of one frame, else (T, N)."""
    if board is None:
        raise fault(path, None, f"it holds frames, and board is left out: {CURE}")
    data, length = content(path), len(board.off_frame)
    if len(data) % length:
        told = f"{len(data)} bytes are no whole number of frames of {length}"
        raise fault(path, None, f"{told}: give a file of this board, or another board")
    drives = np.empty((len(data) // length, len(board.array)), np.complex64)
    for frame in range(len(drives)):
        try:
            drives[frame] = board.decode(data[frame * length : (frame + 1) * length])
        except SceneError as error:
            raise fault(path, None, f"frame {frame}: {error}") from error
    return one_or_more(drives)
