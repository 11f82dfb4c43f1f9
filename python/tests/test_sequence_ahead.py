"""Sequences solved with frames ahead in view: bound, level, delay, resumed files, error messages."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest

import midair

RATE = 10e3
CHANGE = np.pi / 32
BOARD = midair.Array.grid(16, 16, 10e-3, quantization={"phases": 256})


def fast(frames: int = 60) -> np.ndarray:
    """Returns frames of three points that cross at 2 m/s,
    too fast for the bound to let every transducer follow.
    """
    along = (np.arange(frames) - frames / 2) * 2.0 / RATE
    turns = np.array([0.3, 2.2, 4.4])
    points = np.empty((frames, 3, 3))
    points[..., 0] = [-0.03, 0.0, 0.03] + along[:, None] * np.cos(turns)
    points[..., 1] = [0.0, 0.02, -0.01] + along[:, None] * np.sin(turns)
    points[..., 2] = 0.15
    return points


def moduli(points: np.ndarray, drives: np.ndarray) -> np.ndarray:
    """Returns |p| (T, M) of point sources, in f64."""
    scene = midair.Scene(BOARD, points[0], absorption=0)
    distance = np.linalg.norm(points[:, :, None] - BOARD.positions, axis=3)
    waves = np.exp(2j * np.pi * scene.frequency / scene.sound_speed * distance) / distance
    return np.abs(np.einsum("tji,ti->tj", waves, drives))


def solved(points: np.ndarray, ahead: int | str, **given: object) -> midair.Sequence:
    return midair.sequence(BOARD, points, rate=RATE, change=CHANGE, ahead=ahead, absorption=0, **given)


def steps(codes: np.ndarray) -> np.ndarray:
    """Returns the numbers of phase steps between frames, the shorter way round."""
    apart = np.abs(np.diff(codes.astype(int), axis=0))
    return np.minimum(apart, 256 - apart)


def test_the_more_is_in_sight_the_louder_within_the_bound() -> None:
    points, levels = fast(), []
    for ahead in (0, 5, 20, "all"):
        codes = solved(points, ahead).codes
        assert codes.dtype == np.uint8
        assert steps(codes).max() == 4
        received = moduli(points, np.exp(2j * np.pi * codes / 256))
        assert (received.min(axis=1) / received.max(axis=1))[1:].min() > 0.99
        levels.append(received[3:].mean())
    assert levels == sorted(levels)
    assert levels[2] > 1.01 * levels[0]
    assert levels[2] > 0.98 * levels[3]


def test_all_in_sight_is_all() -> None:
    points = fast(24)
    whole = solved(points, "all")
    assert solved(points, 24) == whole
    assert solved(points, 1000) == whole
    quiet = solved(points, "all", pressures=200.0)
    assert solved(points, 24, pressures=200.0) == quiet
    assert quiet.codes is None
    np.testing.assert_allclose(quiet.pressures, 200, rtol=0.01)


def test_a_stream_is_so_many_frames_late() -> None:
    points, taken = fast(30), 0

    def hand():
        nonlocal taken
        for frame in points:
            taken += 1
            yield frame, np.full(3, 1e5)

    known = solved(points, 7, pressures=1e5)
    drives = midair.stream(BOARD, hand(), rate=RATE, change=CHANGE, ahead=7, absorption=0)
    for frame, drive in enumerate(drives):
        assert taken == min(frame + 8, 30)
        np.testing.assert_allclose(drive, known.drives[frame], atol=1e-6)
    assert frame == 29


def test_points_of_a_stream_come_and_go() -> None:
    points = fast(20)
    frames = [(frame[:2], [300.0, 150.0]) if t < 8 else frame for t, frame in enumerate(points)]
    drives = np.array(list(midair.stream(BOARD, frames, rate=RATE, change=CHANGE, ahead=4, absorption=0)))
    loud = np.abs(drives).max(axis=1)
    assert loud[:8].max() < 0.9
    # After a point appears, some frames are uneven, but no point is louder than requested.
    assert loud[12:].min() > 0.95
    codes = np.rint(np.angle(drives) * 128 / np.pi).astype(int) % 256
    assert steps(codes).max() <= 4
    full = moduli(points[:6, :2], drives[:6])
    np.testing.assert_allclose(full[:, 0] / full[:, 1], 2, rtol=0.01)
    assert len(list(midair.stream(BOARD, [points[0]], rate=RATE, ahead=4))) == 1
    assert not list(midair.stream(BOARD, [], rate=RATE, ahead=4))


def test_frames_without_points_are_silent_and_bind_no_one() -> None:
    points, pressures = fast(40), np.full((40, 3), 1e5)
    pressures[:8], pressures[16:30] = 0, 0
    sounds = pressures.any(axis=1)
    for ahead in (3, "all"):
        found = solved(points, ahead, pressures=pressures, aim="max")
        assert not found.drives[~sounds].any()
        np.testing.assert_allclose(np.abs(found.drives[sounds]), 1, atol=1e-6)
        assert found.metrics.largest_change <= CHANGE + 1e-6
        received = moduli(points, found.drives)[sounds]
        assert (received.min(axis=1) / received.max(axis=1)).min() > 0.99


@pytest.mark.parametrize("pressures", [None, 200.0])
def test_a_file_goes_on_where_it_was_to_the_same_bits(pressures, tmp_path, monkeypatch) -> None:
    points, file = fast(50), tmp_path / "motion.npz"
    whole = solved(points, 8, pressures=pressures)
    # The size of the blocks in a file does not change the result.
    monkeypatch.setattr("midair._sequence.solve.BLOCK", 7)
    assert solved(points, 8, pressures=pressures) == whole

    class Enough(Exception):
        pass

    for enough in (7, 21, 42, 49):

        def stop(done: int, _: int, enough: int = enough) -> None:
            if done >= enough:
                raise Enough

        with pytest.raises(Enough):
            solved(points, 8, pressures=pressures, resume=file, progress=stop)
    with pytest.raises(midair.SceneError, match="belongs to another request"):
        solved(points, 9, pressures=pressures, resume=file)
    assert solved(points, 8, pressures=pressures, resume=file) == whole
    assert midair.Sequence.load(file) == whole
    assert [path.name for path in tmp_path.iterdir()] == ["motion.npz"]


THREADS = """
import hashlib, sys
from test_sequence_ahead import fast, solved
print(hashlib.sha256(solved(fast(20), 6).codes.tobytes()).hexdigest())
"""


@pytest.mark.slow
@pytest.mark.parametrize("threads", ["1", "3"])
def test_threads_leave_no_trace(threads: str) -> None:
    reported = subprocess.run(
        [sys.executable, "-c", THREADS],
        capture_output=True,
        encoding="utf-8",
        check=True,
        cwd=os.path.dirname(__file__),
        env={**os.environ, "MIDAIR_THREADS": threads},
    )
    assert reported.stdout.strip() == hashlib.sha256(solved(fast(20), 6).codes.tobytes()).hexdigest()


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ({"ahead": -1}, "ahead is -1: give a whole number of at least 0"),
        ({"ahead": 2.0}, "ahead is 2.0: give a whole number"),
        ({"ahead": True}, "ahead is true: give a whole number"),
        ({"ahead": "some"}, 'ahead is "some": give a whole number of frames, or "all"'),
        ({"ahead": 3, "closed": True}, 'closed is true, but ahead is 3: give ahead = "all"'),
        ({"ahead": 0, "closed": True}, 'closed is true, but ahead is 0: give ahead = "all"'),
        ({"ahead": 3, "tau": 1e-4}, "tau is 0.0001: with ahead the tracks take no account of it"),
        ({"ahead": "all", "tau": 1e-4}, "tau is 0.0001: with ahead the tracks take no account of it"),
        ({"ahead": 3, "solver": "greedy"}, 'solver is "greedy": with ahead'),
        ({"ahead": 3, "aim": "loud"}, 'aim is "loud": give "target" or "max"'),
        ({"ahead": 3, "sweeps": 4}, "sweeps is given: with ahead there is no such option"),
    ],
)
def test_bad_requests_are_refused_in_a_line(given: dict[str, object], reported: str) -> None:
    with pytest.raises(midair.SceneError) as refused:
        midair.sequence(BOARD, fast(10), **{"rate": RATE, **given})
    assert reported in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_closed_sequence_asks_for_a_closed_path() -> None:
    line = midair.path.line([-0.01, 0, 0.15], [0.01, 0, 0.15], speed=0.5)
    for ahead in (0, 3, "all"):
        with pytest.raises(midair.SceneError, match=r"^closed is True: the path's end is not its start"):
            midair.sequence(BOARD, line, rate=RATE, closed=True, ahead=ahead)
    # An array of points may be closed without ending where it starts; the change at the seam is then a
    # warning.
    with pytest.warns(midair.SceneWarning, match="rad a frame, 0.196 allowed"):
        midair.sequence(BOARD, line.frames(RATE)[0][:40], rate=RATE, closed=True, ahead="all")


def test_errors_name_the_frame_of_all_frames() -> None:
    points = fast(30)
    points[23, 1] = BOARD.positions[5]
    with (
        pytest.warns(midair.SceneWarning, match="rad a frame"),
        pytest.raises(midair.SceneError, match=r"^points\[23, 1\] is 0\.000e0 m from transducer 5"),
    ):
        solved(points, 3)
    frames = iter([points[0], points[1], np.full((3, 3), np.nan)])
    with pytest.raises(midair.SceneError, match=r"^frames\[2\]: points\[0\]"):
        list(midair.stream(BOARD, frames, rate=RATE, ahead=1))
    for bad in ([], [[0, 0]], "hand", [[0, 0, 0.1], [0, 0.1]]):
        with pytest.raises(midair.SceneError, match=r"^frames\[\d\] is"):
            list(midair.stream(BOARD, [bad], rate=RATE, ahead=1))
    with pytest.raises(midair.SceneError, match=r'^ahead is "all": give a whole number'):
        midair.stream(BOARD, [points[0]], rate=RATE, ahead="all")


def test_errors_of_a_stream_name_its_frame() -> None:
    frames = [*fast(3), np.full((3, 3), np.nan)]
    with pytest.raises(midair.SceneError, match=r"^frames\[3\]: points\[0\]"):
        list(midair.stream(BOARD, frames, rate=RATE))


def test_a_bound_of_zero_is_reported_and_solvers_without_a_bound_are_not() -> None:
    ring = midair.path.circle([0, 0, 0.15], 0.02, speed=7)
    with pytest.warns(midair.SceneWarning, match=r"change is 0, and no phase changes: 6.96 m/s needs"):
        midair.sequence(BOARD, ring, rate=1e3, change=0)
    with warnings.catch_warnings(record=True) as reported:
        warnings.simplefilter("always")
        midair.sequence(BOARD, ring, "naive", rate=1e3)
    assert not [one for one in reported if "rad a frame" in str(one.message)]


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_the_last_frame_of_a_fast_lap_meets_the_first() -> None:
    board = midair.Array.grid(6, 6, 10e-3, quantization={"phases": 32})
    lap = midair.path.circle([0, 0, 0.06], 0.015, frequency=100)
    found = midair.sequence(board, lap, rate=1e3, ahead="all", change=np.pi / 4)
    assert found.closed
    assert found.changes.max() <= np.pi / 4 + 1e-6
    assert found.changes[0].max() > np.pi / 8
