"""`.bin` files of a board's frames; and `Played`, the drives that all writers take, frame by frame."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._boards.board import Board
from .._midair import Array, SceneError, Solution, numbers, restated, stated
from .._sequence import Sequence
from .._support.text import content, fault, numbers as numbers_of

CURE = 'give board=, such as "sonicsurface"'


def write(path: Path, drives: "Played", board: Board | None) -> None:
    """Write each drive as a frame of the board."""
    if board is None:
        raise stated("board", "is left out, and .bin holds the frames of one", CURE, code="missing")
    largest: NDArray[Any] = np.zeros(1)
    off = True
    fit = board._fit(drives.array or board.array)
    with path.open("wb") as stream:
        for drive in drives:
            frame = board._frame(fit(drive).astype(np.complex64))
            largest = max(largest, drive, key=lambda drive: float(np.abs(drive).max()))
            off = off and frame == board.off_frame
            stream.write(frame)
    if off:
        board._warn_of_silence(largest, board.off_frame)


def read(path: str | PathLike[str], board: Board | None) -> NDArray[np.complex64]:
    """Return the drives of a board's frames: (N,) for one frame, else (T, N)."""
    if board is None:
        raise fault(path, None, "it holds frames, and board is left out", CURE)
    data, length = content(path), len(board.off_frame)
    if len(data) % length:
        reported = f"{len(data)} bytes are no whole number of frames of {length}"
        raise fault(path, None, reported, "give a file of this board, or another board")
    drives = np.empty((len(data) // length, len(board.array)), np.complex64)
    for frame in range(len(drives)):
        try:
            drives[frame] = board.decode(data[frame * length : (frame + 1) * length])
        except SceneError as error:
            raise fault(path, None, restated(error, inside=f"frame {frame}")) from error
    return one_or_more(drives)


#: Tolerance of |q| <= 1 for rounding to float32.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Played:
    """T drives of N transducers.

    `alone` is True if a single drive (N,) was given instead of frames (T, N).
    """

    frames: int
    transducers: int
    alone: bool
    array: Array | None
    _drive: Callable[[int], NDArray[np.complex64]]

    def __iter__(self) -> Iterator[NDArray[np.complex128]]:
        """Yield drives (N,) without negative zeros, whose phase would be -pi instead of pi."""
        for frame in range(self.frames):
            yield self._drive(frame).astype(np.complex128) + 0

    def all(self) -> NDArray[np.complex64]:
        """Return the drives, (N,) or (T, N)."""
        found = np.array([self._drive(frame) for frame in range(self.frames)], np.complex64)
        return found[0] if self.alone else found


def played(drives: Any, board: Board | None) -> Played:
    """Return the drives of a Solution, a Sequence, or numbers (N,) or (T, N).

    Drives without an array of their own get the board's array.
    """
    array, frequency = None if board is None else board.array, None
    if isinstance(drives, Solution):
        scene, drive = drives.scene, drives.drive
        array, frequency = (array, None) if scene is None else (scene.array, scene.frequency)
        found = Played(1, len(drive), True, array, lambda _: drive)
    elif isinstance(drives, Sequence):
        frequency = drives.scene(0).frequency
        found = Played(len(drives), len(drives.array), False, drives.array, drives.drive)
    else:
        cure = "give a Solution, a Sequence, or complex drives (N,) or (T, N), not codes of a board"
        given = numbers("drives", drives, [(-1,), (-1, -1)], cure, kinds="fc", most=1 + ROUNDING)
        frames = np.atleast_2d(given.astype(np.complex64))
        count, transducers = frames.shape
        found = Played(count, transducers, given.ndim == 1, array, lambda frame: frames[frame])
    if board is not None and len(board.array) != found.transducers:
        reported = f"drives of {found.transducers} transducers, board of {len(board.array)}"
        raise stated("", reported, "give drives for the board's array, or another board")
    if board is not None and found.array is not None:
        board._fit(found.array, frequency)
    return found


def known(board: Board | str | PathLike[str] | None) -> Board | None:
    """Return a board; a name or a .pat file is converted to one."""
    if board is None or isinstance(board, Board):
        return board
    return Board(board)


def frames_of(path: str | PathLike[str], table: Iterable[tuple[int, list[str]]]) -> NDArray[np.float64]:
    """Return the frames (T, N) in the rows of a table."""
    found: list[NDArray[np.float64]] = []
    for line, row in table:
        found.append(numbers_of(path, line, row))
        if len(found[-1]) != len(found[0]):
            raise fault(path, line, f"{len(row)} columns", f"give {len(found[0])}, as in the first row")
    if not found:
        raise fault(path, None, "no row is in it", "give a row of numbers for each frame")
    return np.array(found)


def one_or_more(drives: NDArray[np.complex64]) -> NDArray[np.complex64]:
    """Return frames (T, N), or the drive (N,) if there is only one frame."""
    return drives[0] if len(drives) == 1 else drives
