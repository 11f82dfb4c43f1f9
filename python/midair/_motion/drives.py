"""Drives of frames: complex, or phase codes of a board, and how far each transducer turns between frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array
from .._support.arguments import refused
from .._support.memory import blocks

#: A drive of 1 rounded to f32 may be above it by as much.
SLACK = 1e-6


@dataclass(frozen=True)
class Drives:
    """The drive of each frame: `held` (T, N), complex64, or codes l of phases 2 pi l/L as uint8 or uint16.

    live : (N,) False where a transducer is masked or dead, whose drive is 0
    phases : L, or None for complex drives
    """

    held: NDArray[Any]
    live: NDArray[np.bool_]
    phases: int | None

    def __len__(self) -> int:
        return len(self.held)

    def __getitem__(self, frames: int | slice | NDArray[np.intp]) -> NDArray[np.complex64]:
        """Drives (frames, N) of a block, (N,) of one frame."""
        given: NDArray[Any] = self.held[frames]
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
            new, old = self.held[index], self.held[before]
            # The product of equal numbers need not be real to the last bit, and the arg of -0 is pi.
            moved = (new != old) & (new != 0) & (old != 0)
            angles: NDArray[np.float32] = np.abs(np.angle(new * old.conj())) * moved
            return angles
        steps = (self.held[index].astype(np.int32) - self.held[before]) % self.phases
        steps = np.minimum(steps, self.phases - steps) * self.live
        turned: NDArray[np.float32] = (steps * (2 * np.pi / self.phases)).astype(np.float32)
        return turned


def coded(drives: NDArray[np.complex64], phases: int) -> NDArray[Any]:
    """Codes of drives at full amplitude on a board's phases; of those that are 0, code 0."""
    codes = np.rint(np.angle(drives) * (phases / (2 * np.pi))).astype(np.int32) % phases
    return narrow(codes, phases)


def narrow(codes: NDArray[Any], phases: int, *, copy: bool = True) -> NDArray[Any]:
    """Codes in as few bytes as they need."""
    small: NDArray[Any] = codes.astype(np.uint8 if phases <= 256 else np.uint16, copy=copy)
    return small


def sounding(array: Array) -> NDArray[np.bool_]:
    """(N,) False where a transducer is masked or dead."""
    return array.mask if array.response is None else array.mask & (array.response != 0)


def read(given: Any, array: Array, phases: int | None) -> Drives:
    """Drives (T, N) as given: complex of |q| <= 1, or whole numbers below the number of phases."""
    live = sounding(array)
    if np.ma.is_masked(given):
        raise refused("drives", "a masked array", "fill what it hides")
    found = np.asarray(given)
    if found.ndim != 2 or found.shape[1] != len(array) or not len(found):
        raise refused("drives.shape", found.shape, f"give (T, {len(array)}), a drive for each frame")
    if found.dtype.kind in "iu":
        return Drives(_codes(found, phases, copy=not isinstance(given, np.memmap)), live, phases)
    if found.dtype.kind not in "fc":
        raise refused("drives.dtype", str(found.dtype), "give complex drives or whole phase codes")
    # A file's own, which may be larger than memory, stay where they are.
    mapped = isinstance(given, np.memmap) and found.dtype == np.complex64
    drives = found if mapped else np.array(found, np.complex64)
    for frames in blocks(*drives.shape):
        # What is not a number is not within either.
        within = np.abs(drives[frames]) <= 1 + SLACK
        if not within.all():
            frame, one = np.argwhere(~within)[0]
            frame += frames.start
            raise refused(f"drives[{frame}, {one}]", found[frame, one], "give |q| of at most 1")
    if not mapped:
        drives[:, ~live] = 0
        drives.flags.writeable = False
    return Drives(drives, live, None)


def _codes(found: NDArray[Any], phases: int | None, *, copy: bool) -> NDArray[Any]:
    if phases is None:
        raise refused(
            "quantization",
            None,
            'drives of whole numbers are phase codes, give quantization={"phases": 256} or complex drives',
        )
    least, most = found.min(), found.max()
    if least < 0 or most >= phases:
        raise refused("drives", least if least < 0 else most, f"give codes from 0 to {phases - 1}")
    codes = narrow(found, phases, copy=copy)
    codes.flags.writeable = False
    return codes
