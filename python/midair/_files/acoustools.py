"""Files of AcousTools 1.2 (JoshuaMukherjee/AcousTools, Export): `.csv` of phases, and `.holo`.

Order of transducers: AcousTools has one or two boards of OpenMPD, with 256 transducers each. Its own order is
the top board first; on each board x varies slowly, then y, both from the lowest. In its .csv of two boards,
which OpenMPD reads, the top board is reversed, and so is each run of 16 transducers of the bottom board. Its
.csv of one board keeps its own order (flip=False, invert=False). midair's drives are those of
`Array.preset("openmpd_board")` or "openmpd_pair", or of an array with transducers at the same places. Arrays
with any other number of transducers keep their order, with a warning.

`.csv`: the first line is `frames,transducers`. Then follow phases in rad, one line per frame. There are no
amplitudes.

`.holo`: integers of five bytes, compressed by zlib. Each frame has phases round(phi / (2 * 3.1415 / 32) +
16), 0 to 32; then 63; then amplitudes round(32 a), 0 to 32; then 63. Pi is 3.1415 in this format. Transducers
are in AcousTools' own order. The error of a phase is at most pi/32, of an amplitude 1/64.
"""

import zlib
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, stated
from .._support.arguments import warn
from .._support.text import MOST_BYTES, content, fault, number, rows, text, unpacked
from .played import Played, frames_of, one_or_more

#: Number of transducers: of a pair of boards, of one board, along one side of a board.
PAIR, BOARD, SIDE = 512, 256, 16

#: Largest distance in m of a transducer from its place on a pair of boards.
NEAR = 2e-3

#: .holo: steps of a period and of an amplitude; phase of one step; code at the end of a list; bytes of a
#: number.
STEPS = 32
STEP = 2 * 3.1415 / STEPS
END = 63
BYTES = 5

#: Amplitudes below this cause a warning, because .csv does not store them.
FULL = 1 - 1e-3


def own_order(array: Array | None, transducers: int) -> NDArray[np.intp]:
    """Return the indices (N,) of midair's transducers in AcousTools' order."""
    if array is not None and len(array) != transducers:
        cure = "give another board"
        raise stated("drives", f"of {transducers} transducers, an array of {len(array)}", cure)
    if transducers not in (BOARD, PAIR):
        warn(f"AcousTools has boards of {BOARD} transducers: {transducers} keep the order of the drives")
        return np.arange(transducers)
    if array is None:
        array = Array.preset("openmpd_board" if transducers == BOARD else "openmpd_pair")
    places, down = array.positions, array.normals[:, 2] < 0
    side = (np.arange(SIDE) - (SIDE - 1) / 2) * 10.5e-3
    found: list[int] = []
    for board in (down, ~down) if transducers == PAIR else (np.ones(BOARD, np.bool_),):
        for x in side:
            for y in side:
                away = np.where(board, np.hypot(places[:, 0] - x, places[:, 1] - y), np.inf)
                found.append(int(away.argmin()))
                if not away[found[-1]] < NEAR:
                    reported = f"has {transducers} transducers, but not those of OpenMPD boards"
                    cure = "give drives of openmpd_board or openmpd_pair, or another format"
                    raise stated("the array", reported, cure, code="conflict")
    return np.array(found)


def csv_order(array: Array | None, transducers: int) -> NDArray[np.intp]:
    """Return the indices (N,) of midair's transducers in the order of the columns of a .csv."""
    own = own_order(array, transducers)
    if transducers != PAIR:
        return own
    runs = own[BOARD:].reshape(SIDE, SIDE)
    return np.concatenate([own[:BOARD][::-1], runs[:, ::-1].ravel()])


def write(path: Path, drives: Played) -> None:
    """Write the phases to a .csv. Warns if amplitudes are lost."""
    order = csv_order(drives.array, drives.transducers)
    least = 1.0
    with path.open("w", encoding="ascii", newline="\n") as stream:
        stream.write(f"{drives.frames},{drives.transducers}\n")
        for drive in drives:
            least = min(least, float(np.abs(drive).min()))
            stream.write(",".join(f"{phase:.9g}" for phase in np.angle(drive[order]).tolist()) + "\n")
    if least < FULL:
        reported = f"amplitudes down to {least:.3g} are not written"
        cure = "AcousTools' .csv holds phases alone, and plays them at full amplitude; .holo keeps amplitudes"
        warn(f"{reported}: {cure}")


def read(path: str | PathLike[str], data: bytes, array: Array | None = None) -> NDArray[np.complex64]:
    """Return the drives in a .csv with amplitude 1: (N,) for one frame, else (T, N)."""
    table = rows(text(path, data))
    line, head = next(table)
    size = [int(number(cell) or 0) for cell in head]
    phases = frames_of(path, table)
    if [*phases.shape] != size:
        there = f"{phases.shape[0]} frames of {phases.shape[1]}"
        reported = f"{size[0]} frames of {size[1]} transducers are stated, {there} are there"
        raise fault(path, line, reported, "get the file again")
    drives = np.empty(phases.shape, np.complex64)
    drives[:, csv_order(array, phases.shape[1])] = np.exp(1j * phases)
    return one_or_more(drives)


def write_holo(path: Path, drives: Played) -> None:
    """Write phases and amplitudes, rounded to their steps, to a .holo."""
    size = drives.frames * 2 * (drives.transducers + 1) * BYTES
    if size > MOST_BYTES:
        reported = f"{drives.frames} frames of {drives.transducers} transducers are {size >> 20} MB unpacked"
        raise stated("", reported, f"a .holo file holds {MOST_BYTES >> 20} MB at most, write parts of it")
    order = own_order(drives.array, drives.transducers)
    packer = zlib.compressobj()
    with path.open("wb") as stream:
        for drive in drives:
            phases = np.rint(np.angle(drive[order]) / STEP + STEPS // 2).clip(0, STEPS)
            amplitudes = np.rint(np.abs(drive[order]) * STEPS).clip(0, STEPS)
            codes = np.zeros((2 * drives.transducers + 2, BYTES), np.uint8)
            codes[:, -1] = np.concatenate([phases, [END], amplitudes, [END]])
            stream.write(packer.compress(codes.tobytes()))
        stream.write(packer.flush())


def read_holo(path: str | PathLike[str], array: Array | None = None) -> NDArray[np.complex64]:
    """Return the drives in a .holo: (N,) for one frame, else (T, N)."""
    data = unpacked(path, content(path), "zlib")
    if not data or len(data) % BYTES:
        raise fault(path, None, f"{len(data)} bytes are in it", f"give whole numbers of {BYTES} bytes each")
    packed = np.frombuffer(data, np.uint8).reshape(-1, BYTES)
    codes = packed[:, -1]
    wrong = np.flatnonzero(packed[:, :-1].any(axis=1) | ((codes > STEPS) & (codes != END)))
    if len(wrong):
        value = int.from_bytes(packed[wrong[0]].tobytes(), "big")
        cure = f"give 0 to {STEPS}, and {END} at the end of a list"
        raise fault(path, None, f"number {wrong[0]} is {value}", cure)
    ends = np.flatnonzero(codes == END)
    transducers = int(ends[0]) if len(ends) else 0
    if not transducers:
        raise fault(path, None, "no list of phases is in it", f"end it with {END}")
    frames = len(codes) // (2 * (transducers + 1))
    expected = (np.arange(2 * frames) + 1) * (transducers + 1) - 1
    if len(codes) != 2 * frames * (transducers + 1) or not np.array_equal(ends, expected):
        reported = f"{len(ends)} lists are in it, and not all of {transducers} numbers"
        cure = "give phases and amplitudes of every frame, each list of one length"
        raise fault(path, None, reported, cure)
    lists = codes.reshape(frames, 2, transducers + 1)[:, :, :-1]
    code = np.arange(STEPS + 1)
    phase = np.exp(1j * STEP * (code - STEPS // 2)).astype(np.complex64)
    amplitude = (code / STEPS).astype(np.float32)
    drives = np.empty((frames, transducers), np.complex64)
    drives[:, own_order(array, transducers)] = phase[lists[:, 0]] * amplitude[lists[:, 1]]
    return one_or_more(drives)
