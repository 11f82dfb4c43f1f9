"""`midair.sequence` and `midair.stream`: bounds, targets, resumed files, warnings and error messages."""

from __future__ import annotations

import copy
import itertools
import json
import pickle
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import midair
from midair import _cli as cli
from midair._sequence.drives import Stored

RATE = 10e3


@pytest.fixture(scope="module")
def board() -> midair.Array:
    return midair.Array.grid(16, 16, 10e-3, quantization={"phases": 256})


@pytest.fixture(scope="module")
def ring() -> midair.path.Path:
    return midair.path.circle([0, 0, 0.15], 0.01, frequency=10, points=2)


def test_a_path_is_even_within_the_bound(board, ring):
    frames = ring.frames(RATE)[0][:120]
    found = midair.sequence(board, frames, rate=RATE, change=np.pi / 16)
    assert found.drives.shape == (120, 256)
    assert found.solver == "glide"
    assert found.change == pytest.approx(np.pi / 16)
    assert found.metrics.largest_change <= np.pi / 16 + 1e-6
    assert found.metrics.uniformity > 0.99
    # The board's phases change by whole codes.
    steps = found.changes * 256 / (2 * np.pi)
    np.testing.assert_allclose(steps, steps.round(), atol=1e-3)
    other = midair.sequence(board, frames, rate=RATE, change_rate=np.pi / 16 * RATE)
    assert np.array_equal(found.drives, other.drives)


def test_targets_in_pascals_are_met_and_modulation_is_played(ring):
    array = midair.Array.grid(16, 16, 10e-3)
    still = midair.path.line([-0.005, 0, 0.15], [0.005, 0, 0.15], speed=0.5, pressures=500.0)
    found = midair.sequence(array, still.with_am(200, "sqrt"), rate=RATE)
    there = found.targets > 25
    np.testing.assert_allclose(found.pressures[there], found.targets[there], rtol=2e-3)
    relative = midair.sequence(array, ring.with_am(200, "cosine"), rate=RATE)
    assert relative.targets.min() == pytest.approx(0.0, abs=1e-6 * relative.targets.max())
    part = relative.targets / relative.targets.max()
    np.testing.assert_allclose(relative.pressures[part > 0.1], relative.targets[part > 0.1], rtol=0.03)


@pytest.mark.parametrize("step", [0.0124, 0.004, 0.002])
def test_a_modulation_without_pressures_is_of_the_highest_even_level(step: float) -> None:
    # The balanced level counts each of the points as a focus of its own: 900 Pa instead of 2,289.
    array = midair.Array.preset("autd3")
    points = midair.shape.circle([0, 0, 0.2], 0.01, step=step)
    still = midair.path.still(points, duration=0.01)
    played = midair.sequence(array, still.modulated(200, "cosine"), rate=4000)
    plain = midair.solve(midair.Scene(array, points))
    level = abs(plain.pressures).min()
    assert played.targets.max() == pytest.approx(level, rel=0.01)
    assert abs(played.drives).max() > 0.98
    assert abs(plain.modulated(200, "cosine").pressures.max() / played.pressures.max() - 1) < 0.04


def test_a_fade_is_of_a_level_that_every_frame_reaches() -> None:
    array = midair.Array.preset("autd3")
    away = midair.path.line([0, 0, 0.15], [0.15, 0, 0.15], speed=1.0).modulated(100)
    played = midair.sequence(array, away, rate=2000, change=np.pi)
    # Below that the steps of the amplitudes are larger.
    there = played.targets > 0.3 * played.targets.max()
    np.testing.assert_allclose(played.pressures[there], played.targets[there], rtol=0.03)


def test_envelopes_are_taken_into_account(board):
    fast = midair.path.line([-0.03, 0, 0.15], [0.03, 0, 0.15], speed=2.0) & midair.path.line(
        [0.03, 0.03, 0.15], [-0.03, 0.03, 0.15], speed=2.0
    )
    tau = 2e-4
    plain, heeded = (
        midair.sequence(board, fast, rate=RATE, change=np.pi / 8, tau=time).judge(tau, substeps=1).uniformity
        for time in (None, tau)
    )
    assert heeded > plain
    assert heeded > 0.97


def test_other_solvers_are_started_from_the_last_drive(board, ring):
    frames = ring.frames(RATE)[0][:20]
    warm = midair.sequence(board, frames, "greedy", rate=RATE, change=np.pi / 16)
    assert warm.metrics.largest_change <= np.pi / 16 + 1e-6
    assert midair.sequence(board, frames, "uniform", rate=RATE).metrics.uniformity > 0.9
    with pytest.raises(midair.SceneError, match=r"^tau is 0\.0002: greedy takes no account of it"):
        midair.sequence(board, frames, "greedy", rate=RATE, tau=2e-4)


def test_a_file_goes_on_where_it_was_to_the_same_bits(board, ring, tmp_path, monkeypatch):
    monkeypatch.setattr("midair._sequence.solve.BLOCK", 16)
    frames = ring.frames(RATE)[0][:50]
    whole = midair.sequence(board, frames, rate=RATE, change=np.pi / 16)
    file = tmp_path / "motion.npz"

    class Enough(Exception):
        pass

    def stop(done: int, total: int) -> None:
        assert total == 50
        if done >= 32:
            raise Enough

    with pytest.raises(Enough):
        midair.sequence(board, frames, rate=RATE, change=np.pi / 16, resume=file, progress=stop)
    assert not file.exists()
    with pytest.raises(midair.SceneError, match="belongs to another request"):
        midair.sequence(board, frames, rate=RATE, change=np.pi / 8, resume=file)
    seen = []
    found = midair.sequence(
        board, frames, rate=RATE, change=np.pi / 16, resume=file, progress=lambda done, _: seen.append(done)
    )
    assert seen == [48, 50]
    assert found == whole
    assert midair.Sequence.load(file) == whole
    # Large arrays stay in the file and are read on demand.
    monkeypatch.setattr("midair._sequence.files.LARGE", 0)
    assert midair.Sequence.load(file) == whole
    free = midair.Array.grid(16, 16, 10e-3)
    other = midair.sequence(free, frames[:20], rate=RATE, resume=tmp_path / "free.npz")
    assert isinstance(midair.Sequence.load(tmp_path / "free.npz")._drives.kept, Stored)
    assert other == midair.sequence(free, frames[:20], rate=RATE)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["free.npz", "motion.npz"]


def test_files_that_go_on_and_copies_keep_the_time_constant(ring, tmp_path, monkeypatch):
    monkeypatch.setattr("midair._sequence.solve.BLOCK", 8)
    array, file, frames = midair.Array.grid(8, 8, 10e-3), tmp_path / "motion.npz", ring.frames(RATE)[0][:16]
    slow = {"rate": RATE, "change": np.pi / 16, "tau": 2e-4}
    whole = midair.sequence(array, frames, **slow)
    assert not np.array_equal(whole.drives, midair.sequence(array, frames, **slow | {"tau": 0}).drives)

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        midair.sequence(array, frames, **slow, resume=file, progress=stop)
    with pytest.raises(midair.SceneError, match="belongs to another request"):
        midair.sequence(array, frames, **slow | {"tau": 1e-4}, resume=file)
    assert midair.sequence(array, frames, **slow, resume=file) == whole
    solver = midair.Solver(array, "glide", **slow)
    solver.follow(frames[:8])
    last = solver.last()
    rest = solver.follow(frames[8:])
    for one in (copy.copy(solver), pickle.loads(pickle.dumps(solver))):
        assert one.options == solver.options
        one.restore(*last)
        assert np.array_equal(one.follow(frames[8:]), rest)


def test_a_stream_yields_a_drive_a_frame(board, ring):
    frames = ring.frames(RATE)[0]
    whole = midair.sequence(board, frames[:5], rate=RATE)
    drives = midair.stream(board, iter(frames), rate=RATE)
    for drive, known in zip(itertools.islice(drives, 5), whole.drives, strict=True):
        np.testing.assert_allclose(drive, known, atol=1e-6)
    loud = list(midair.stream(board, [(frames[0], [500.0, 250.0])], rate=RATE))
    got = abs(midair.Scene(board, frames[0]).propagation() @ loud[0])
    np.testing.assert_allclose(got, [500, 250], rtol=0.02)


def test_a_path_above_the_speed_limit_is_reported(board):
    quick = midair.path.line([-0.03, 0, 0.15], [0.03, 0, 0.15], speed=10.0)
    with pytest.warns(
        midair.SceneWarning,
        match=r"10 m/s needs .* rad a frame, 0\.196 allowed.*kHz or change = pi/\d+ would do",
    ):
        found = midair.sequence(board, quick, rate=RATE)
    assert found.metrics.largest_change <= np.pi / 16 + 1e-6
    faster = midair.path.circle([0, 0, 0.15], 0.03, speed=7)
    with pytest.warns(midair.SceneWarning, match=r"needs 2\.9 rad a frame, .* or change = pi would do"):
        midair.sequence(midair.Array.preset("autd3"), faster, rate=1000)


def test_a_bound_below_a_phase_step_is_reported_once():
    coarse = midair.Array.grid(8, 8, 10e-3, quantization={"phases": 10})
    line = midair.path.line([-0.002, 0, 0.15], [0.002, 0, 0.15], speed=0.5).frames(RATE)[0]
    requested = (
        lambda: midair.sequence(coarse, line, rate=RATE),
        lambda: midair.sequence(coarse, line, "greedy", rate=RATE, change=0.2),
        lambda: midair.sequence(coarse, line, rate=RATE, ahead=10),
        lambda: midair.sequence(coarse, line, rate=RATE, ahead="all"),
        lambda: list(midair.stream(coarse, line, rate=RATE)),
    )
    for ask in requested:
        with warnings.catch_warnings(record=True) as reported:
            warnings.simplefilter("always")
            ask()
        assert len(reported) == 1
        assert "less than a step of the board's 10 phases, 0.628 rad: no phase changes" in str(reported[0].message)


def test_the_speed_limit_is_that_of_whole_phase_steps():
    coarse = midair.Array.grid(8, 8, 10e-3, quantization={"phases": 40})
    line = midair.path.line([-0.01, 0, 0.15], [0.01, 0, 0.15], speed=12.0)
    with pytest.warns(
        midair.SceneWarning, match=r"0\.157 allowed in whole steps of 40 phases: .* or change = pi/10 would"
    ):
        midair.sequence(coarse, line, rate=RATE)
    jump = midair.path.line([-0.06, 0, 0.15], [0.06, 0, 0.15], speed=30.0)
    with pytest.warns(midair.SceneWarning, match=r"needs .* allowed: the level falls; rate = [\d.]+ kHz would do"):
        midair.sequence(midair.Array.grid(8, 8, 10e-3), jump, rate=1e3)


def test_names_of_solvers_ignore_case(board, ring):
    frames = ring.frames(RATE)[0][:20]
    found = midair.sequence(board, frames, "Glide", rate=RATE, change=0.05)
    assert found.solver == "glide"
    assert found.metrics.largest_change <= 0.05


def test_a_jump_from_the_last_frame_to_the_first_is_reported_of_closed_paths() -> None:
    array, frames = midair.Array.grid(8, 8, 10e-3), np.arange(21)[:, None, None] * [2e-4, 0, 0] + [0, 0, 0.1]
    midair.sequence(array, midair.path.from_array(frames, rate=1e3), rate=1e3)
    with pytest.warns(midair.SceneWarning, match=r"^4 m/s needs"):
        midair.sequence(array, midair.path.from_array(frames, rate=1e3, closed=True), rate=1e3)


def test_a_time_constant_of_more_than_a_thousand_frames_is_refused() -> None:
    with pytest.raises(midair.SceneError, match=r"^tau is 0\.2: give at most 1e-1 s, the time of 1000 frames"):
        midair.Solver(midair.Array.grid(3, 3, 0.01), "glide", tau=0.2, rate=1e4)


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_an_error_in_a_later_block_names_its_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("midair._sequence.solve.BLOCK", 4)
    array, frames = midair.Array.grid(4, 4, 10e-3), np.full((8, 1, 3), [0, 0, 0.1])
    frames[6] = array.positions[5]
    with pytest.raises(midair.SceneError, match=r"^frames\[6\]: points\[0\]") as refused:
        midair.sequence(array, frames, rate=1e3, change=np.pi)
    assert (refused.value.code, refused.value.index) == ("too-near", 6)


def test_units_taken_for_others_are_reported_once():
    with warnings.catch_warnings(record=True) as reported:
        warnings.simplefilter("always")
        midair.sequence(
            midair.Array.grid(8, 8, 10e-3),
            midair.path.line([-10, 0, 150], [10, 0, 150], speed=500),
            rate=RATE,
        )
    assert [str(one.message).split(":")[0] for one in reported] == ["points[0].position is [-10, 0, 150] m"]


@pytest.mark.parametrize(
    ("frames", "given", "reported"),
    [
        ([[0, 0, 0.1]], {}, "frames[0] is of shape (3,): give points x 3 numbers in m"),
        ([[[[0, 0, 0.1]], [500]]], {}, "pressures if any as the second of a pair"),
        (5, {}, "frames is 5: give points (M, 3) in m, frame after frame"),
        (midair.path.line([0, 0, 0.1], [0, 0, 0.2], speed=1), {}, "give path.frames(rate)[0]"),
        ([[[0, 0, 0.1]]], {"pressures": 500}, "pressures is 500: a stream takes them with each frame"),
        ([[[0, 0, 0.1]]], {"closed": True}, "closed is True: a stream has no last frame"),
    ],
)
def test_what_is_no_stream_is_refused_in_a_line(board, frames, given, reported):
    with pytest.raises((midair.SceneError, TypeError)) as refused:
        list(midair.stream(board, frames, rate=RATE, **given))
    assert reported in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ({"rate": 0}, "rate is 0: give a number above 0"),
        ({"rate": float("nan")}, "rate is nan"),
        ({"change": -0.1}, "change is -0.1"),
        ({"change": 0.1, "change_rate": 3.0}, "change_rate is 3.0: change is given, too"),
        ({"closed": True}, "closed is True"),
        ({"ahead": -3}, "ahead is -3"),
        ({"tau": -1.0}, "tau is -1.0"),
        ({"solver": "glid"}, 'unknown solver "glid": did you mean glide?'),
        ({"pressures": [1.0, 2.0, 3.0]}, "pressures is of shape"),
        ({"aim": "loud"}, "aim"),
    ],
)
def test_bad_requests_are_refused_in_a_line(board, given, reported):
    line = midair.path.line([-0.01, 0, 0.15], [0.01, 0, 0.15], speed=0.5)
    with pytest.raises(midair.SceneError) as refused:
        midair.sequence(board, line, **{"rate": RATE, **given})
    assert reported in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.filterwarnings("ignore:.*nearer than a quarter of the wavelength:midair.SceneWarning")
def test_a_point_on_a_transducer_and_frames_of_other_sizes_are_named(board):
    through = np.array([[[0.005, 0.005, z]] for z in (2e-4, 1e-4, 0.0)])
    with pytest.raises(midair.SceneError, match=r"frames\[2\]"):
        midair.sequence(board, through, rate=RATE)
    with pytest.raises(midair.SceneError, match="M changes from 1 to 2 at frame 1"):
        midair.sequence(board, [[[0, 0, 0.1]], [[0, 0, 0.1], [0, 0.01, 0.1]]], rate=RATE)


SCENE = """
[array]
grid = { nx = 16, ny = 16, pitch = 10e-3 }

[motion]
rate = 10e3
change = 0.2

[[motion.path]]
kind = "circle"
center = [0.0, 0.0, 0.15]
radius = 0.01
frequency = 50
"""


def ran(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "midair", "motion", *map(str, words)],
        capture_output=True,
        encoding="utf-8",
        check=False,
    )


@pytest.mark.slow
def test_the_command_writes_what_it_is_requested(tmp_path: Path):
    scene = tmp_path / "orbit.toml"
    scene.write_text(SCENE, "utf-8")
    out, image = tmp_path / "orbit.npz", tmp_path / "orbit.png"
    done = ran(scene, "-o", out, "--image", image)
    assert done.returncode == 0, done.stderr
    assert "200 frames of 1 point at" in done.stdout
    assert image.read_bytes().startswith(b"\x89PNG")
    assert len(midair.Sequence.load(out)) == 200
    reported = ran(scene, "--json", "--solvers", "glide,uniform")
    assert set(json.loads(reported.stdout)) == {"glide", "uniform"}


@pytest.mark.slow
def test_the_command_writes_a_closed_sequence(tmp_path: Path):
    scene, out = tmp_path / "orbit.toml", tmp_path / "orbit.npz"
    scene.write_text(SCENE.replace("change = 0.2", 'change = 0.2\nclosed = true\nahead = "all"'), encoding="utf-8")
    done = ran(scene, "-o", out)
    assert done.returncode == 0, done.stderr
    assert midair.Sequence.load(out).closed


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        (("rate = 10e3", ""), "motion.rate is left out"),
        (
            ("[motion]", "[[points]]\nposition = [0, 0, 0.1]\n[motion]"),
            "points that move stand in [motion]: leave it out",
        ),
        (('kind = "circle"', 'kind = "spiral"'), 'motion.path[0].kind is "spiral"'),
        (("radius = 0.01", ""), "motion.path[0].radius is left out"),
        (("change = 0.2", "chnge = 0.2"), 'line 7, column 1: unknown key of motion "chnge"'),
        ((SCENE[SCENE.index("[motion]") :], ""), "has no [motion]"),
        (("frequency = 50", "frequency = 50\nam = 3"), "motion.path[0].am is 3"),
        (("rate = 10e3", "rate = "), "no TOML here"),
    ],
)
def test_a_bad_scene_file_is_refused_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: tuple[str, str], reported: str
):
    scene = tmp_path / "orbit.toml"
    scene.write_text(SCENE.replace(*change), encoding="utf-8")
    with pytest.raises(SystemExit) as left:
        cli.main(["motion", str(scene)])
    error = capsys.readouterr().err
    assert left.value.code == 2
    assert reported in error
    assert error.startswith("error: ")
    assert error.count("\n") == 1


@pytest.mark.slow
def test_tracks_over_the_whole_sequence_close_without_a_seam(board):
    circles = midair.path.circle([-0.02, 0, 0.15], 0.004, frequency=100) & midair.path.circle(
        [0.02, 0, 0.15], 0.004, frequency=100
    )
    steps = []
    found = midair.sequence(
        board,
        circles,
        rate=RATE,
        change=np.pi / 16,
        ahead="all",
        closed=True,
        progress=lambda *at: steps.append(at),
    )
    assert found.closed
    assert found.drives.shape == (100, 256)
    assert max(found.metrics.seam, found.metrics.largest_change) <= np.pi / 16 + 1e-6
    assert found.metrics.uniformity > 0.99
    assert steps[-1][0] == steps[-1][1]
    quiet = midair.sequence(board, circles, rate=RATE, change=np.pi / 16, ahead="all", closed=True, pressures=300.0)
    np.testing.assert_allclose(quiet.pressures, 300, rtol=0.02)
    with pytest.raises(midair.SceneError, match='solver is "uniform"'):
        midair.sequence(board, circles, "uniform", rate=RATE, ahead="all")


def test_no_board_is_requested_by_an_empty_quantization(ring):
    array = midair.Array.grid(6, 6, 10e-3, quantization={"phases": 16})
    path = midair.path.circle([0, 0, 0.15], 0.01, frequency=2)
    free = midair.sequence(array, path, rate=200, change=np.pi, quantization={})
    assert free.quantization is None
    assert free.metrics.level == pytest.approx(1, rel=1e-3)
    assert free == midair.sequence(
        array, path, rate=200, change=np.pi, quantization={"phases": None, "amplitudes": None}
    )


def test_more_frames_in_sight_than_there_are_is_all_of_them():
    array = midair.Array.grid(6, 6, 10e-3, quantization={"phases": 16})
    path = midair.path.circle([0, 0, 0.15], 0.01, frequency=2)
    found = midair.sequence(array, path, rate=100, change=np.pi, ahead=10**30)
    assert np.array_equal(found.codes, midair.sequence(array, path, rate=100, change=np.pi, ahead=50).codes)
    frames = [[[0, 0, 0.1]]] * 3
    assert len(list(midair.stream(array, iter(frames), rate=200, change=np.pi, ahead=10**30))) == 3


def test_numbers_below_the_least_are_no_error():
    array = midair.Array.preset("sonicsurface")
    path = midair.path.circle([0, 0, 0.15], 0.01, frequency=2)
    plain = midair.sequence(array, path, rate=200, change=np.pi)
    with np.errstate(all="raise"):
        found = midair.sequence(array, path, rate=200, change=np.pi)
        assert found.metrics == plain.metrics
        found.between(1e-4)
        found.felt([0, 0, 0.15], bands=[(5, 50)])


@pytest.mark.slow
@pytest.mark.parametrize(("points", "most"), [(1, 1.0), (4, 1.5), (8, 1.5)])
def test_glide_keeps_codes_of_few_phases(points: int, most: float) -> None:
    """Checks that about as few codes change (a change is audible) as after rounding free phases.

    Over eight paths: of one alone the ratio is 1.04 to 1.79 with four points, and depends on the last bits.
    """
    few = free = 0
    for begin in (0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.3):
        t, turn = np.arange(200)[:, None] / 10e3, 2 * np.pi * np.arange(points) / points + begin
        x, y = (0.02 * of(2 * np.pi * 6 * t + turn) for of in (np.cos, np.sin))
        path = np.stack([x, y, np.full_like(x, 0.2)], -1)
        few += changed_codes(path, {"phases": 32})
        free += changed_codes(path, {})
    assert 0.5 * free < few <= most * free


def changed_codes(path: np.ndarray, quantization: dict[str, int]) -> int:
    """Returns how many codes of 32 phases change along a path."""
    board = midair.Array.grid(16, 16, 10.5e-3, quantization=quantization)
    drives = np.asarray(midair.sequence(board, path, rate=10e3).drives)
    return np.count_nonzero(np.diff(np.round(np.angle(drives) / (2 * np.pi / 32)) % 32, axis=0))


def test_a_modulation_that_max_would_ignore_is_warned_of() -> None:
    path = midair.path.still([0, 0, 0.15], duration=0.01).modulated(200.0)
    array = midair.Array.grid(8, 8, 10e-3)
    with pytest.warns(midair.SceneWarning, match='aim is "max", but pressures change between frames: leave it out'):
        midair.sequence(array, path, rate=2000, aim="max")


def test_a_file_that_was_resumed_closed_is_not_the_open_one(tmp_path: Path) -> None:
    array, ring = midair.Array.grid(8, 8, 0.01), midair.path.circle([0, 0, 0.1], 0.01, frequency=50)
    file = tmp_path / "a.npz"
    assert midair.sequence(array, ring, rate=RATE, resume=file).closed
    with pytest.raises(midair.SceneError, match=r"a\.npz"):
        midair.sequence(array, ring, rate=RATE, closed=False, resume=file)


def test_a_stream_warns_once_of_points_that_are_too_fast() -> None:
    array = midair.Array.preset("autd3")
    places = [[[0, 0, 0.15]], [[1e-4, 0, 0.15]], [[0.0051, 0, 0.15]], [[0.0101, 0, 0.15]]]
    with pytest.warns(midair.SceneWarning) as found:
        list(midair.stream(array, places, rate=1e3))
    (line,) = (str(each.message) for each in found)
    words = r"a point moves by 5 mm in a frame, which needs phase changes of 1\.\d+ rad, 0\.196 allowed: "
    assert re.match(words, line)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        list(midair.stream(array, places[:2], rate=1e3))
        list(midair.stream(array, places, rate=1e3, change=np.pi))
