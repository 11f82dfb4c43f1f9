"""Kinds and numbers of boards with models of their firmware, for tests of the bytes sent to them."""

import numpy as np
import pytest
from numpy.typing import NDArray

import midair
from firmware import KINDS
from midair._boards.board import Board
from midair._midair import Codec
from pulses import Codes, Complex, edges, pulses

TURNING = 2j * np.pi


class Rig:
    """The models of the boards of a kind; a frame has one part of the same length for each line."""

    def __init__(self, kind: str, boards: int = 1) -> None:
        self.lines = KINDS[kind].lines(boards)

    def receive(self, frame: bytes) -> None:
        part, rest = divmod(len(frame), len(self.lines))
        assert rest == 0, "a frame is equal parts for its lines"
        for k, line in enumerate(self.lines):
            line.receive(frame[k * part : (k + 1) * part])

    def play(self, frame: bytes, channels: Codes) -> Complex:
        """Plays a frame, and returns the drive of the transducers on these channels."""
        self.receive(frame)
        return self.drive[channels]

    @property
    def drive(self) -> Complex:
        return np.concatenate([line.drive for line in self.lines])


LENGTHS = {kind: known.ticks for kind, known in KINDS.items() if known.ticks}
TICKS = {kind: len(edges(ticks)) - 1 for kind, ticks in LENGTHS.items()}
WIDTHS = {kind: known.widths for kind, known in KINDS.items() if known.widths}

#: By kind: the drive of a half-period pulse that starts with the period. Boards with pulses call it phase 0.
TURN = {kind: 1j if known.ticks else 1.0 for kind, known in KINDS.items()}


def playable(kind: str) -> Complex:
    """Returns all drives that a kind of board can play, from all pulses (widths, starts) or codes."""
    if kind == "autd3":
        phases, amplitudes = np.arange(256) / 256, np.arange(256) / 255
        return np.ravel(amplitudes * np.exp(TURNING * phases[:, None]))
    ticks = TICKS[kind]
    starts, widths = np.meshgrid(np.arange(ticks), np.array(WIDTHS.get(kind, (0, ticks // 2))))
    # midair decodes a drive as if all ticks were equal and as near as possible to the real edges. The rest of
    # each delay is in the array's response.
    early = np.unwrap(np.angle(edges(LENGTHS[kind])[:-1])) - 2 * np.pi * np.arange(ticks) / ticks
    return pulses(starts, widths, LENGTHS[kind]) / TURN[kind] * np.exp(-1j * early.mean())


def full(kind: str) -> complex:
    """Returns the drive nearest to 1 that a board can play."""
    own = playable(kind)
    return complex(own[np.abs(own - 1).argmin()])


def assert_nearest(kind: str, got: Complex, wanted: Complex) -> None:
    """Checks that the kind can play each drive, and that no other one is nearer to the wanted drive."""
    own, wanted = playable(kind), np.broadcast_to(wanted, got.shape)
    for one, other in zip(got, wanted, strict=True):
        assert np.abs(one - own).min() < 1e-6
        assert abs(one - other) <= np.abs(other - own).min() + 1e-6


#: Numbers of boards that are played together. The other kinds are tested with one, and with two if they allow
#: it.
TOGETHER = {"autd3": (1, 2, 4), "mega64": (1, 2, 3, 14)}

#: All pairs of a kind and a number of boards.
CASES = [
    (kind, boards)
    for kind, known in Codec.kinds().items()
    for boards in TOGETHER.get(kind, range(1, min(known.most_boards, 2) + 1))
]

every = pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{case[1]}")
single = pytest.mark.parametrize("kind", KINDS)

#: The cases without AUTD3, whose frame is not a stream of bytes, and without the long chain of 14 boards.
BYTEWISE = [case for case in CASES if case[0] != "autd3" and case[1] < 14]


def made(case: tuple[str, int]) -> tuple[Board, Rig]:
    """Returns boards of a kind with their model; their array is the kind's own if it has one, else a grid."""
    kind, boards = case
    board = Board(kind)
    if boards != board.boards:
        channels = len(board.array) // board.boards
        if f"{kind}_pair" in midair.presets():
            board = Board(f"{kind}_pair")
        elif kind in midair.presets():
            board = Board(kind, tiles=(2, boards // 2))
        else:
            board = Board(kind, midair.Array.grid(8, boards * channels // 8, 10e-3))
    assert board.boards == boards
    return board, Rig(kind, boards)


def of_kind(kind: str) -> tuple[Board, Rig]:
    return made((kind, max(boards for name, boards in CASES if name == kind and boards < 3)))


def played(board: Board, rig: Rig, drive: Complex) -> Complex:
    """Returns the output of the boards for this drive."""
    return received(board, rig, board.encode(drive))


def received(board: Board, rig: Rig, frame: bytes) -> Complex:
    """Returns the drive that the board plays for a frame; a half-period pulse from the period's start is 1.

    The delays of the pins are divided out: the array has them as its response, and solvers compensate for
    them.
    """
    response = board._codec.response
    return rig.play(frame, board.channels) / TURN[board.name] / (1.0 if response is None else response)


def off_grid(rng: np.random.Generator, transducers: int) -> Complex:
    return np.sqrt(rng.random(transducers)) * np.exp(TURNING * rng.random(transducers))


def forbidden(kind: str, drive: Complex) -> NDArray[np.bool]:
    """Returns which phase codes of a homies board would be 0x55 or 0xAA: neighbours replace these."""
    codes = np.rint(np.angle(drive) * 128 / np.pi) % 256
    return ((codes == 0x55) | (codes == 0xAA)) & (kind == "homies")


def decoded(board: Board, frame: bytes) -> Complex | None:
    """Returns the drive of a frame that may be broken; None if it is rejected with a proper message."""
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
