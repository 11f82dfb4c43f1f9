"""Drives of all frames, as complex numbers or phase codes, and the changes of phase between frames."""

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
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, numbers, stated
from .._support.arguments import refused

#: Complex numbers per block: 16 MB in single precision, about 0.2 s of computation.
BLOCK = 1 << 21


def blocks(count: int, each: int) -> Iterator[slice]:
    """Yield slices of `count` items with `each` numbers per item, so that a block has about BLOCK numbers."""
    length = max(1, BLOCK // max(each, 1))
    for start in range(0, count, length):
        yield slice(start, min(start + length, count))


#: Tolerance of |q| <= 1, since an amplitude of 1 rounded to float32 may exceed 1.
SLACK = 1e-6


@dataclass(frozen=True)
class Drives:
    """The drive of each frame: `kept` (T, N), complex64, or codes l of the phases 2 pi l/L (uint8, uint16).

    `kept` is an array in memory or a file.

    Attributes
    ----------
    live
        (N,) bool: False for transducers that are masked or dead, whose drive is 0.
    phases
        Number of phases L; None for complex drives.
    """

    kept: NDArray[Any] | Stored
    live: NDArray[np.bool_]
    phases: int | None

    def __len__(self) -> int:
        return len(self.kept)

    def __getitem__(self, frames: int | slice | NDArray[np.intp]) -> NDArray[np.complex64]:
        """Return the drives (frames, N) of some frames, or (N,) of one frame."""
        given: NDArray[Any] = self.kept[frames]
        if self.phases is None:
            return given
        table = np.exp(2j * np.pi * np.arange(self.phases) / self.phases).astype(np.complex64)
        played: NDArray[np.complex64] = table[given] * self.live
        return played

    def changes(self, frames: slice, closed: bool) -> NDArray[np.float32]:
        """Return |phase change| (frames, N) in rad from the previous frame; 0 if either amplitude is 0.

        For frame 0 the previous frame is the last one if the sequence is closed; otherwise its change is 0.
        Codes are subtracted as integers, so a bound that is a whole number of phase steps can be checked
        exactly.
        """
        index = np.arange(frames.start, frames.stop)
        before = np.where(index > 0, index - 1, len(self) - 1 if closed else 0)
        if self.phases is None:
            new, old = self.kept[index], self.kept[before]
            # Equal drives must give exactly 0: rounding may give q conj(q) a small imaginary part, and
            # arg(-0) is pi.
            moved = (new != old) & (new != 0) & (old != 0)
            angles: NDArray[np.float32] = np.abs(np.angle(new * old.conj())) * moved
            return angles
        steps = (self.kept[index].astype(np.int32) - self.kept[before]) % self.phases
        steps = np.minimum(steps, self.phases - steps) * self.live
        turned: NDArray[np.float32] = (steps * (2 * np.pi / self.phases)).astype(np.float32)
        return turned


def narrow(codes: NDArray[Any], phases: int) -> NDArray[Any]:
    """Return codes as uint8 if they fit, else as uint16."""
    small: NDArray[Any] = codes.astype(np.uint8 if phases <= 256 else np.uint16)
    return small


def sounding(array: Array) -> NDArray[np.bool_]:
    """Return (N,) bool: False for transducers that are masked or dead."""
    return array.mask if array.response is None else array.mask & (array.response != 0)


def read(given: Any, array: Array, phases: int | None) -> Drives:
    """Return `Drives` of given drives (T, N): complex of |q| <= 1, or codes below the number of phases."""
    live = sounding(array)
    shape, cure = (-1, len(array)), f"give (T, {len(array)}), complex drives or whole phase codes"
    found = given
    if not isinstance(given, Stored):
        found = numbers("drives", given, [shape], cure, kinds="iufc", copy=False)
    elif found.shape[1:] != shape[1:] or not len(found):
        raise refused("drives.shape", found.shape, cure)
    whole = found.dtype.kind in "iu"
    if whole and phases is None:
        cure = 'drives of whole numbers are phase codes, give quantization={"phases": 256} or complex drives'
        raise refused("quantization", None, cure)
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
    """Reject codes that the board does not have, or |q| > 1. `first` is the block's first frame."""
    if phases is not None:
        least, most = block.min(), block.max()
        if least < 0 or most >= phases:
            raise refused("drives", least if least < 0 else most, f"give codes from 0 to {phases - 1}")
        return
    # This form of the test also rejects NaN.
    within = np.abs(block) <= 1 + SLACK
    if not within.all():
        frame, one = np.argwhere(~within)[0]
        raise refused(f"drives[{first + frame}, {one}]", block[frame, one], "give |q| of at most 1")


def lowered(amplitudes: NDArray[Any], table: ArrayLike) -> NDArray[np.float64]:
    """Return the largest amplitude of a board, or 0, that is not above each given one."""
    levels = np.asarray(table, np.float64)
    found: NDArray[np.float64] = np.r_[0.0, levels][
        np.searchsorted(levels, amplitudes * (1 + 1e-9), side="right")
    ]
    return found


class Stored:
    """Drives (T, N) in a file that may be larger than memory. They are read and checked block by block.

    The file is not memory-mapped: if another process truncates a mapped file, the system kills its readers.
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
        # Consecutive frames are read together.
        runs = np.split(rows, np.flatnonzero(np.diff(rows) != 1) + 1)
        found = np.concatenate([self._rows(run) for run in runs])
        return found.reshape(*index.shape, self.shape[1])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self[:] if dtype is None else self[:].astype(dtype)

    def __reduce__(self) -> tuple[Any, ...]:
        return np.asarray, (self[:],)

    def _rows(self, run: NDArray[np.intp]) -> NDArray[Any]:
        """Read the drives of consecutive frames."""
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
            raise stated(f'file "{self._path}"', "was changed while it was in use", "load it again")
        self.check(found, int(run[0]))
        return found

    def _now(self) -> tuple[int, int]:
        """Return the file's size and time of change, to detect that the file changes."""
        found = os.fstat(self._handle)
        return found.st_size, found.st_mtime_ns
