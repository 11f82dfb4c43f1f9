"""Warnings of probable mistakes: real-valued drives, too high rates,
sequences that jump where they repeat.
"""

import warnings
from pathlib import Path

import numpy as np
import pytest

import midair
from test_boards_connection import frames, loop as loop


@pytest.mark.parametrize("drive", [np.linspace(0, 1, 256), [7] * 256, np.full(256, 0.5, np.float32)])
def test_real_numbers_are_no_drive_but_on_off_and_reversed(loop, drive):
    with pytest.raises(midair.SceneError, match=r"real numbers are no drive: give np.exp\(1j \* phases\)"):
        loop.send(drive)
    loop.send(np.sign(drive))
    loop.send(np.clip(drive, 0, 1) + 0j)


def test_a_line_without_a_device_holds_what_its_board_does():
    with midair.connect("autd3:loop") as autd3, warnings.catch_warnings():
        warnings.simplefilter("ignore", midair.SceneWarning)
        autd3.upload(frames(autd3.board.array, 4, 8))
        autd3.modulate(150)
        assert autd3.state == "modulating"
        with pytest.raises(midair.BoardError, match="modulation at 1001 Hz: an AUTD3 board modulates at"):
            autd3.modulate(1001)
        for rate, count, why in (
            (999, 4, "the nearest is 1000"),
            (8, 1, "holds 2 to 1024"),
            (0.5, 4, "up to 65535"),
        ):
            with pytest.raises(midair.BoardError, match=why):
                autd3.upload(frames(autd3.board.array, count, rate))


def test_a_mega64_is_warned_of_where_its_bytes_stop_its_pins():
    with (
        midair.connect("mega64:loop") as mega64,
        pytest.warns(midair.SceneWarning, match="above 10 frames/s"),
    ):
        mega64.stream(np.ones((3, 64)), rate=40)


@pytest.mark.slow
def test_a_closed_path_gives_a_closed_sequence():
    array = midair.Array.preset("autd3")
    ring = midair.path.circle([0, 0, 0.15], 0.01, frequency=5)
    found = midair.sequence(array, ring, rate=2000)
    assert found.closed
    assert found.metrics.seam is not None
    whole = midair.sequence(array, ring, rate=2000, ahead="all")
    assert whole.closed
    assert whole.metrics.seam <= whole.change * (1 + 1e-6)
    assert not midair.sequence(array, ring, rate=2000, closed=False).closed
    line = midair.path.line([-0.01, 0, 0.15], [0.01, 0, 0.15], speed=0.2)
    assert not midair.sequence(array, line, rate=2000).closed
    with midair.connect("autd3:loop") as autd3:
        autd3.upload(whole)
        with pytest.warns(midair.SceneWarning, match='begins anew with a jump of .* ahead="all"'):
            autd3.upload(midair.sequence(array, line, rate=2000))


def test_a_bound_above_half_a_turn_may_be_in_degrees():
    array = midair.Array.preset("autd3")
    with pytest.warns(midair.SceneWarning, match=r"change is 5 rad, and above pi binds nothing: give 0.0873"):
        midair.sequence(array, [[[0, 0, 0.15]], [[0, 0, 0.151]]], rate=100, change=5, pressures=1000)


def test_an_array_of_another_board_gets_the_phases_of_this_one() -> None:
    foreign = midair.Array.preset("sonicsurface", quantization=midair.Array.preset("autd3").quantization)
    with pytest.warns(midair.SceneWarning, match="256 phases, a sonicsurface board 32: board.array has"):
        board = midair.Board("sonicsurface", array=foreign)
    assert (board.array.quantization or {})["phases"] == 32
    # Fewer phases than the board's are no fault.
    coarse = midair.Array.preset("sonicsurface", quantization={"phases": 8})
    assert (midair.Board("sonicsurface", array=coarse).array.quantization or {})["phases"] == 8


def test_a_drive_that_a_board_rounds_to_nothing_is_a_warning(tmp_path: Path) -> None:
    board = midair.Board("sonicsurface")
    weak = np.full(len(board.array), 0.2, complex)
    with pytest.warns(
        midair.SceneWarning, match="the drive is at most 0.20: sonicsurface switches all transducers off"
    ):
        midair.write(tmp_path / "weak.bin", weak, board=board)
    with midair.connect("sonicsurface:loop") as surface:
        with pytest.warns(
            midair.SceneWarning, match="transducers off; multiply the drive, or solve for the board's array"
        ):
            surface.send(weak)
        surface.send(np.zeros(len(board.array), complex))
