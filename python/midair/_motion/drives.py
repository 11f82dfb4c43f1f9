"""Drives of frames: complex, or phase codes of a board, and how far each transducer turns between frames."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from os import PathLike
from threading import Lock
from typing import Any
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, SceneError
from .._support.arguments import refused

#: Complex numbers in one block: 16 MB in single precision, a fifth of a second of work.
BLOCK = 1 << 21


def blocks(count: int, each: int) -> Iterator[slice]:
    """Slices of `count` items, of `each` numbers an item; no block is empty."""
    length = max(1, BLOCK // max(each, 1))
    for start in range(0, count, length):
        yield slice(start, min(start + length, count))


#: A drive of 1 rounded to f32 may be above it by as much.
SLACK = 1e-6


@dataclass(frozen=True)
class Drives:
    """The drive of each frame: `kept` (T, N), complex64, or codes l of phases 2 pi l/L as uint8 or uint16.

    `kept` is in memory, or in a file.

    Attributes
    ----------
    live
        (N,) False where a transducer is masked or dead, whose drive is 0.
    phases
        L, or None for complex drives.
    """

    kept: NDArray[Any] | Stored
    live: NDArray[np.bool_]
    phases: int | None

    def __len__(self) -> int:
        return len(self.kept)

    def __getitem__(self, frames: int | slice | NDArray[np.intp]) -> NDArray[np.complex64]:
        """Drives (frames, N) of a block, (N,) of one frame."""
        given: NDArray[Any] = self.kept[frames]
        if self.phases is None:
            return given
        table = np.exp(2j * np.pi * np.arange(self.phases) / self.phases).astype(np.complex64)
        played: NDArray[np.complex64] = table[given] * self.live
        return played

    def changes(self, frames: slice, closed: bool) -> NDArray[np.float32]:
        """|Phase change| (frames, N) in rad to the frame before; 0 where the amplitude is 0 in either.

        Frame 0 is compared with the last one where the sequence is closed, else with itself. Codes are
        subtracted as whole numbers, so that a bound on a grid can be checked exactly.
        """
        index = np.arange(frames.start, frames.stop)
        before = np.where(index > 0, index - 1, len(self) - 1 if closed else 0)
        if self.phases is None:
            new, old = self.kept[index], self.kept[before]
            # The product of equal numbers need not be real to the last bit, and the arg of -0 is pi.
            moved = (new != old) & (new != 0) & (old != 0)
            angles: NDArray[np.float32] = np.abs(np.angle(new * old.conj())) * moved
            return angles
        steps = (self.kept[index].astype(np.int32) - self.kept[before]) % self.phases
        steps = np.minimum(steps, self.phases - steps) * self.live
        turned: NDArray[np.float32] = (steps * (2 * np.pi / self.phases)).astype(np.float32)
        return turned


def coded(drives: NDArray[np.complex64], phases: int) -> NDArray[Any]:
    """Codes of drives at full amplitude on a board's phases; of those that are 0, code 0."""
    codes = np.rint(np.angle(drives) * (phases / (2 * np.pi))).astype(np.int32) % phases
    return narrow(codes, phases)


def narrow(codes: NDArray[Any], phases: int) -> NDArray[Any]:
    """Codes in as few bytes as they need."""
    small: NDArray[Any] = codes.astype(np.uint8 if phases <= 256 else np.uint16)
    return small


def sounding(array: Array) -> NDArray[np.bool_]:
    """(N,) False where a transducer is masked or dead."""
    return array.mask if array.response is None else array.mask & (array.response != 0)


def read(given: Any, array: Array, phases: int | None) -> Drives:
    """Drives (T, N) as given: complex of |q| <= 1, or whole numbers below the number of phases."""
    live = sounding(array)
    if np.ma.is_masked(given):
        raise refused("drives", "a masked array", "fill what it hides")
    found = given if isinstance(given, Stored) else np.asarray(given)
    if found.ndim != 2 or found.shape[1] != len(array) or not len(found):
        raise refused("drives.shape", found.shape, f"give (T, {len(array)}), a drive for each frame")
    whole = found.dtype.kind in "iu"
    if not whole and found.dtype.kind not in "fc":
        raise refused("drives.dtype", str(found.dtype), "give complex drives or whole phase codes")
    if whole and phases is None:
        raise refused(
            "quantization",
            None,
            'drives of whole numbers are phase codes, give quantization={"phases": 256} or complex drives',
        )
    most = phases if whole else None
    if isinstance(found, Stored):
        found.check = partial(_check, phases=most)
        for frames in blocks(*found.shape):
            found[frames]
        if whole or found.dtype == np.complex64:
            return Drives(found, live, most)
        found = found[:]
    if whole:
        _check(found, 0, most)
        drives = narrow(found, phases or 1)
    else:
        drives = np.array(found, np.complex64)
        for frames in blocks(*drives.shape):
            _check(drives[frames], frames.start, None)
        drives[:, ~live] = 0
    drives.flags.writeable = False
    return Drives(drives, live, most)


def _check(block: NDArray[Any], first: int, phases: int | None) -> None:
    """Refuse codes of other phases, or drives above 1; `first` is the block's first frame."""
    if phases is not None:
        least, most = block.min(), block.max()
        if least < 0 or most >= phases:
            raise refused("drives", least if least < 0 else most, f"give codes from 0 to {phases - 1}")
        return
    # A drive that is not a number is not within either.
    within = np.abs(block) <= 1 + SLACK
    if not within.all():
        frame, one = np.argwhere(~within)[0]
        raise refused(f"drives[{first + frame}, {one}]", block[frame, one], "give |q| of at most 1")


class Stored:
    """Drives (T, N) in a file that may be larger than memory, read and checked a block at a time.

    The file is not mapped: the system ends a process that reads a mapped file which another one cut.
    """

    ndim = 2

    def __init__(
        self, path: str | PathLike[str], dtype: np.dtype[Any], shape: tuple[int, ...], start: int
    ) -> None:
        self.dtype, self.shape = dtype, shape
        self.check: Callable[[NDArray[Any], int], None] = lambda block, first: None
        self._path, self._start, self._lock = path, start, Lock()
        self._handle = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        finalize(self, os.close, self._handle)
        self._stamp = self._now()

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, frames: int | slice | NDArray[np.intp]) -> NDArray[Any]:
        index = np.arange(len(self))[frames]
        rows = index.reshape(-1)
        # Frames in a row are read at once.
        runs = np.split(rows, np.flatnonzero(np.diff(rows) != 1) + 1)
        found = np.concatenate([self._rows(run) for run in runs])
        return found.reshape(*index.shape, self.shape[1])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self[:] if dtype is None else self[:].astype(dtype)

    def __reduce__(self) -> tuple[Any, ...]:
        return np.asarray, (self[:],)

    def _rows(self, run: NDArray[np.intp]) -> NDArray[Any]:
        """The drives of frames that follow one another."""
        found = np.empty((len(run), self.shape[1]), self.dtype)
        if not found.size:
            return found
        left = found.data.cast("B")
        with self._lock:
            os.lseek(self._handle, self._start + int(run[0]) * found.strides[0], os.SEEK_SET)
            while left and (part := os.read(self._handle, len(left))):
                left[: len(part)] = part
                left = left[len(part) :]
            same = not left and self._now() == self._stamp
        if not same:
            raise SceneError(f'file "{self._path}" was changed while it was in use: load it again')
        self.check(found, int(run[0]))
        return found

    def _now(self) -> tuple[int, int]:
        """A stamp that changes when the file does."""
        found = os.fstat(self._handle)
        return found.st_size, found.st_mtime_ns
