"""`midair.tolerate`: closed forms, a reference in plain NumPy, seeds, stops and the command line."""

from __future__ import annotations

import json
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import midair
from midair import _cli as cli
from midair._judging.tolerate import faulty

ARRAY = midair.Array.grid(16, 16, 10e-3)
POINTS = np.array([[-0.03, 0.01, 0.15], [0.02, 0.03, 0.15], [0.01, -0.03, 0.16]])
SCENE = midair.Scene(ARRAY, POINTS)


@pytest.mark.parametrize(
    ("fault", "size", "left"),
    [
        ("phase", 20, np.exp(-(np.radians(20) ** 2) / 2)),
        ("phase", 40, np.exp(-(np.radians(40) ** 2) / 2)),
        ("dead", 0.05, 0.95),
        ("reversed", 0.05, 0.9),
        ("gain", 0.2, 1.0),
    ],
)
def test_levels_are_those_of_the_closed_forms(fault: str, size: float, left: float) -> None:
    table = midair.tolerate(SCENE, "uniform", trials=150, seed=1, **{fault: size})
    assert table.trials == 150
    assert table[fault].level.mean() == pytest.approx(left, abs=0.01)


def played(scene: midair.Scene, drive: np.ndarray, positions: np.ndarray, response: np.ndarray, speed: float):
    """Returns the mean and the min/max of |p| / target, in float64."""
    distance = np.linalg.norm(POINTS[:, None] - positions, axis=2)
    pressure = (4.386 / distance * np.exp(2j * np.pi * 40e3 / speed * distance)) @ (response * drive)
    parts = np.abs(pressure)
    return parts.mean(), parts.min() / parts.max()


def test_every_trial_is_that_of_numpy() -> None:
    scene = SCENE.replace(pressures=[1000, 1000, 1000])
    sizes = {"phase": 20.0, "gain": 0.1, "dead": 0.1, "reversed": 0.1}
    sizes |= {"temperature": 8.0, "tilt": 2.0, "position": 1e-3}
    table = midair.tolerate(scene, "uniform", trials=12, seed=7, **sizes)
    assert table.solution is not None
    drive = table.solution.drive.astype(complex)
    whole = played(scene, drive, ARRAY.positions, np.ones(256), 340)
    for trial in range(12):
        randoms = [np.random.default_rng([7, trial, index]) for index in range(7)]
        response = np.exp(1j * np.radians(20) * randoms[0].standard_normal(256))
        response *= 1 + 0.1 * randoms[1].standard_normal(256)
        response[randoms[2].random(256) < 0.1] = 0
        response[randoms[3].random(256) < 0.1] *= -1
        warmth = 273.15 * (340 / 331.3) ** 2 + 8 * randoms[4].standard_normal()
        axis, angle = randoms[5].standard_normal(3), np.radians(2) * randoms[5].standard_normal()
        axis[2] = 0
        axis /= np.linalg.norm(axis)
        # Rodrigues' rotation of the array, which lies in z = 0 around the origin.
        along = np.outer(ARRAY.positions @ axis, axis)
        positions = along + np.cos(angle) * (ARRAY.positions - along)
        positions += np.sin(angle) * np.cross(axis, ARRAY.positions)
        positions += 1e-3 * randoms[6].standard_normal((256, 3))
        got = played(scene, drive, positions, response, 331.3 * np.sqrt(warmth / 273.15))
        row = table["together"]
        assert row.level[trial] == pytest.approx(got[0] / whole[0], abs=2e-4)
        assert row.uniformity[trial] == pytest.approx(got[1] / whole[1], abs=5e-4)


def test_a_seed_is_the_same_table_whatever_the_threads() -> None:
    requested = {"phase": 15, "tilt": 0.5, "trials": 25}
    one, other = (midair.tolerate(SCENE, "naive", seed=3, threads=count, **requested) for count in (1, 2))
    for name in ("phase", "tilt", "together"):
        np.testing.assert_array_equal(one[name].level, other[name].level)
        np.testing.assert_array_equal(one[name].uniformity, other[name].uniformity)
    # A fault has the same random draws whichever other faults are requested.
    alone = midair.tolerate(SCENE, "naive", seed=3, tilt=0.5, trials=25)
    np.testing.assert_array_equal(alone["tilt"].level, one["tilt"].level)
    assert list(alone.rows) == ["tilt"]
    again = midair.tolerate(SCENE, "naive", seed=4, tilt=0.5, trials=25)
    assert (again["tilt"].level != alone["tilt"].level).any()


def test_a_tilt_keeps_distances_and_what_else_the_array_has() -> None:
    mask = np.arange(256) > 3
    array = midair.Array.grid(16, 16, 10e-3, response=np.full(256, 0.5j), directivity="t4010a1", mask=mask)
    scene = midair.Scene(array, POINTS, temperature=25, absorption=0.1)
    turned = faulty(scene, {"tilt": 3.0}, 0, 0)
    apart = [np.linalg.norm(one.array.positions - one.array.positions[0], axis=1) for one in (scene, turned)]
    np.testing.assert_allclose(*apart, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(turned.array.normals, axis=1), 1)
    assert 1e-3 < np.abs(turned.array.positions[:, 2]).max() < 0.03
    assert turned.sound_speed == scene.sound_speed
    assert (turned.array.mask == mask).all()
    assert (turned.array.response == array.response).all()
    assert turned.array.directivity == array.directivity


def test_traps_keep_their_signature() -> None:
    pair = midair.Array.preset("openmpd_pair")
    middle = pair.positions.mean(axis=0)
    table = midair.tolerate(midair.Scene(pair, [middle], signature="trap"), phase=20, tilt=0.5, trials=10)
    assert table["phase"].level.mean() == pytest.approx(np.exp(-(np.radians(20) ** 2) / 2), abs=0.03)


def test_progress_may_stop_and_what_is_done_stays() -> None:
    reported = []
    full = midair.tolerate(SCENE, "naive", dead=0.1, trials=60)
    part = midair.tolerate(
        SCENE, "naive", dead=0.1, trials=60, progress=lambda *step: reported.append(step) or step[0] < 20
    )
    assert (full.status, part.status) == ("done", "stopped")
    assert part.trials == 20
    assert reported == [(10, 60), (20, 60)]
    np.testing.assert_array_equal(part["dead"].level, full["dead"].level[:20])
    assert "stopped" in repr(part)


@pytest.mark.slow
def test_the_table_is_of_its_trials() -> None:
    table = midair.tolerate(SCENE, "naive", dead=0.1, gain=0.1, trials=40)
    columns = table.to_dict()
    assert columns["fault"] == ["gain", "dead", "together"]
    assert columns["size"] == [0.1, 0.1, None]
    assert columns["level"][1] == table["dead"].level.mean()
    assert columns["level_5"][1] == np.quantile(table["dead"].level, 0.05)
    assert columns["uniformity_worst"][2] == table["together"].uniformity.min()
    assert "0.1 of all" in repr(table)
    assert "<td>together</td>" in table._repr_html_()
    assert len(table.plot().axes) == 2


@pytest.mark.parametrize(
    ("requested", "reported"),
    [
        ({}, "give at least one of phase"),
        ({"phase": -1}, "phase is -1"),
        ({"dead": 2}, "dead is 2"),
        ({"tilt": float("nan")}, "tilt is nan"),
        ({"phase": 1, "trials": 0}, "trials is 0"),
        ({"phase": 1, "trials": 10**9}, "trials is 1000000000: give at most 1000000"),
        ({"phase": 1, "seed": -1}, "seed is -1"),
        ({"temperature": 1000}, "temperature is 1000"),
        ({"position": 0.5}, "position is 0.5: give at most 0.01"),
        ({"phase": 1, "threads": 0}, "threads is 0"),
    ],
)
def test_bad_requests_are_refused(requested: dict[str, float], reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.tolerate(SCENE, "naive", **requested)


@pytest.mark.parametrize("name", ["fase", "dedd"])
def test_a_fault_mistyped_is_reported_by_name(name: str) -> None:
    with pytest.raises(TypeError, match=rf'midair\.tolerate "{name}": .*known are phase, gain'):
        midair.tolerate(SCENE, "naive", **{name: 1})


def test_few_transducers_that_are_all_dead_keep_nothing() -> None:
    one = midair.Scene(midair.Array([[0, 0, 0]]), [[0, 0, 0.1]])
    table = midair.tolerate(one, "naive", dead=0.5, trials=40)
    assert set(np.round(table["dead"].level, 6)) == {0, 1}
    assert 10 < table["dead"].level.sum() < 30
    whole = midair.tolerate(one, "naive", reversed=1, trials=3)["reversed"]
    np.testing.assert_allclose(whole.level, 1)


@pytest.mark.filterwarnings("ignore:the pressures are missed")
def test_a_silent_scene_is_refused() -> None:
    with pytest.raises(midair.SceneError, match="silent"):
        midair.tolerate(SCENE, lambda *_: np.zeros(256), phase=1)
    with pytest.raises(midair.SceneError, match="silent"):
        midair.tolerate(SCENE, drive=np.zeros(256), phase=1)


def test_a_drive_is_played_as_it_is() -> None:
    requested = {"phase": 20, "dead": 0.1, "trials": 20}
    table = midair.tolerate(SCENE, "naive", **requested)
    solution = table.solution
    assert solution is not None
    for drive in (solution, solution.drive, solution.drive.tolist()):
        same = midair.tolerate(SCENE, drive=drive, **requested)
        for name in table.rows:
            np.testing.assert_array_equal(same[name].level, table[name].level)
            np.testing.assert_array_equal(same[name].uniformity, table[name].uniformity)
        assert same.solution == (solution if isinstance(drive, midair.Solution) else None)
        assert "trials a row" in same.plot().get_suptitle()
    # `half` is a drive that a board of two phases cannot play: it is used without rounding.
    rounded = SCENE.replace(array=midair.Array.grid(16, 16, 10e-3, quantization={"phases": 2}), pressures=[1, 2, 3])
    half = 0.5 * solution.drive
    table = midair.tolerate(rounded, drive=half, temperature=5, trials=3, seed=2)
    warm = faulty(rounded, {"temperature": 5.0}, 2, 1)
    whole, got = (midair.judge(one, half) for one in (rounded, warm))
    assert table["temperature"].level[1] == got.level / whole.level
    assert table["temperature"].uniformity[1] == got.uniformity / whole.uniformity


@pytest.mark.parametrize(
    ("requested", "reported"),
    [
        ({"drive": np.ones(3)}, "drive is 3 values: give one for each of the 256"),
        ({"drive": "naive"}, "drive is 'naive': give numbers"),
        ({"drive": np.ones(256), "solver": "naive"}, 'solver is "naive": drive is played as it is'),
        ({"drive": np.ones(256), "phases": 8}, "phases is 8: drive is played as it is"),
    ],
)
def test_a_drive_that_cannot_be_played_is_refused(requested: dict[str, object], reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.tolerate(SCENE, phase=1, **requested)


FILE = """
[array]
grid = { nx = 12, ny = 12, pitch = 0.01 }
[[points]]
position = [-0.02, 0.0, 0.1]
[[points]]
position = [0.015, 0.01, 0.1]
"""


@pytest.mark.slow
def test_the_command_prints_what_python_gives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.toml").write_text(FILE, "utf-8")
    requested = ["--phase", "20", "--dead", "0.05", "--temperature", "5", "--tilt", "1", "--trials", "20"]
    with pytest.raises(SystemExit) as left:
        cli.main(["tolerate", "scene.toml", *requested, "--image", "t.png", "--json"])
    assert left.value.code == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    table = midair.tolerate(midair.Scene.load("scene.toml"), phase=20, dead=0.05, temperature=5, tilt=1, trials=20)
    assert rows == table.to_dict()
    assert Path("t.png").stat().st_size > 1000
    with pytest.raises(SystemExit) as left:
        cli.main(["exposure", "scene.toml", "--at", "0,0.1,0.4", "--box=-0.1,0,0.3,-0.09,0.01,0.31"])
    assert left.value.code == 0
    assert "110 dB" in capsys.readouterr().out
    with pytest.raises(SystemExit) as left:
        cli.main(["exposure", "scene.toml"])
    assert left.value.code == 2


@pytest.mark.slow
def test_ctrl_c_is_noticed_and_keeps_the_trials_that_are_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.toml").write_text(FILE, "utf-8")
    pressed = []

    def press() -> None:
        pressed.append(time.monotonic())
        signal.raise_signal(signal.SIGINT)

    press_soon = threading.Timer(1, press)
    press_soon.start()
    with pytest.raises(SystemExit) as left:
        cli.main(["tolerate", "scene.toml", "--phase", "20", "--json", "--trials", "1000000"])
    # The stop takes half a second, and up to twice that on a busy machine.
    assert time.monotonic() - pressed[0] < 1
    assert left.value.code == 130
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "stopped"
    assert found["trials"] > 0
    assert found["rows"]["level"][0] == pytest.approx(np.exp(-(np.radians(20) ** 2) / 2), abs=0.03)
