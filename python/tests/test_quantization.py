"""Quantization and masks: drives that the device can play, in files too, and error messages."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair import _cli as cli

POINTS = [[-0.03, 0.01, 0.15], [0.03, 0, 0.15], [0, -0.03, 0.15]]


def board(**keywords: Any) -> midair.Array:
    return midair.Array.grid(12, 12, 10e-3, **keywords)


def steps(phases: np.ndarray, count: int) -> np.ndarray:
    """Returns the distance of phases to the nearest of `count` phases, in steps."""
    turns = phases / (2 * np.pi) * count
    return np.abs(turns - np.round(turns))


@pytest.mark.parametrize(
    "amplitudes",
    [[0, 0.5, 1], np.array([0, 0.5, 1], dtype=np.float32), np.array([0, 9, 0.5, 9, 1])[::2]],
    ids=["list", "float32", "strided"],
)
def test_answers_lie_on_the_grid(amplitudes: Any) -> None:
    array = board(quantization={"phases": np.uint16(24), "amplitudes": amplitudes})
    solution = midair.solve(midair.Scene(array, POINTS), "wgs")
    # The only difference from the 24 phases is the rounding to f32.
    assert steps(solution.phases, 24).max() < 1e-5
    assert np.abs(solution.amplitudes[:, None] - [0, 0.5, 1]).min(axis=1).max() < 1e-6
    assert solution.scale == 1


def test_pressures_and_metrics_are_those_of_the_rounded_drive() -> None:
    scene = midair.Scene(board(quantization={"phases": 4}), POINTS)
    solution = midair.solve(scene, "wgs")
    field = scene.propagation() @ solution.drive
    # The tolerance is for complex64 sums over 144 transducers.
    assert np.abs(field - solution.pressures).max() < 1e-4 * np.abs(field).max()
    judged = midair.judge(scene, solution.drive)
    assert judged.sigma == pytest.approx(solution.metrics.sigma, abs=1e-4)


def test_greedy_takes_the_grid_of_the_device() -> None:
    scene = midair.Scene(board(quantization={"phases": 24, "amplitudes": [0, 0.5, 1]}), POINTS)
    options = midair.solve(scene, "greedy").options
    assert (options["phases"], options["amplitudes"]) == (24, 2)
    assert midair.solve(scene, "greedy", phases=8, amplitudes=1).options["phases"] == 8
    with pytest.raises(midair.SceneError, match=r"phases is 16: the device has 24 phases"):
        midair.solve(scene, "greedy", phases=16)
    autd3 = midair.Scene(midair.Array.preset("autd3"), POINTS)
    options = midair.solve(autd3, "greedy").options
    assert (options["phases"], options["amplitudes"]) == (256, 16)


def test_presets_carry_the_quantization_of_their_boards() -> None:
    quantization = midair.Array.preset("autd3").quantization
    assert quantization is not None
    assert quantization["phases"] == 256
    np.testing.assert_allclose(quantization["amplitudes"], np.arange(256) / 255, atol=1e-15)
    assert midair.Array.preset("paper20").quantization is None
    assert midair.Array.preset("autd3", quantization={}).quantization is None
    assert midair.Array.preset("autd3", quantization={"phases": 32}).quantization == {
        "phases": 32,
        "amplitudes": None,
    }


def test_what_the_device_cannot_reduce_is_left_to_the_supply_and_reported() -> None:
    scene = midair.Scene(board(quantization={"phases": 256, "amplitudes": [0, 1]}), POINTS, 100.0)
    with pytest.warns(midair.SceneWarning, match=r"scale all drives by 0\.\d+ by supply or modulation"):
        solution = midair.solve(scene, "wgs")
    assert 0 < solution.scale < 1
    assert solution.amplitudes.min() > 0.999
    assert solution.metrics.level == pytest.approx(1, abs=0.1)
    assert f"scaled by {solution.scale:.4}"[:14] in repr(solution)
    field = solution.scale * (scene.propagation() @ solution.drive)
    assert np.abs(field - solution.pressures).max() < 1e-4 * np.abs(field).max()


def test_masked_transducers_are_off() -> None:
    mask = np.ones(144, dtype=bool)
    mask[[0, 5, 143]] = False
    array = board(mask=mask)
    assert (array.mask == mask).all()
    assert board().mask.all()
    scene = midair.Scene(array, POINTS)
    assert (scene.propagation()[:, ~mask] == 0).all()
    solution = midair.solve(scene, "gs")
    assert ((solution.drive == 0) == ~mask).all()


@pytest.mark.parametrize("ending", ["toml", "json"])
def test_files_hold_quantization_and_masks(tmp_path: Path, ending: str) -> None:
    mask = [i % 3 != 0 for i in range(144)]
    for array in (
        board(quantization={"phases": 10, "amplitudes": [0, 0.1, 1]}, mask=mask),
        board(quantization={"amplitudes": [1]}),
        midair.Array.preset("autd3"),
        midair.Array.preset("autd3", quantization={}),
    ):
        path = tmp_path / f"scene.{ending}"
        scene = midair.Scene(array, POINTS)
        scene.save(path)
        again = midair.Scene.load(path)
        assert again.json() == scene.json()
        assert (again.array.mask == array.mask).all()
        one, other = again.array.quantization, array.quantization
        assert (one is None) == (other is None)
        if one is not None and other is not None:
            assert one["phases"] == other["phases"]
            np.testing.assert_array_equal(one["amplitudes"], other["amplitudes"])
        assert (midair.solve(again, "gs").drive == midair.solve(scene, "gs").drive).all()


def test_a_preset_says_nothing_of_its_own_quantization() -> None:
    scene = midair.Scene(midair.Array.preset("autd3"), POINTS)
    assert "quantization" not in scene.json()
    assert "mask" not in scene.json()


@pytest.mark.parametrize(
    ("keywords", "said"),
    [
        ({"quantization": {"phases": 1}}, "array.quantization.phases is 1"),
        ({"quantization": {"phases": 2**40}}, "array.quantization.phases is "),
        ({"quantization": {"phases": 2.5}}, "array.quantization.phases is 2.5"),
        ({"quantization": {"phases": True}}, "array.quantization.phases is True"),
        ({"quantization": {"amplitudes": [1, 0.5, 1]}}, "array.quantization.amplitudes[1] is 0.5"),
        ({"quantization": {"amplitudes": ["0", "1"]}}, "array.quantization.amplitudes is "),
        ({"quantization": {"phase": 16}}, "unknown key of quantization"),
        ({"quantization": 256}, "quantization is 256: give a dictionary"),
        ({"mask": [True] * 3}, "array.mask is 3 values: give one for each of the 144 transducers"),
        ({"mask": [1] * 144}, "mask is "),
        ({"mask": True}, "mask is of shape ()"),
        ({"mask": np.ones((12, 12), bool)}, "mask is of shape (12, 12)"),
    ],
)
def test_what_no_device_has_is_refused_in_one_line(keywords: dict[str, Any], said: str) -> None:
    with pytest.raises(midair.SceneError) as error:
        board(**keywords)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_the_command_line_tells_of_the_scale_and_records_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = midair.Scene(board(quantization={"phases": 256, "amplitudes": [0, 1]}), POINTS, 100.0)
    scene.save(tmp_path / "scene.toml")
    drive = tmp_path / "drive.npz"
    with pytest.raises(SystemExit) as left:
        cli.main(["solve", str(tmp_path / "scene.toml"), "--solver", "wgs", "-o", str(drive)])
    out, err = capsys.readouterr()
    assert left.value.code == 0
    assert err.startswith("warning: the device has no such amplitude: scale all drives by 0.")
    assert err.count("\n") == 1
    assert "done, scale 0." in out
    with np.load(drive, allow_pickle=False) as record:
        assert 0 < float(record["scale"]) < 1
