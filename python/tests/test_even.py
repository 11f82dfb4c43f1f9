"""The option `aim` of the solvers `uniform` and `best`, as a keyword and in a scene file."""

import json

import numpy as np
import pytest

import midair

POINTS = [[-0.03, 0.01, 0.15], [0.02, 0.03, 0.15], [0.01, -0.04, 0.15]]
ARRAY = midair.Array.preset("paper20")
SOLVERS = ("uniform", "best")


def ratios(solution: midair.Solution) -> np.ndarray:
    return np.abs(solution.pressures) / solution.targets


@pytest.mark.parametrize("solver", SOLVERS)
def test_pressures_mean_as_loud_as_requested_and_none_mean_as_loud_as_can_be(solver: str) -> None:
    weak = midair.Scene(ARRAY, POINTS, [0.05, 0.1, 0.07])
    requested, loud = midair.solve(weak, solver), midair.solve(weak, solver, aim="max")
    assert requested.options["aim"] == "target"
    assert ratios(requested) == pytest.approx(np.ones(3), abs=1e-4)
    # The two drives differ only by a factor, and so do their fields.
    assert loud.metrics.sigma < 1e-5
    assert np.abs(loud.drive) == pytest.approx(np.ones(400), abs=1e-5)
    assert requested.drive * loud.metrics.level == pytest.approx(loud.drive, abs=1e-4)
    left_out = midair.solve(midair.Scene(ARRAY, POINTS), solver)
    assert left_out.options["aim"] == "max"
    assert np.abs(left_out.drive).max() == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("solver", SOLVERS)
def test_balancing_changes_nothing(solver: str) -> None:
    scene = midair.Scene(ARRAY, POINTS, 1)
    drives = [midair.solve(scene, solver, balance=balance).drive for balance in (None, False, True)]
    assert all(np.array_equal(drive, drives[0]) for drive in drives)


def test_an_aim_is_one_of_two_words_or_left_out() -> None:
    scene = midair.Scene(ARRAY, POINTS)
    assert midair.solve(scene, "uniform", aim=None).options["aim"] == "max"
    for bad in ("loud", 1, "Maxi"):
        with pytest.raises(midair.SceneError, match=r"^aim .*\"target\" or \"max\""):
            midair.solve(scene, "uniform", aim=bad)


def test_an_aim_in_the_scene_file_is_used_saved_and_won_over(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    midair.Scene(ARRAY, POINTS, 0.5).save(path)
    path.write_text(path.read_text("utf-8") + '\n[solver]\nname = "uniform"\naim = "max"\n', encoding="utf-8")
    scene = midair.Scene.load(path)
    assert scene.solver == ("uniform", {"aim": "max"})
    assert midair.solve(scene).metrics.level > 1.1
    assert midair.solve(scene, aim="target").metrics.level == pytest.approx(1, abs=1e-4)
    again = tmp_path / "again.json"
    scene.save(again)
    assert json.loads(again.read_text("utf-8"))["solver"] == {"name": "uniform", "aim": "max"}
    # Another solver ignores the file's options, `aim` among them.
    assert midair.solve(scene, "wgs").status == "done"


@pytest.mark.parametrize(
    ("table", "item"),
    [('name = "naive"\naim = "max"', "aim"), ('name = "uniform"\naim = "most"', "solver.aim")],
)
def test_an_aim_that_makes_no_sense_in_a_file_is_refused(tmp_path, table: str, item: str) -> None:
    path = tmp_path / "scene.toml"
    midair.Scene(ARRAY, POINTS).save(path)
    path.write_text(path.read_text("utf-8") + f"\n[solver]\n{table}\n", encoding="utf-8")
    with pytest.raises(midair.SceneError, match=item):
        midair.Scene.load(path)


def test_a_field_of_many_points_is_even_and_exact_in_double_precision() -> None:
    rng = np.random.default_rng(3)
    points = np.c_[rng.uniform(-0.1, 0.1, (128, 2)), np.full(128, 0.15)]
    scene = midair.Scene(ARRAY, points, 2.36066 / np.sqrt(128))
    metrics = midair.judge(scene, midair.solve(scene, "uniform").drive, precision="double")
    # The f32 phases of the propagation matrix have errors of up to 1e-4.
    assert metrics.residual < 1e-6
    assert metrics.level == pytest.approx(1, abs=1e-4)
