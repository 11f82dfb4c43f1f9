"""Arrays that are moved and joined, and orders of transducers, in the library as in the package."""

from ctypes import c_void_p

import numpy as np
import pytest

import midair
from library import Library

QUARTER, BESIDE = np.array([0.0, np.pi / 2, 0.0]), np.array([-0.12, 0.0, 0.13])
FOCUS = np.array([[0.02, 0.01, 0.14]])


def handles(*arrays: c_void_p) -> np.ndarray:
    return np.array([array.value for array in arrays], np.uintp)


def test_two_boards_at_right_angles_have_the_drive_of_the_package(library: Library) -> None:
    board = library.new("array_preset", "autd3", 1, 1)
    upright = library.new("array_moved", board, QUARTER, 3, BESIDE)
    rig = library.new("array_join", handles(board, upright), 2)
    for array in (board, upright):
        library.plain("array_free", array)
    one = midair.Array.preset("autd3")
    mine = midair.Array.join([one, one.moved(rotation=QUARTER, translation=BESIDE)])
    positions, normals = np.zeros((498, 3)), np.zeros((498, 3))
    library.done("array_positions", rig, positions, normals, 498)
    np.testing.assert_array_equal(positions, mine.positions)
    np.testing.assert_array_equal(normals, mine.normals)
    session = library.session(rig, "naive")
    drive, _ = library.solve(session, 498, FOCUS)
    np.testing.assert_array_equal(drive, midair.solve(midair.Scene(mine, FOCUS), "naive").drive)
    boards = library.new("board_of_session", "autd3", session)
    frame = np.zeros(library.plain("board_frame_size", boards), np.uint8)
    library.done("board_encode", boards, drive, 498, frame, len(frame))
    assert frame.tobytes() == midair.Board("autd3", mine).encode(drive)
    for kind, handle in (("board", boards), ("session", session), ("array", rig)):
        library.plain(f"{kind}_free", handle)


def test_what_cannot_be_moved_or_joined_is_one_line(library: Library) -> None:
    board, paper = library.new("array_preset", "autd3", 1, 1), library.new("array_preset", "paper20", 1, 1)
    place = np.zeros(1, np.uintp)
    for call, reported in (
        (("array_join", handles(board, paper), 2), "arrays[1] is of another frequency or air than the first"),
        (("array_join", None, 0), "arrays is empty: give at least one array"),
        (("array_join", np.zeros(1, np.uintp), 1), "arrays is NULL"),
        (("array_moved", board, np.ones(9), 9, None), "give orthonormal rows of determinant 1"),
        (("array_moved", None, None, 0, None), "from is NULL"),
    ):
        _, message = library.call(*call, place)
        assert reported in message
        assert place[0] == 0
    for array in (board, paper):
        library.plain("array_free", array)


@pytest.mark.parametrize("kind", ["sonicsurface", "mega64", "nano"])
def test_a_random_order_reaches_no_board(library: Library, kind: str) -> None:
    board = midair.Board(kind)
    count = len(board.array)
    mixed = np.random.default_rng(count).permutation(count)
    positions = np.ascontiguousarray(board.array.positions[mixed])
    array = library.new("array_new", positions, None, count)
    session = library.session(array, "naive")
    _, message = library.call("board_of_session", kind, session, np.zeros(1, np.uintp))
    assert message.startswith(f"array is in another order than {kind}: give its transducers in the order ")
    # Pins state the wiring.
    pins = board.channels[mixed].astype(float)
    library.done("session_set_numbers", session, "pins", pins, count)
    library.plain("board_free", library.new("board_of_session", kind, session))
    library.plain("session_free", session)
    library.plain("array_free", array)
