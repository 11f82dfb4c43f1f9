"""Serial ports on pseudo-terminals: bytes, rate, modulation, and faults of the line."""

import errno
import os
import time

import numpy as np
import pytest

import midair
from lines import OFF, Line
from midair._boards.address import KINDS

FRAMES = 10_000 if os.environ.get("MIDAIR_SLOW") else 150
RATE = 23040 / 258


@pytest.fixture
def line():
    made = Line()
    yield made
    made.unplug()


@pytest.fixture
def surface(line):
    with midair.connect(f"sonicsurface:{line.port}") as surface:
        line.wait(lambda far: far.silent)
        yield surface


def drives(count, seed=1):
    """Returns drives that the board can play exactly, some transducers off, and their codes."""
    random = np.random.default_rng(seed)
    codes = random.integers(0, 33, (count, 256))
    return np.where(codes == OFF, 0, np.exp(2j * np.pi * codes / 32)), codes


def as_played(surface, played):
    """Returns drives from channels' codes, in the order of the board's array;
    every eighth channel is a tick late.
    """
    codes = np.array(played)[:, surface.board.channels]
    return np.where(codes == OFF, 0, np.exp(2j * np.pi * (codes + (surface.board.channels % 8 == 3)) / 32))


def early(step, late=0):
    """Returns the codes of a board's channels for one phase:
    `late` steps less, and one more step less at every eighth.
    """
    return [(step - late - (channel % 8 == 3)) % 32 for channel in range(256)]


@pytest.mark.slow
def test_every_frame_arrives_once_and_in_order(line, surface):
    sent, _ = drives(FRAMES)
    begin = time.monotonic()
    surface.stream(sent)
    took = time.monotonic() - begin
    assert took > (FRAMES - 2) / RATE
    assert took < 1.1 * FRAMES / RATE + 1
    line.wait(lambda far: len(far.played) == FRAMES + 2)
    played = [codes for _, codes in line.commits()]
    np.testing.assert_allclose(as_played(surface, played[2:]), sent, atol=1e-12)
    assert (surface.stats.frames, surface.stats.lapses) == (FRAMES, 0)
    np.testing.assert_allclose(surface.emitting, sent[-1], atol=1e-6)


def test_first_and_last_bytes_are_off_in_both_banks(line):
    with midair.connect(f"sonicsurface:{line.port}") as surface:
        line.wait(lambda far: far.silent)
        assert bytes(line.taken) == surface.board.silence
        surface.send(np.ones(256))
        line.wait(lambda far: far.loud)
    assert bytes(line.taken[-len(surface.board.silence) :]) == surface.board.silence
    assert line.surface.silent


def test_two_boards_commit_at_once():
    line = Line(boards=2)
    with midair.connect(f"sonicsurface_pair:{line.port}") as pair:
        drive = np.r_[np.ones(256), -np.ones(256)]
        pair.send(drive)
        line.wait(lambda far: far.loud)
        assert line.commits()[-1][1] == early(0) + early(16, late=17)
        np.testing.assert_allclose(pair.emitting, drive, atol=1e-6)
    assert line.surface.silent
    line.unplug()


@pytest.mark.slow
def test_at_most_two_frames_are_ahead_of_the_line(line, surface):
    begin = time.monotonic()
    for _ in range(20):
        surface.send(np.ones(256))
    assert time.monotonic() - begin > 17 / RATE
    with line.lock:
        taken = np.arange(1, len(line.times) + 1)
        times = np.array(line.times)
    carried = 23040 * (times - times[0])
    # The bytes that silence the board come before the first frame, and a busy computer reads the first byte
    # late.
    assert (taken - carried).max() < 3 * 258 + 517


@pytest.mark.slow
def test_a_stream_keeps_time(line, surface):
    sent, _ = drives(30)
    since = time.monotonic()
    begin = time.monotonic()
    surface.stream(sent, rate=50)
    assert time.monotonic() - begin == pytest.approx(30 / 50, abs=0.05)
    times = np.array([at for at, _ in line.commits(since)])
    assert len(times) == 30
    off_beat = times - np.arange(30) / 50
    assert np.median(abs(off_beat - np.median(off_beat))) < 4e-3
    assert surface.stats.late == 0


@pytest.mark.slow
def test_a_stream_above_the_rate_skips(line, surface):
    sent, _ = drives(200)
    begin = time.monotonic()
    with pytest.warns(midair.SceneWarning, match=r"rate is 400 frames/s, sonicsurface takes 89.3: 78% of the frames"):
        stats = surface.stream(sent, rate=400, late="skip")
    assert time.monotonic() - begin < 0.7
    assert stats.frames + stats.late == 200
    assert 0.7 * 0.5 * RATE < stats.frames < 0.5 * RATE + 5
    played = as_played(surface, [codes for _, codes in line.commits()][2:])
    # The played frames are frames of the stream, in its order and without accumulated delay.
    order = [int(abs(sent - one).sum(axis=1).argmin()) for one in played]
    assert order == sorted(set(order))
    assert order[-1] > 180


def test_a_stream_above_the_rate_is_an_error_where_requested(surface):
    with pytest.raises(midair.BoardTimeout, match=r"rate is 400 frames/s, sonicsurface takes 89\.3"):
        surface.stream(drives(3)[0], rate=400, late="error")
    surface.stream(drives(3)[0], rate=30, late="error")
    assert surface.stats.frames == 3


@pytest.mark.slow
def test_a_late_frame_is_an_error_where_requested(line, surface):
    def slow():
        for drive in drives(3)[0]:
            yield drive
            time.sleep(0.2)

    with pytest.raises(midair.BoardTimeout, match="ms late"):
        surface.stream(slow(), rate=50, late="error")
    line.wait(lambda far: far.silent)
    assert surface.state == "off"


@pytest.mark.slow
def test_a_slow_generator_is_played_as_it_comes(surface):
    def slow():
        for drive in drives(8)[0]:
            time.sleep(0.05)
            yield drive

    stats = surface.stream(slow(), rate=50)
    assert (stats.frames, stats.late) == (8, 7)
    assert (surface.stats.frames, surface.stats.late) == (8, 7)


def test_a_generator_that_fails_is_turned_off(line, surface):
    def failing():
        yield np.ones(256)
        yield np.ones(256)
        raise RuntimeError("of the generator")

    with pytest.raises(RuntimeError, match="of the generator"):
        surface.stream(failing(), rate=20)
    line.wait(lambda far: far.silent)


@pytest.mark.slow
def test_modulation_commits_twice_a_period_and_ends_off(line, surface):
    surface.send(np.ones(256))
    line.wait(lambda far: far.loud)
    since = time.monotonic()
    surface.modulate(200)
    begin = time.monotonic()
    assert surface.state == "modulating"
    time.sleep(max(0.0, begin + 1 - time.monotonic()))
    surface.off()
    line.wait(lambda far: far.silent)
    commits = line.commits(since)
    swaps = commits[1:-2]
    assert abs(len(swaps) - 400) <= 4
    loud = [any(code != OFF for code in codes) for _, codes in commits[:-2]]
    assert loud == [k % 2 == 1 for k in range(len(loud))]
    times = np.array([at for at, _ in swaps])
    # The swaps do not drift. On a busy computer this test cannot check jitter; test_boards_line.py does.
    assert np.median(times[-100:]) - np.median(times[:100]) == pytest.approx(0.75, abs=0.02)
    assert surface.state == "off"


@pytest.mark.slow
def test_a_new_frame_is_modulated_until_no_modulation_is_requested(line, surface):
    surface.modulate(100)
    assert surface.state == "off"
    surface.send(np.ones(256))
    assert surface.state == "modulating"
    time.sleep(0.1)
    surface.send(-np.ones(256))
    np.testing.assert_allclose(surface.emitting, -1, atol=1e-6)
    time.sleep(0.1)
    surface.modulate(None)
    assert surface.state == "playing"
    time.sleep(0.05)
    before = len(line.commits())
    time.sleep(0.1)
    assert len(line.commits()) == before
    assert line.commits()[-1][1] == early(16)


def test_a_modulation_that_the_line_cannot_carry_is_refused(surface):
    with pytest.raises(midair.BoardError, match="modulate is given 5000 Hz"):
        surface.modulate(5000)


@pytest.mark.slow
def test_a_stalled_reader_is_a_timeout(line, surface):
    surface.send(np.ones(256))
    line.wait(lambda far: far.loud)
    line.reading.clear()
    begin = time.monotonic()
    with pytest.raises(midair.BoardTimeout, match="took nothing"):
        surface.stream((np.ones(256) for _ in range(1000)), rate=RATE)
    assert time.monotonic() - begin < 2
    assert surface.state == "lost"
    begin = time.monotonic()
    surface.close()
    assert time.monotonic() - begin < 4
    line.reading.set()
    line.wait(lambda far: far.silent)


@pytest.mark.slow
def test_a_stalled_reader_that_reads_again_is_off(line, surface):
    line.reading.clear()
    with pytest.raises(midair.BoardTimeout):
        surface.stream((np.ones(256) for _ in range(1000)), rate=RATE)
    line.reading.set()
    line.wait(lambda far: far.silent)
    surface.send(np.ones(256))
    line.wait(lambda far: far.loud)
    assert surface.state == "playing"


def test_an_unplugged_board_is_lost(line, surface):
    surface.send(np.ones(256))
    line.unplug()
    with pytest.raises(midair.BoardLost, match="is gone"):
        surface.send(np.ones(256))
    with pytest.raises(midair.BoardLost, match="is gone"):
        surface.off()
    with pytest.raises(midair.BoardLost, match="is gone"):
        surface.stream([np.ones(256)] * 3)
    assert surface.state == "lost"
    assert not surface.emitting.any()
    begin = time.monotonic()
    surface.close()
    surface.close()
    assert time.monotonic() - begin < 1
    assert surface.state == "closed"


def test_a_still_focus_notices_a_pulled_cable(line, surface):
    surface.send(np.ones(256))
    line.unplug()
    begin = time.monotonic()
    # Nothing is sent: the guard checks the line by itself.
    while surface.state == "playing":
        assert time.monotonic() - begin < 2
        time.sleep(0.02)
    assert surface.state == "lost"


def played_until_the_cable_is_pulled(line, then=lambda: None):
    with midair.connect(f"sonicsurface:{line.port}") as surface:
        surface.send(np.ones(256))
        line.unplug()
        then()


def test_the_end_of_a_block_on_a_dead_link_raises(line):
    with pytest.raises(midair.BoardLost, match="the board plays on"):
        played_until_the_cable_is_pulled(line)


def test_an_error_in_a_block_goes_before_a_dead_link(line):
    with pytest.raises(KeyError):
        played_until_the_cable_is_pulled(line, {}.popitem)


def test_a_modulated_board_that_is_unplugged_is_lost(line, surface):
    surface.send(np.ones(256))
    surface.modulate(100)
    line.unplug()
    time.sleep(0.1)
    with pytest.raises(midair.BoardLost):
        surface.send(np.ones(256))


@pytest.mark.slow
def test_a_port_is_kept_by_one(line, surface):
    with pytest.raises(midair.BoardBusy, match=f'port "{line.port}" is in use'):
        midair.connect(f"sonicsurface:{line.port}")
    surface.close()
    midair.connect(f"sonicsurface:{line.port}").close()


def test_a_port_that_is_not_there(tmp_path):
    with pytest.raises(midair.BoardNotFound, match="midair ports"):
        midair.connect(f"sonicsurface:{tmp_path}/tty")
    (tmp_path / "file").touch()
    with pytest.raises(midair.BoardError, match="give a serial port"):
        midair.connect(f"sonicsurface:{tmp_path}/file")


def test_ports_that_may_not_be_opened():
    from midair._boards.serial_port import _refused

    assert isinstance(_refused("p", OSError(errno.EACCES, "Permission denied")), midair.BoardPermission)
    assert "dialout" in str(_refused("p", OSError(errno.EACCES, "Permission denied")))
    assert isinstance(_refused("p", OSError("PermissionError(13, 'Access is denied.')")), midair.BoardBusy)
    assert isinstance(_refused("COM9", OSError("FileNotFoundError(2, ...)")), midair.BoardNotFound)


@pytest.mark.parametrize(
    "name", [name for name, kind in KINDS.items() if kind.link["kind"] == "serial" and not kind.link["swap"]]
)
def test_boards_of_other_bytes(line, name):
    with midair.connect(f"{name}:{line.port}") as board:
        drive = np.exp(2j * np.pi * np.arange(len(board.board.array)) / 8)
        board.send(drive)
        length = len(board.board.silence) + len(board.board.off_frame)
        line.wait(lambda far: len(line.taken) >= length)
        assert bytes(line.taken) == board.board.silence + board.board.encode(drive)
        with pytest.raises(midair.BoardError, match=f"{name} cannot modulate"):
            board.modulate(200)
        assert board.state == "playing"
    assert bytes(line.taken).endswith(board.board.silence)


def test_ports_lists_and_opens_none(line):
    assert all(isinstance(port, midair.Port) for port in midair.ports())
