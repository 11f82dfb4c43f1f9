"""Scene files with moving points: all commands read them alike, and error messages name the line at fault."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import play
from midair._midair import Motion
from midair._sequence.solve import motion_of, solve_motion

Run = Callable[..., tuple[int, str, str]]

SCENE = """[array]
preset = "autd3"

[solver]
name = "glide"
aim = "max"

[motion]
rate = 1000
change = 0.5

[[motion.path]]
kind = "circle"
center = [0.0, 0.0, 0.15]
radius = 0.01
frequency = 5
pressure = 100
"""
FRAMES = "[array]\npreset = 'autd3'\n\n[motion]\nrate = 1000\nfile = 'frames.csv'\n"
HEADER = "frame,point,x,y,z\n"


def read(folder: Path, text: str, name: str = "scene.toml") -> Motion:
    (folder / name).write_text(text, "utf-8")
    found = motion_of(folder / name)
    assert found is not None
    return found


def drives(folder: Path, text: str, run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Returns the drives that `midair play` sends, and those that `midair motion` writes."""
    scene, solved = folder / "scene.toml", folder / "solved.npz"
    scene.write_text(text, "utf-8")
    played = play._thing(scene, None, lambda array: midair.Board("autd3", array))
    assert isinstance(played, midair.Sequence)
    status, _, err = run("motion", scene, "--output", solved)
    assert status == 0, err
    written = midair.read(solved)
    assert isinstance(written, midair.Sequence)
    solved.unlink()
    return played.drives, written.drives


@pytest.mark.slow
def test_play_and_motion_play_the_same_drives(run: Run, tmp_path: Path) -> None:
    played, solved = drives(tmp_path, SCENE, run)
    np.testing.assert_array_equal(played, solved)
    # `aim` reaches the solver: the drive is full, although the pressures need only a part of it.
    assert np.abs(played).max() == pytest.approx(1)
    # This low level lies between two amplitudes of the board: `glide` takes the lower one, and reports a
    # miss.
    with pytest.warns(midair.SceneWarning, match="missed by"):
        quiet, _ = drives(tmp_path, SCENE.replace('aim = "max"\n', ""), run)
    assert np.abs(quiet).max() < 0.1


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:point 1 takes:midair.SceneWarning")  # a weak trap on a fast circle
def test_play_and_motion_play_the_same_traps(run: Run, tmp_path: Path) -> None:
    text = 'signature = "trap"\n' + SCENE
    played, solved = drives(tmp_path, text, run)
    np.testing.assert_array_equal(played, solved)
    moving = read(tmp_path, text)
    sequence = midair.sequence(moving.scene.array, moving.path, rate=1000, change=0.5, signature="trap", aim="max")
    np.testing.assert_array_equal(played, sequence.drives)
    assert not np.array_equal(played, drives(tmp_path, SCENE, run)[0])


def test_frames_are_read_by_the_names_of_their_columns(tmp_path: Path) -> None:
    (tmp_path / "frames.csv").write_text("frame,point,z,x,y\n1,0,0.15,0.02,0\n0,0,0.15,0.01,0\n", "utf-8")
    points, _ = read(tmp_path, FRAMES).path.frames(1000)
    np.testing.assert_array_equal(points, [[[0.01, 0.0, 0.15]], [[0.02, 0.0, 0.15]]])


@pytest.mark.parametrize(
    ("rows", "fault"),
    [
        ("-1,0,0,0,0.15\n", "line 2: frame is -1: count them 0, 1, 2, ..."),
        ("0,0,0,0,0.15\n.5,0,0,0,0.15\n", "line 3: frame is 0.5"),
        ("0,0,0,0,0.15\n0,0,0,0,0.16\n", "line 3: point 0 of frame 0 is there twice"),
        ("4000000000,0,0,0,0.15\n", "4000000001 frames of 1 points need 4000000001 rows"),
        ("0,0,0,nan,0.15\n", 'line 2: y is "nan": give a number'),
        ("", "empty: give rows frame,point,x,y,z"),
    ],
)
def test_frames_that_are_none_are_refused_by_their_row(tmp_path: Path, rows: str, fault: str) -> None:
    (tmp_path / "frames.csv").write_text(HEADER + rows, "utf-8")
    with pytest.raises(midair.SceneError) as refusal:
        read(tmp_path, FRAMES)
    assert fault in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_file_that_is_not_there_is_named_once(tmp_path: Path) -> None:
    with pytest.raises(midair.SceneError) as refusal:
        read(tmp_path, FRAMES)
    assert 'line 6, column 8: motion.file is "' in str(refusal.value)
    # The reason is the system's own words.
    assert re.search(r'frames\.csv": it cannot be read \([^)]+\)+: give \.npy of', str(refusal.value))
    np.save(tmp_path / "frames.npy", np.zeros((3, 2)))
    with pytest.raises(midair.SceneError, match=r'"frames.npy": its shape is \(3, 2\)'):
        read(tmp_path, FRAMES.replace("csv", "npy"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "fault"),
    [
        ("a.toml", SCENE.replace("preset", "prest"), "a.toml, line 2, column 1: unknown key of array"),
        ("a.toml", SCENE.replace("0.01", "-1"), "line 15, column 10: motion.path[0].radius is -1"),
        ("a.toml", SCENE.replace("kind", "knid"), 'line 13, column 1: unknown key of motion.path[0] "knid"'),
        ("a.toml", SCENE.replace("rate = 1000\n", ""), "motion.rate is left out"),
        (
            "a.toml",
            SCENE.replace("rate = 1000", "rate = 1e-300"),
            "line 9, column 8: motion.rate is 1e-300: give 0.01 to 1e7 frames",
        ),
        (
            "a.toml",
            SCENE.replace("rate = 1000", "rate = 1e300"),
            "line 9, column 8: motion.rate is 1e300: give 0.01 to 1e7 frames",
        ),
        ("a.toml", SCENE.replace("rate", "when = 2020-01-01\nrate"), 'unknown key of motion "when"'),
        ("a.toml", SCENE.replace("0.5", "2020-01-01"), "a.toml, line 10, column"),
        ("a.toml", SCENE.replace("rate = 1000", "rate = inf\nrat = 1"), 'unknown key of motion "rat"'),
        (
            "a.toml",
            SCENE + "[[points]]\nposition = [0, 0, 0.1]\n",
            "points that move stand in [motion]: leave it out",
        ),
        (
            "a.toml",
            "[array]\npreset = 'autd3'\n[motion]\nrate = 1\n",
            "motion.path is left out: give [[motion.path]]",
        ),
        ("a.json", '{"array": {"preset": "autd3"}, "array": {}, "motion": {}}', "twice"),
        ("a.json", "[" * 100000, "too deep"),
    ],
)
def test_a_mistake_is_reported_in_its_own_line(run: Run, tmp_path: Path, name: str, text: str, fault: str) -> None:
    (tmp_path / name).write_text(text, "utf-8")
    with pytest.raises(midair.SceneError) as refusal:
        motion_of(tmp_path / name)
    assert fault in str(refusal.value), refusal.value
    assert str(refusal.value).count(name) == 1
    for verb in ("motion", "solve", "compare"):
        status, _, err = run(verb, tmp_path / name)
        assert status == 2
        assert err.startswith("error: ")
        assert "fault of midair" not in err
        assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("was", "now", "fault"),
    [
        ("change = 0.5", "change = inf", "line 10, column 10: motion.change is inf: give a finite number"),
        ("rate = 1000", "rate = -1000", "line 9, column 8: motion.rate is -1000.0: give a number above 0"),
        ("change = 0.5", "tau = -1", "line 10, column 7: motion.tau is -1.0: give a number"),
        ("change = 0.5", "ahead = -2", "line 10, column 9: motion.ahead is -2: give"),
    ],
)
def test_a_refused_value_of_motion_is_reported_in_its_line(tmp_path: Path, was: str, now: str, fault: str) -> None:
    with pytest.raises(midair.SceneError) as refusal:
        read(tmp_path, SCENE.replace(was, now))
    assert str(refusal.value).startswith(f"{tmp_path / 'scene.toml'}, {fault}")
    # A value passed as an argument has no line in the file.
    with pytest.raises(midair.SceneError, match=r"^rate is -3"):
        solve_motion(read(tmp_path, SCENE), rate=-3)


def test_json_and_toml_of_one_motion_are_the_same(tmp_path: Path) -> None:
    one = read(tmp_path, SCENE)
    circle = {"kind": "circle", "center": [0, 0, 0.15], "radius": 0.01, "frequency": 5, "pressure": 100}
    text = {
        "array": {"preset": "autd3"},
        "solver": {"name": "glide", "aim": "max"},
        "motion": {"rate": 1000, "change": 0.5, "path": [circle]},
    }
    other = read(tmp_path, json.dumps(text), "scene.json")
    np.testing.assert_array_equal(solve_motion(one).drives, solve_motion(other).drives)


@pytest.mark.slow
def test_a_scene_that_rests_is_no_motion(run: Run, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("[array]\npreset = 'autd3'\n[[points]]\nposition = [0, 0, 0.15]\n", "utf-8")
    assert motion_of(tmp_path / "a.toml") is None
    assert "has no [motion]" in run("motion", tmp_path / "a.toml")[2]


def test_a_focus_that_stays_is_a_path_of_a_file(tmp_path: Path) -> None:
    table = 'kind = "still"\nplaces = [[0.0, 0.0, 0.15]]\nduration = 0.02\nam = { frequency = 200 }\n'
    text = SCENE[: SCENE.index('kind = "circle"')].replace('aim = "max"\n', "")
    solved = solve_motion(read(tmp_path, text + table))
    assert (len(solved), solved.closed) == (20, True)
    assert np.all(solved.points == [0, 0, 0.15])
    assert solved.targets.max() > 1.5 * solved.targets.min()


@pytest.mark.parametrize(
    ("modulation", "fault"),
    [
        ("frequency = 201", "line 17, column 20: motion.path[0].am.frequency is 201.0: the closed path"),
        ('shape = "sqrt"', "line 17, column 6: motion.path[0].am.frequency is left out: give one"),
        (
            'frequency = 200, shape = "sin"',
            'line 17, column 33: unknown shape "sin": known are sqrt, cosine, square',
        ),
    ],
)
def test_a_fault_of_a_modulation_is_reported_in_its_line(tmp_path: Path, modulation: str, fault: str) -> None:
    text = SCENE.replace("pressure = 100", f"am = {{ {modulation} }}")
    with pytest.raises(midair.SceneError) as refusal:
        read(tmp_path, text)
    assert str(refusal.value).startswith(f"{tmp_path / 'scene.toml'}, {fault}")
