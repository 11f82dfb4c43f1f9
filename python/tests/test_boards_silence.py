"""The frame of an all-zero drive, and the bytes of silence: what the models in firmware.py play for them."""

from collections.abc import Sequence

import numpy as np
import pytest

import firmware
import midair
from firmware import KINDS, SonicSurface
from midair._boards.board import Board
from rigs import BYTEWISE, Rig, every, full, made, off_grid, played

# The frame of an all-zero drive


@every
def test_zero_is_the_boards_own_off(case: tuple[str, int]) -> None:
    board, rig = made(case)
    played(board, rig, np.ones(len(board.array)))
    for frame in (board.encode(np.zeros(len(board.array))), board.off_frame):
        assert not rig.play(frame, board.channels).any()
        assert KINDS[case[0]].off(case[1], frame)
    assert board.encode(np.zeros(len(board.array))) == board.off_frame


@every
def test_dead_and_masked_transducers_are_off_whatever_they_are_reported(case: tuple[str, int]) -> None:
    board, rig = made(case)
    size = len(board.array)
    rng = np.random.default_rng(18)
    masked, dead, sent_off = rng.random((3, size)) < 0.2
    array = midair.Array(
        board.array.positions,
        board.array.normals,
        mask=~masked,
        response=np.where(dead, 0, 1).astype(complex),
    )
    channels = board.channels
    board = Board(case[0], array, channels=channels)
    wanted = np.where(sent_off, 0, 1)
    got = played(board, rig, wanted)
    assert list(np.flatnonzero(np.abs(got) < 1e-9)) == list(np.flatnonzero(masked | dead | sent_off))
    np.testing.assert_allclose(got, full(case[0]) * wanted * ~masked * ~dead, atol=1e-6)
    assert (board.decode(board.encode(wanted))[masked | dead] == 0).all()


# The bytes of silence


def quiet(rig: Rig) -> bool:
    """Returns whether nothing plays, and nothing would if a stray byte exchanged the banks."""
    first = rig.drive
    for line in rig.lines:
        if isinstance(line, firmware.SonicSurfaces):
            line.receive(b"\xfd")
        elif isinstance(line, firmware.Arduino | firmware.Chain):
            line.receive(b"\x00")
    return not first.any() and not rig.drive.any()


def silenced(case: tuple[str, int], board: Board, before: Sequence[bytes]) -> bool:
    """Returns whether the board is quiet after its bytes of silence,
    if each line received these bytes before.
    """
    rig = Rig(*case)
    for line, data in zip(rig.lines, before, strict=True):
        line.receive(data)
    rig.receive(board.silence)
    for line in rig.lines:
        if isinstance(line, firmware.SonicSurfaces):
            assert all(one.clocks for one in line.boards)
        if isinstance(line, firmware.Chain):
            assert all(one.patterns == 1 for one in line.boards)
    return quiet(rig)


def parts(board: Board, frame: bytes) -> list[bytes]:
    part = len(frame) // board.lines
    return [frame[k : k + part] for k in range(0, len(frame), part)]


@every
def test_silence_silences_at_power_up_and_after_frames(case: tuple[str, int]) -> None:
    board, _ = made(case)
    rng = np.random.default_rng(21)
    for frames in range(4):
        before = [b""] * board.lines
        for _ in range(frames):
            frame = parts(board, board.encode(off_grid(rng, len(board.array))))
            before = [old + new for old, new in zip(before, frame, strict=True)]
        assert silenced(case, board, before)


@pytest.mark.parametrize("case", BYTEWISE, ids=lambda case: f"{case[0]}-{case[1]}")
def test_silence_silences_after_a_frame_that_was_cut_anywhere(case: tuple[str, int]) -> None:
    board, _ = made(case)
    rng = np.random.default_rng(22)
    for share in np.linspace(0, 1, 25):
        frame = parts(board, board.encode(off_grid(rng, len(board.array))))
        assert silenced(case, board, [whole + whole[: int(share * len(whole))] for whole in frame])


@pytest.mark.parametrize("case", BYTEWISE, ids=lambda case: f"{case[0]}-{case[1]}")
def test_silence_silences_after_random_bytes(case: tuple[str, int]) -> None:
    board, _ = made(case)
    rng = np.random.default_rng(23)
    for _ in range(12):
        assert silenced(case, board, [rng.bytes(int(rng.integers(1, 2000))) for _ in range(board.lines)])


def test_openmpd_is_silent_after_a_cut_frame_once_its_fifo_was_cleared() -> None:
    board, rig = made(("openmpd", 1))
    rng = np.random.default_rng(24)
    for cut in range(0, 512, 37):
        frame = board.encode(off_grid(rng, 256))
        rig.receive(frame + frame[:cut])
        for line in rig.lines:
            assert isinstance(line, firmware.OpenMpd)
            line.idle()
        rig.receive(board.silence)
        assert not rig.drive.any()


def test_one_sonicsurface_hears_its_silence_after_frames_for_two() -> None:
    board, rig = made(("sonicsurface", 1))
    rig.receive(made(("sonicsurface", 2))[0].encode(np.ones(512)))
    rig.receive(board.silence)
    assert not rig.drive.any()


@pytest.mark.parametrize("name", [192, 193])
def test_a_single_sonicsurface_plays_whichever_its_firmware(name: int) -> None:
    board, _ = made(("sonicsurface", 1))
    device = SonicSurface(name)
    device.receive(board.encode(np.ones(256)))
    # A secondary board lags as a whole; this common phase does not count.
    np.testing.assert_allclose(device.drive, device.drive[0], atol=1e-12)
    assert abs(device.drive[0]) > 0.99
    device.receive(board.silence)
    assert not device.drive.any()


def test_a_frame_for_two_sonicsurfaces_swaps_them_at_once() -> None:
    board, rig = made(("sonicsurface", 2))
    rig.receive(board.silence)
    frame = board.encode(np.ones(512))
    rig.receive(frame[:-1])
    assert not rig.drive.any()
    rig.receive(frame[-1:])
    assert np.abs(rig.drive).min() > 0.99


def test_openmpd_keeps_its_rate_and_mega64_its_one_pattern() -> None:
    board, rig = made(("openmpd", 2))
    rig.receive(board.encode(np.ones(512)) + board.silence)
    assert [line.divider for line in rig.lines if isinstance(line, firmware.OpenMpd)] == [4, 4]
    board, rig = made(("mega64", 3))
    rig.receive(board.encode(np.ones(192)))
    (chain,) = rig.lines
    assert isinstance(chain, firmware.Chain)
    assert [(one.patterns, one.durations[0]) for one in chain.boards] == [(1, 1)] * 3
