"""Drives of all frames, phase changes between them, and the radiation and pressures that follow from them."""

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from os import PathLike
from threading import Lock
from typing import Any, Literal, NamedTuple, get_args
from weakref import finalize

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Response, Scene, SceneError, numbers, restated, stated
from .._support.arguments import number, refused, warn, without_warnings

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

    kept: "NDArray[Any] | Stored"
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
        drives = found.astype(np.uint8 if (phases or 1) <= 256 else np.uint16)
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
    found: NDArray[np.float64] = np.r_[0.0, levels][np.searchsorted(levels, amplitudes * (1 + 1e-9), side="right")]
    return found


class Stored:
    """Drives (T, N) in a file that may be larger than memory. They are read and checked block by block.

    The file is not memory-mapped: if another process truncates a mapped file, the system kills its readers.
    """

    ndim = 2

    def __init__(self, path: str | PathLike[str], dtype: np.dtype[Any], shape: tuple[int, ...], start: int) -> None:
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


Hold = Literal["hold", "linear"]


class Envelope(NamedTuple):
    """Drives played at `rate` frames/s by transducers with time constant `tau` in s (0: they follow at once).

    hold="hold": each drive stays for its whole frame. hold="linear": during a frame, amplitude and phase move
    in equal steps to those of the next frame; the phase takes the shorter way. An open sequence is preceded
    by its first drive for a long time, and followed by its last drive. A closed sequence repeats.
    """

    drives: Drives
    rate: float
    closed: bool
    tau: float
    hold: Hold

    @property
    def response(self) -> Response:
        """The transducers' response, as the core computes it."""
        return Response(self.rate, self.tau, self.hold == "linear")

    def inside(self, substeps: int) -> Iterator[tuple[slice, slice, NDArray[np.complex64]]]:
        """Yield (frames, sub-steps, y), block by block, with the radiation y (frames, sub-steps, N).

        The time of sub-step k of frame t is (t + k/substeps)/rate.
        """
        response, start = self.response, self.before()
        count = len(self.drives.live)
        for frames, now, following in self.played(substeps):
            # A single frame can have more sub-steps than fit in a block.
            length = max(1, BLOCK // len(now) // count)
            after = start
            for first in range(0, substeps, length):
                steps = slice(first, min(first + length, substeps))
                y, after = response.inside(now, following, start, substeps, steps.start, steps.stop)
                yield frames, steps, y
            start = after

    def played(self, substeps: int) -> Iterator[tuple[slice, NDArray[np.complex64], NDArray[np.complex64]]]:
        """Yield blocks: frames, their drives (frames, N), the following frames' drives (frames, N)."""
        last = 0 if self.closed else len(self.drives) - 1
        for frames in blocks(len(self.drives), substeps * len(self.drives.live)):
            following = np.arange(frames.start, frames.stop) + 1
            following[following == len(self.drives)] = last
            yield frames, self.drives[frames], self.drives[following]

    def before(self) -> NDArray[np.complex128]:
        """Return the radiation y (N,) at the start of frame 0."""
        first = self.drives[0]
        if not self.closed:
            return first.astype(np.complex128)
        kept = self.response.memory(len(self.drives))
        return self.response.repeated(self.drives[len(self.drives) - kept : len(self.drives)], first)


#: Largest number of entries of G in one block behind obstacles or with a signature, where the core stores
#: them in double precision.
MOST_KEPT = 1 << 17


def rows(scene: Scene, points: NDArray[np.float64], name: str = "points", first: int = 0) -> NDArray[np.complex64]:
    """Return rows of G (..., N) at points (..., 3) in a scene. Errors number the points from `first`."""
    shape, flat = points.shape[:-1], points.reshape(-1, 3)
    kept = scene.obstacles or scene.signature is not None
    part = max(MOST_KEPT // len(scene.array), 1) if kept else len(flat)
    # A list of signatures has one entry for each point of a frame.
    names = scene.signature if isinstance(scene.signature, list) else None
    blocks = []
    with without_warnings():
        # The scene itself has already warned of probable mistakes.
        for start in range(0, len(flat), part):
            try:
                changes: dict[str, Any] = {"points": flat[start : start + part]}
                if names is not None:
                    order = range(start, start + len(changes["points"]))
                    changes["signature"] = [names[k % len(names)] for k in order]
                blocks.append(scene.replace(**changes).propagation())
            except SceneError as error:
                if error.index is None or not error.item.startswith("points"):
                    raise
                index = [int(k) for k in np.unravel_index(start + error.index, shape)]
                index[0] += first
                rest = error.item.removeprefix(f"points[{error.index}]")
                raise restated(error, item=f"{name}{index}{rest}", index=index[0]) from None
    return np.concatenate(blocks).reshape(*shape, -1)


def pressures(scene: Scene, points: NDArray[np.float64], drives: Drives) -> NDArray[np.float64]:
    """Return |p| (T, M) in Pa: p_j(t) = sum_i G_ji(t) q_i(t)."""
    frames, count, _ = points.shape
    found = np.empty((frames, count))
    for part in blocks(frames, count * len(scene.array)):
        found[part] = moduli(rows(scene, points[part], first=part.start), drives[part])
    return found


def moduli(matrices: NDArray[np.complex64], drives: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Return |p| (..., M) for matrices G (..., M, N) and drives (..., N)."""
    found: NDArray[np.float32] = np.abs(np.matmul(matrices, drives[..., None])[..., 0])
    return found


class Between(NamedTuple):
    """Pressures between frames: `times` (S,) in s and |p| `pressures` (S, M) in Pa, S = T substeps."""

    times: NDArray[np.float64]
    pressures: NDArray[np.float64]


def between(
    scene: Scene, points: NDArray[np.float64], targets: NDArray[np.float64], envelope: Envelope, substeps: int
) -> Between:
    """Return |p_j| = |sum_i G_ji y_i| at (t + k/substeps)/rate; points move linearly between frames.

    A point that is absent in the next frame does not move. Neither do the points after the end of an open
    sequence.
    """
    frames, count, _ = points.shape
    found = np.empty((frames, substeps, count))
    following = np.roll(points, -1, axis=0)
    gone = np.roll(targets, -1, axis=0) == 0
    if not envelope.closed:
        gone[-1] = True
    step = np.where(gone[..., None], 0.0, following - points)
    for part, steps, y in envelope.inside(substeps):
        shares = np.arange(steps.start, steps.stop) / substeps
        places = points[part, None] + shares[:, None, None] * step[part, None]
        # G has `count` times as many numbers as the drives, so it is computed in smaller blocks.
        for some in blocks(len(y), y[0].size * count):
            matrices = rows(scene, places[some], first=part.start + some.start)
            found[part.start + some.start : part.start + some.stop, steps] = moduli(matrices, y[some])
    times = np.arange(frames * substeps) / (substeps * envelope.rate)
    return Between(times, found.reshape(-1, count))


#: Largest plausible time constant in s; transducers of 40 kHz have 0.1 to 1 ms.
SLOWEST = 20e-3


def points(given: Any) -> NDArray[np.float64]:
    """Return points (T, M, 3) in m: M points in each of T frames."""
    return numbers("points", given, [(-1, -1, 3)], "give (T, M, 3) in m, M places in each of T frames")


def targets(given: Any, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Return targets (T, M) in Pa. A single number or (M,) values apply to all frames."""
    cure = f"give {shape} in Pa like the points, ({shape[1]},) or one number, 0 for not there"
    found = numbers("targets", given, [shape, shape[1:], ()], cure, least=0)
    if not found.any():
        raise stated("targets", "are 0 everywhere", "give a pressure above 0 in at least one frame")
    return np.broadcast_to(found, shape)


def quantization(given: Any, array: Array) -> dict[str, Any] | None:
    """Return a board's quantization in the form of `Array.quantization`: the given one, else the array's."""
    if given is None:
        return array.quantization
    try:
        return Array.grid(1, 1, 0.01, quantization=given).quantization
    except SceneError as error:
        raise restated(error, item=error.item.removeprefix("array.")) from None


def time_constant(given: Any) -> float:
    """Return a time constant tau in s; 0 means that transducers follow their drives at once."""
    tau = number("tau", given, least=0)
    if tau > SLOWEST:
        warn(f"tau is {tau:g} s, longer than of any transducer: give {tau * 1e-3:g} if ms are meant")
    return tau


def hold(given: Any) -> Hold:
    """Return how a board changes its phases between frames: "hold" or "linear"."""
    if not isinstance(given, str) or given not in get_args(Hold):
        raise refused("hold", given, 'give "hold" or "linear"')
    return "hold" if given == "hold" else "linear"
