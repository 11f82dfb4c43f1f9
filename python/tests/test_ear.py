"""`quiet=` and `midair.ear`: quiet points within a tolerance, and boxes of quiet points."""

from __future__ import annotations

import numpy as np
import pytest

import midair


@pytest.fixture(scope="module")
def array() -> midair.Array:
    return midair.Array.grid(20, 20, 10e-3)


def disc(radius: float, step: float, z: float = 0.15) -> np.ndarray:
    along = np.arange(-radius, radius + step / 2, step)
    x, y = np.meshgrid(along, along)
    inside = x**2 + y**2 <= radius**2 + 1e-12
    return np.c_[x[inside], y[inside], np.full(inside.sum(), z)]


def test_a_quiet_disc_is_silent_between_its_points_and_costs_little(array):
    loud, quiet = np.array([[-0.04, 0, 0.15], [0.04, 0.01, 0.15], [0, 0.04, 0.15]]), disc(0.012, 2e-3)
    points = np.r_[loud, quiet]
    pressures = np.r_[np.ones(3), np.zeros(len(quiet))] * 100
    solution = midair.solve(midair.Scene(array, points, pressures=pressures), aim="max")
    made = abs(solution.pressures[:3])
    between = midair.field(midair.Scene(array, points), solution, disc(0.011, 0.7e-3))
    alone = midair.solve(midair.Scene(array, loud), aim="max")
    assert solution.status == "done"
    assert made.min() / made.max() > 0.999
    assert abs(solution.pressures[3:]).max() < 2e-3 * made.max()
    assert abs(between.pressure).max() < 4e-3 * made.max()
    assert made.min() > 0.8 * abs(alone.pressures).min()


def test_the_tolerance_is_heeded_and_so_are_weights(array):
    points = [[-0.03, 0, 0.15], [0.03, 0, 0.15], [-0.027, 0, 0.15]]
    scene = midair.Scene(array, points, pressures=[500, 500, 0])
    leaks = []
    for quiet in (1e-3, 0.05, 0.3):
        solution = midair.solve(scene, quiet=quiet, aim="max")
        made = abs(solution.pressures)
        leaks.append(made[2] / made[:2].max())
        assert leaks[-1] <= 1.11 * quiet
    assert leaks == sorted(leaks)
    eased = midair.solve(scene.replace(weights=[1, 1, 0.01]), quiet=1e-3, aim="max")
    made = abs(eased.pressures)
    assert 1e-3 < made[2] / made[:2].max() <= 0.111
    with pytest.raises(midair.SceneError, match="quiet is -1"):
        midair.solve(scene, quiet=-1)


def test_more_quiet_points_than_can_be_silenced_are_reported():
    few = midair.Array.grid(6, 6, 10e-3)
    quiet = np.stack(np.meshgrid(*[np.linspace(-0.04, 0.04, 9)] * 2), axis=-1).reshape(-1, 2)
    points = np.r_[[[0.0, 0.0, 0.1]], np.c_[quiet + 0.005, np.full(len(quiet), 0.1)]]
    with (
        pytest.warns(midair.SceneWarning, match="pressures are missed"),
        pytest.warns(midair.SceneWarning, match=r"quiet points leak .* silences about 13"),
    ):
        midair.solve(midair.Scene(few, points, pressures=np.r_[200.0, np.zeros(len(quiet))]))


def test_an_ear_is_a_box_that_falls_silent(array):
    scene = midair.Scene(array, [[0, 0, 0.15], [0.02, 0, 0.15]], pressures=800)
    ear = midair.ear([0.0, 0.08, 0.15], size=0.008)
    assert ear.points.shape == (125, 3)
    np.testing.assert_allclose(ear.points.mean(axis=0), [0, 0.08, 0.15])
    quieter = ear.quieten(scene)
    assert len(quieter.points) == 127
    before, after = (midair.solve(one) for one in (scene, quieter))
    assert ear.spl(scene, after) < ear.spl(scene, before) - 20
    np.testing.assert_allclose(abs(after.pressures[:2]), 800, rtol=1e-3)
    # 1 Pa (rms) is 94 dB.
    pressure = float(abs(midair.field(scene, before, ear.points).pressure).max())
    assert ear.spl(scene, before) == pytest.approx(94 + 20 * np.log10(pressure / np.sqrt(2)), abs=0.03)
    balanced = ear.quieten(scene.replace(pressures=None))
    np.testing.assert_allclose(balanced.pressures[:2], scene.replace(pressures=None).reach().level)


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ({"position": [0, 0]}, "position"),
        ({"position": [0, 0, 0.1], "size": 0}, "size is 0"),
        ({"position": [0, 0, 0.1], "step": 1e-5}, "points, give at least"),
        ({"position": [0, 0, float("nan")]}, "position"),
    ],
)
def test_bad_boxes_are_refused(given, reported):
    with pytest.raises(midair.SceneError, match=reported):
        midair.ear(**given)


def test_what_is_no_scene_is_refused():
    with pytest.raises(TypeError, match=r"expected a midair\.Scene first, not int"):
        midair.ear([0, 0, 0.1]).quieten(3)
