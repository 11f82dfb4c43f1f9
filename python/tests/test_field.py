"""Fields on planes and at points."""

from pathlib import Path

import numpy as np
import pytest

import midair
import oracle
from scenes import GAIN, POINTS, numbers, same_bits, small


def reference(scene: midair.Scene, drive: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Returns the field of point sources with normals +z at points (P, 3), in double precision."""
    model = {"source_pressure": scene.array.source_pressure, "absorption": scene.absorption}
    return oracle.propagation(scene.array.positions, points, **model) @ drive


def test_field_is_indexed_y_x_and_its_plane_includes_both_ends() -> None:
    scene = small(points=[[0.02, -0.01, 0.1]], absorption=0.15)
    drive = midair.solve(scene, "naive").drive
    field = midair.field(scene, drive, midair.Plane(0.1, 0.06, pixels=13, center=(0.02, 0.01)))
    assert field.x == pytest.approx(np.linspace(-0.01, 0.05, 13), abs=1e-15)
    assert field.y == pytest.approx(np.linspace(-0.02, 0.04, 13), abs=1e-15)
    assert (field.pressure.shape, field.pressure.dtype) == ((13, 13), np.complex64)
    # The focus is at x[6], y[2].
    assert np.unravel_index(np.abs(field.pressure).argmax(), (13, 13)) == (2, 6)
    for iy, ix in [(0, 0), (2, 6), (12, 0), (3, 11), (12, 12)]:
        expected = reference(scene, drive, np.array([[field.x[ix], field.y[iy], 0.1]]))[0]
        # Each of the 64 terms is rounded on its own; the error is relative to the focus.
        assert abs(field.pressure[iy, ix] - expected) < 1e-4 * np.abs(field.pressure).max()
    assert field.points is None
    assert field.radiation == pytest.approx(np.abs(field.pressure.astype(complex)) ** 2 / (1.223 * 340**2), rel=1e-12)


def test_field_takes_points_anywhere() -> None:
    scene, rng = small(), np.random.default_rng(1)
    # More points than one thread computes, so the parts must be put together in order.
    points = rng.uniform(-0.2, 0.2, (1500, 3))
    drive = rng.uniform(0, 1, 64) * np.exp(1j * rng.uniform(0, 6, 64))
    field = midair.field(scene, drive, points)
    assert field.pressure.shape == field.radiation.shape == (1500,)
    far = np.linalg.norm(points[:, None] - scene.array.positions, axis=2).min(axis=1) > 1e-3
    expected = reference(scene, drive, points)
    bound = GAIN * np.abs(oracle.propagation(scene.array.positions, points)).sum(axis=1)
    assert (np.abs(field.pressure - expected)[far] <= bound[far]).all()
    assert far.sum() > 1400
    assert (field.x, field.y, field.plane) == (None, None, None)
    assert np.array_equal(field.points, points)


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_field_at_the_points_is_what_the_solution_says() -> None:
    scene = small(pressures=[1e3, 500, 0, 2e3])
    solution = midair.solve(scene, "greedy")
    found = midair.field(scene, solution.drive, scene.points).pressure
    assert found == pytest.approx(solution.pressures, rel=1e-5)


def test_field_is_finite_on_a_transducer_itself() -> None:
    scene = midair.Scene(midair.Array([[0, 0, 0]]), [[0, 0, 0.1]])
    field = midair.field(scene, [1], [[0, 0, 0], [1e-6, 0, 0], [0, 8e-5, 0]])
    # A distance from a transducer below a hundredth of a wavelength counts as a hundredth.
    assert np.abs(field.pressure) == pytest.approx(np.full(3, 4.386 / 8.5e-5), rel=1e-5)
    with pytest.warns(midair.SceneWarning, match="no point"):
        picture = midair.field(scene, [1], midair.Plane(0, 0.01, pixels=21))
    assert np.isfinite(picture.pressure).all()
    assert np.unravel_index(np.abs(picture.pressure).argmax(), (21, 21)) == (10, 10)


def test_planes_left_out_go_through_the_points() -> None:
    on_the_axis = small(points=[[0, 0, 0.1], [0, 0, 0.14]])
    plane = midair.field(on_the_axis, np.ones(64)).plane
    assert (plane.axis, plane.at, plane.z, plane.pixels) == ("y", 0, None, 200)
    assert (plane.size, *plane.center) == pytest.approx((0.04 + 4 * 8.5e-3, 0, 0.12))
    # Points at two heights have one panel per height, of the same size; the panel with more points is first.
    field = midair.field(small(points=[[0, 0.01, 0.1], [0.03, 0, 0.15], [0, 0, 0.15]]), np.ones(64))
    assert [panel.plane.z for panel in field.panels] == [0.15, 0.1]
    assert [panel.shown.tolist() for panel in field.panels] == [[False, True, True], [True, False, False]]
    assert len({(panel.plane.size, panel.plane.center) for panel in field.panels}) == 1
    for panel in field.panels:
        alone = midair.field(field.scene, np.ones(64), panel.plane)
        assert same_bits(panel.pressure, alone.pressure)
        assert len(panel.panels) == len(alone.panels) == 1
    assert same_bits(field.pressure, field.panels[0].pressure)


@pytest.mark.parametrize(("axis", "across", "up"), [("x", 1, 2), ("y", 0, 2), ("z", 0, 1)])
def test_an_upright_plane_is_indexed_up_across(axis: str, across: int, up: int) -> None:
    scene, drive = small(), np.ones(64)
    plane = midair.Plane(axis=axis, at=0.12, size=0.04, pixels=9, center=(0.01, 0.1))
    with pytest.warns(midair.SceneWarning, match="no point lies in Plane"):
        field = midair.field(scene, drive, plane)
    samples = [plane.along("xyz"[across]), plane.along("xyz"[up])]
    assert samples[0] == pytest.approx(np.linspace(-0.01, 0.03, 9), abs=1e-15)
    assert samples[1] == pytest.approx(np.linspace(0.08, 0.12, 9), abs=1e-15)
    for k, name in enumerate("xyz"):
        of_field, of_plane = getattr(field, name), plane.along(name)
        assert (of_field is None) == (of_plane is None) == (k not in (across, up))
        assert of_plane is None or np.array_equal(of_field, of_plane)
    point = np.full(3, 0.12)
    point[[across, up]] = samples[0][2], samples[1][7]
    expected = reference(scene, drive, point[None])[0]
    assert abs(field.pressure[7, 2] - expected) < 1e-4 * np.abs(field.pressure).max()
    assert midair.Plane(0.12, 0.04) == midair.Plane(axis="z", at=0.12, size=0.04)
    assert eval(repr(plane), {"Plane": midair.Plane}) == plane


def test_a_plane_requested_without_a_point_in_it_is_warned_of(tmp_path: Path) -> None:
    scene = small(points=[[0.01, 0, 0.15]])
    planes = [midair.Plane(0.152, 0.1), midair.Plane(0.15, 0.01), midair.Plane(axis="y", size=0.1)]
    for plane in planes:
        with pytest.warns(midair.SceneWarning, match=r"no point lies in .*, Plane\(z=0.15, size=0.034, "):
            field = midair.field(scene, np.ones(64), plane)
        assert not field.shown.any()
    path = tmp_path / "scene.toml"
    scene.save(path)
    path.write_text(path.read_text("utf-8") + "\n[plane]\nz = 0.2\n", encoding="utf-8")
    with pytest.warns(midair.SceneWarning, match="no point lies"):
        midair.field(midair.Scene.load(path), np.ones(64))
    # No warning is expected here; pytest turns warnings into errors.
    for plane in (midair.Plane(0.1505, 0.1), midair.Plane(axis="y", size=0.1, center=(0, 0.15)), [[0, 0, 1]]):
        midair.field(scene, np.ones(64), plane)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_a_solutions_scale_counts_in_field_and_judge() -> None:
    board = {"phases": 32, "amplitudes": [0, 1]}
    scene = small(array=midair.Array.grid(8, 8, 0.01, quantization=board), pressures=16)
    solution = midair.solve(scene, "greedy", balance=True)
    assert solution.scale < 0.1
    at_points = midair.field(scene, solution, scene.points)
    assert at_points.pressure == pytest.approx(solution.pressures, rel=1e-4)
    assert np.mean(np.abs(at_points.pressure)) / 16 == pytest.approx(solution.metrics.level, rel=1e-4)
    assert numbers(midair.judge(scene, solution)) == pytest.approx(numbers(solution.metrics), rel=1e-4)
    assert (at_points.scale, at_points.solution) == (solution.scale, solution)
    # The solution's scale applies to every pixel of a picture.
    loud, real = (np.abs(midair.field(scene, drive).pressure) for drive in (solution.drive, solution))
    assert real == pytest.approx(loud * solution.scale, rel=1e-4)
    # `judge` of a matrix applies the scale, too; a bare drive has no scale.
    matrix = midair.Propagation(scene.propagation())
    assert midair.judge(matrix, solution, pressures=16).level == pytest.approx(solution.metrics.level, rel=1e-4)
    assert midair.judge(scene, solution.drive).level == pytest.approx(solution.metrics.level / solution.scale, rel=1e-4)
    bare = midair.field(scene, solution.drive)
    assert (bare.scale, bare.solution) == (1, None)


def test_a_solution_of_other_transducers_is_refused_in_one_line() -> None:
    solution = midair.solve(midair.Scene(midair.Array.grid(3, 3, 0.01), [[0, 0, 0.1]]), "naive")
    for judged in (midair.field, midair.judge):
        with pytest.raises(midair.SceneError, match=r"^drive is 9 values: give one for each of the 64 transducers$"):
            judged(small(), solution)


def test_plane_of_the_scene_file_is_the_one_left_out(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    small().save(path)
    path.write_text(
        path.read_text("utf-8") + "\n[plane]\nz = 0.15\nsize = 0.1\npixels = 7\ncenter = [0.01, 0.0]\n",
        encoding="utf-8",
    )
    scene = midair.Scene.load(path)
    assert midair.field(scene, np.ones(64)).plane == midair.Plane(0.15, 0.1, 7, (0.01, 0))
    assert midair.field(scene, np.ones(64), midair.Plane(0.15, 0.1, 3)).plane == midair.Plane(0.15, 0.1, 3)


def test_field_takes_a_reduced_and_a_silent_drive() -> None:
    scene = small()
    full = midair.field(scene, np.full(64, 1 + 5e-7), POINTS).pressure
    half = midair.field(scene, [0.5] * 64, POINTS).pressure
    assert half == pytest.approx(full / 2, rel=1e-5)
    silent = midair.field(scene, np.zeros(64), POINTS).pressure
    assert same_bits(silent, np.zeros(4, dtype=np.complex64))
