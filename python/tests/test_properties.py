"""Properties that hold for every scene, checked for random scenes."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st

import midair
from scenes import usable

# The same examples in every run, so that a failure can be repeated.
steady = settings(max_examples=150, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
numbers = st.floats(-0.06, 0.06, allow_subnormal=False)
heights = st.floats(-0.05, 0.25, allow_subnormal=False)
names = st.sampled_from(sorted(midair.solvers()))


@st.composite
def scenes(draw: st.DrawFn, *, unit: float = 1.0) -> midair.Scene:
    count = draw(st.integers(1, 6))
    sites = draw(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=12))
    points = [[draw(numbers), draw(numbers), draw(heights)] for _ in range(count)]

    def lists(*values: float) -> st.SearchStrategy:
        return st.none() | st.lists(st.sampled_from(values), min_size=count, max_size=count)

    pressures = draw(lists(0.0, 5.0, 80.0, 300.0))
    weights = draw(lists(0.0, 0.5, 2.0))
    directivity = draw(st.sampled_from(["point", "t4010a1", {"piston": 5e-3}]))
    array = midair.Array([[x, y, 0] for x, y in sites], directivity=directivity)
    if pressures is not None:
        pressures = [unit * pressure for pressure in pressures]
    return midair.Scene(array, points, pressures, weights=weights, source_pressure=4.386 * unit)


def attempt(make, *arguments, **keywords):
    """Returns the result, or None if the call is rejected with a message of one line."""
    try:
        return make(*arguments, **keywords)
    except midair.SceneError as error:
        if len(str(error).splitlines()) != 1:
            raise
        return None


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@steady
@given(st.data(), names, st.booleans())
def test_any_scene_is_refused_or_answered_with_finite_numbers(data, solver: str, balance: bool) -> None:
    scene = attempt(lambda: data.draw(scenes()))
    solution = scene and attempt(midair.solve, scene, solver, balance=balance)
    # Hypothesis draws another scene for a rejected one; too many rejections are a failure.
    assume(solution is not None)
    assert usable(solution)
    assert ((solution.phases >= 0) & (solution.phases < 2 * np.pi)).all()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@steady
@given(st.data(), names, st.sampled_from(["scene.toml", "scene.json"]))
def test_a_saved_scene_gives_the_same_bits(data, solver: str, name: str) -> None:
    scene = attempt(lambda: data.draw(scenes()))
    solution = scene and attempt(midair.solve, scene, solver)
    # Hypothesis draws another scene for a rejected one; too many rejections are a failure.
    assume(solution is not None)
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        scene.save(path)
        again = midair.solve(midair.Scene.load(path), solver)
    assert again.drive.tobytes() == solution.drive.tobytes()


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@steady
@given(st.randoms(use_true_random=False), names)
def test_the_unit_of_pressure_changes_no_drive(random, solver: str) -> None:
    points = [[random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0.1] for _ in range(4)]
    pressures = np.array([80.0, *(random.choice([0.0, 20.0, 150.0]) for _ in range(3))])
    array = midair.Array.grid(5, 4, pitch=0.01)
    drives = [
        midair.solve(midair.Scene(array, points, pressures * unit, source_pressure=4.0 * unit), solver).drive
        for unit in (1.0, 1000.0)
    ]
    assert drives[0].tobytes() == drives[1].tobytes()


@pytest.mark.slow
@steady
@given(st.randoms(use_true_random=False))
def test_permuting_the_points_permutes_what_naive_gives_them(random) -> None:
    points = [[random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0.1] for _ in range(5)]
    order = random.sample(range(5), 5)
    array = midair.Array.grid(6, 6, pitch=0.01)
    scenes = [midair.Scene(array, places) for places in (np.array(points), np.array(points)[order])]
    pressures = [midair.solve(scene, "naive").pressures for scene in scenes]
    # The tolerance is for sums of five f32 numbers in different orders.
    assert np.abs(pressures[1] - pressures[0][order]).max() <= 1e-5 * np.abs(pressures[0]).max()
