"""Boards' kinds and numbers with the models of their firmware, for the tests of their bytes."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import midair
from firmware import TICKS, TURN, Rig
from midair._boards.board import Board

Complex = NDArray[np.complex128]

TURNING = 2j * np.pi


def lattice(transducers: int) -> midair.Array:
    return midair.Array.grid(8, transducers // 8, 10e-3)


#: Each kind and number of boards, and how to make it.
CASES: dict[tuple[str, int], Callable[[], Board]] = {
    ("autd3", 1): lambda: Board("autd3"),
    ("autd3", 2): lambda: Board("autd3", tiles=(2, 1)),
    ("autd3", 4): lambda: Board("autd3", tiles=(2, 2)),
    ("sonicsurface", 1): lambda: Board("sonicsurface"),
    ("sonicsurface", 2): lambda: Board("sonicsurface_pair"),
    ("openmpd", 1): lambda: Board("openmpd"),
    ("openmpd", 2): lambda: Board("openmpd_pair"),
    ("mega64", 1): lambda: Board("mega64"),
    ("mega64", 2): lambda: Board("mega64", lattice(128)),
    ("mega64", 3): lambda: Board("mega64", lattice(192)),
    ("mega64", 14): lambda: Board("mega64", lattice(896)),
    ("nano16", 1): lambda: Board("nano16"),
    ("nano", 1): lambda: Board("nano"),
    ("homies", 1): lambda: Board("homies", lattice(128)),
    ("homies", 2): lambda: Board("homies"),
}

every = pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{case[1]}")
single = pytest.mark.parametrize("kind", [*TICKS, "autd3"])

#: Boards that read a stream of bytes.
BYTEWISE = [case for case in CASES if case[0] != "autd3" and case[1] < 14]


def made(case: tuple[str, int]) -> tuple[Board, Rig]:
    return CASES[case](), Rig(*case)


def of_kind(kind: str) -> tuple[Board, Rig]:
    return made((kind, max(boards for name, boards in CASES if name == kind and boards < 3)))


def played(board: Board, rig: Rig, drive: Complex) -> Complex:
    """What the board emits when it is sent this drive, a half wave from the start of the period being 1."""
    return rig.play(board.encode(drive), board.channels) / TURN[board.name]


def off_grid(rng: np.random.Generator, transducers: int) -> Complex:
    return np.sqrt(rng.random(transducers)) * np.exp(TURNING * rng.random(transducers))


def forbidden(kind: str, drive: Complex) -> NDArray[np.bool]:
    """Where a drive's phase is 0x55 or 0xAA, which homies' board must not be sent: one step off."""
    codes = np.rint(np.angle(drive) * 128 / np.pi) % 256
    return ((codes == 0x55) | (codes == 0xAA)) & (kind == "homies")


def decoded(board: Board, frame: bytes) -> Complex | None:
    """The drive of a frame that may be broken, None where it is refused as it should be."""
    try:
        read = board.decode(frame)
    except ValueError as refusal:
        if not str(refusal) or "\n" in str(refusal):
            raise
        return None
    assert read.shape == (len(board.array),)
    assert np.isfinite(read).all()
    assert np.abs(read).max() <= 1 + 1e-6
    return read
