"""`.holo`: drives of AcousTools 1.2 (Export/Holo.py): whole numbers of five bytes, packed by zlib.

Of each frame: phases round(phi / (2 * 3.1415 / 32) + 16), 0 to 32; 63; amplitudes round(32 a), 0 to 32; 63.
Its pi is 3.1415. Transducers are in AcousTools' own order. A phase is wrong by pi/32 at most, an amplitude
by 1/64.
"""

from __future__ import annotations

import zlib
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, SceneError
from .._support.text import MOST_BYTES, content, fault, unpacked
from .acoustools import own_order
from .played import Played, one_or_more

#: Steps of a period and of the amplitude, the phase of a step, what ends a list, and bytes of a number.
STEPS = 32
STEP = 2 * 3.1415 / STEPS
END = 63
BYTES = 5


def write(path: Path, drives: Played) -> None:
    """Write phases and amplitudes on their grid."""
    size = drives.frames * 2 * (drives.transducers + 1) * BYTES
    if size > MOST_BYTES:
        reported = f"{drives.frames} frames of {drives.transducers} transducers are {size >> 20} MB unpacked"
        raise SceneError(f"{reported}: a .holo file holds {MOST_BYTES >> 20} MB at most, write parts of it")
    order = own_order(drives.array, drives.transducers)
    packer = zlib.compressobj()
    with path.open("wb") as stream:
        for drive in drives:
            phases = np.rint(np.angle(drive[order]) / STEP + STEPS // 2).clip(0, STEPS)
            amplitudes = np.rint(np.abs(drive[order]) * STEPS).clip(0, STEPS)
            numbers = np.zeros((2 * drives.transducers + 2, BYTES), np.uint8)
            numbers[:, -1] = np.concatenate([phases, [END], amplitudes, [END]])
            stream.write(packer.compress(numbers.tobytes()))
        stream.write(packer.flush())


def read(path: str | PathLike[str], array: Array | None = None) -> NDArray[np.complex64]:
    """Read drives of an array, (N,) of one frame, else (T, N)."""
    data = unpacked(path, content(path), "zlib")
    if not data or len(data) % BYTES:
        raise fault(path, None, f"{len(data)} bytes are in it: give whole numbers of {BYTES} bytes each")
    numbers = np.frombuffer(data, np.uint8).reshape(-1, BYTES)
    codes = numbers[:, -1]
    wrong = np.flatnonzero(numbers[:, :-1].any(axis=1) | ((codes > STEPS) & (codes != END)))
    if len(wrong):
        value = int.from_bytes(numbers[wrong[0]].tobytes(), "big")
        raise fault(
            path, None, f"number {wrong[0]} is {value}: give 0 to {STEPS}, and {END} at the end of a list"
        )
    ends = np.flatnonzero(codes == END)
    transducers = int(ends[0]) if len(ends) else 0
    if not transducers:
        raise fault(path, None, f"no list of phases is in it: end it with {END}")
    frames = len(codes) // (2 * (transducers + 1))
    expected = (np.arange(2 * frames) + 1) * (transducers + 1) - 1
    if len(codes) != 2 * frames * (transducers + 1) or not np.array_equal(ends, expected):
        reported = f"{len(ends)} lists are in it, and not all of {transducers} numbers"
        raise fault(
            path, None, f"{reported}: give phases and amplitudes of every frame, each list of one length"
        )
    lists = codes.reshape(frames, 2, transducers + 1)[:, :, :-1]
    code = np.arange(STEPS + 1)
    phase = np.exp(1j * STEP * (code - STEPS // 2)).astype(np.complex64)
    amplitude = (code / STEPS).astype(np.float32)
    drives = np.empty((frames, transducers), np.complex64)
    drives[:, own_order(array, transducers)] = phase[lists[:, 0]] * amplitude[lists[:, 1]]
    return one_or_more(drives)
