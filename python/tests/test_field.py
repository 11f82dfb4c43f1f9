"""Fields on planes and at points, and their pictures."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes

import midair
import oracle
from scenes import GAIN, POINTS, same_bits, small


@pytest.fixture(autouse=True)
def figures_are_closed():
    plt.switch_backend("agg")
    yield
    plt.close("all")


def reference(scene: midair.Scene, drive: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The field at points in double precision, of point sources looking along +z."""
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
        # Of 64 terms rounded on their own, relative to the focus.
        assert abs(field.pressure[iy, ix] - expected) < 1e-4 * np.abs(field.pressure).max()
    assert field.points is None
    assert field.radiation == pytest.approx(
        np.abs(field.pressure.astype(complex)) ** 2 / (1.18 * 340**2), rel=1e-12
    )


def test_field_takes_points_anywhere() -> None:
    scene, rng = small(), np.random.default_rng(1)
    # More than a thread's share, so that shares have to be put together in order.
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
    # Within a hundredth of a wavelength r is held there.
    assert np.abs(field.pressure) == pytest.approx(np.full(3, 4.386 / 8.5e-5), rel=1e-5)
    picture = midair.field(scene, [1], midair.Plane(0, 0.01, pixels=21))
    assert np.isfinite(picture.pressure).all()
    assert np.unravel_index(np.abs(picture.pressure).argmax(), (21, 21)) == (10, 10)


def test_plane_left_out_is_around_the_points() -> None:
    # At unlike heights: their mean; 1.25 times the larger side, that along x.
    points = [[0, 0, 0.1], [0.1, 0, 0.2], [0.05, 0, 0.18]]
    plane = midair.field(small(points=points), np.ones(64)).plane
    assert (plane.z, plane.size, *plane.center) == pytest.approx((0.16, 0.125, 0.05, 0), abs=1e-12)
    assert plane.pixels == 200


def test_plane_of_the_scene_file_is_the_one_left_out(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    small().save(path)
    path.write_text(path.read_text() + "\n[plane]\nz = 0.12\nsize = 0.05\npixels = 7\ncenter = [0.01, 0.0]\n")
    scene = midair.Scene.load(path)
    assert midair.field(scene, np.ones(64)).plane == midair.Plane(0.12, 0.05, 7, (0.01, 0))
    assert midair.field(scene, np.ones(64), midair.Plane(0.2, 0.1, 3)).plane == midair.Plane(0.2, 0.1, 3)


def test_field_takes_a_reduced_and_a_silent_drive() -> None:
    scene = small()
    full = midair.field(scene, np.full(64, 1 + 5e-7), POINTS).pressure
    half = midair.field(scene, [0.5] * 64, POINTS).pressure
    assert half == pytest.approx(full / 2, rel=1e-5)
    silent = midair.field(scene, np.zeros(64), POINTS).pressure
    assert same_bits(silent, np.zeros(4, dtype=np.complex64))


def marks(ax: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the full and of the hollow marks, in mm."""
    full, hollow = np.zeros((0, 2)), np.zeros((0, 2))
    for mark in ax.collections:
        offsets = np.asarray(mark.get_offsets())
        if len(mark.get_facecolor()) == 0:
            hollow = np.concatenate([hollow, offsets])
        else:
            full = np.concatenate([full, offsets])
    return full, hollow


def test_plot_draws_into_the_axes_given_and_marks_the_points() -> None:
    scene = small(points=[[0.01, 0.02, 0.15], [-0.01, 0.005, 0.15], [0.015, -0.01, 0.17]])
    field = midair.field(scene, np.ones(64), midair.Plane(0.15, 0.08, pixels=41))
    _, (left, right) = plt.subplots(1, 2)
    assert midair.plot(field, right) is right
    assert not left.images
    (image,) = right.images
    # The image is the field: bottom row first, pixels around their samples, a scale from 0 to its largest.
    scale = 1e-6 if image.get_array().max() < 1e5 else 1
    assert np.asarray(image.get_array()) == pytest.approx(np.abs(field.pressure) ** 2 * scale, rel=1e-5)
    assert image.origin == "lower"
    assert image.get_extent() == pytest.approx([-41, 41, -41, 41])
    assert image.get_clim() == pytest.approx((0, image.get_array().max()))
    full, hollow = marks(right)
    assert full == pytest.approx(np.array([[10, 20], [-10, 5]]))
    assert hollow == pytest.approx(np.array([[15, -10]]))
    assert (right.get_xlabel(), right.get_ylabel()) == ("x / mm", "y / mm")


def test_plot_without_axes_draws_into_the_present_ones() -> None:
    ax = plt.gca()
    assert midair.plot(midair.field(small(), np.ones(64))) is ax
    assert len(ax.images) == 1


@pytest.mark.parametrize(
    ("source_pressure", "quantity", "unit"),
    [
        (4.386, "pressure", "kPa²"),
        (0.04, "pressure", "Pa²"),
        (1e-3, "pressure", "eq. (5) in mm"),
        (4.386, "radiation", "radiation pressure / Pa"),
        (0.1, "radiation", "radiation pressure / mPa"),
    ],
)
def test_plot_says_what_its_colours_mean(source_pressure: float, quantity: str, unit: str) -> None:
    scene = small(points=[[0, 0, 0.15]], source_pressure=source_pressure)
    field = midair.field(scene, midair.solve(scene, "naive").drive, midair.Plane(0.15, 0.02, pixels=5))
    ax = midair.plot(field, quantity=quantity)
    label = ax.figure.axes[-1].get_ylabel()
    assert label.endswith(unit)
    assert label.endswith(" " + unit) or unit.startswith("radiation")
    top = float((field.radiation if quantity == "radiation" else np.abs(field.pressure) ** 2).max())
    factors = {"kPa²": 1e-6, "radiation pressure / mPa": 1e3}
    assert ax.images[0].get_clim()[1] == pytest.approx(top * factors.get(unit, 1), rel=1e-5)
    # A colour bar that reads 0 to 0.0 or 0 to 1e7 says nothing.
    assert 0.1 <= ax.images[0].get_clim()[1] < 1e5


def test_plot_of_silence_and_of_a_given_top_have_a_scale() -> None:
    field = midair.field(small(), np.zeros(64), midair.Plane(0.15, 0.02, pixels=5))
    low, high = midair.plot(field).images[0].get_clim()
    assert low < high
    _, ax = plt.subplots()
    assert midair.plot(field, ax, vmax=300.0).images[0].get_clim() == (0, 300)


def test_plot_refuses_what_is_no_picture() -> None:
    at_points = midair.field(small(), np.ones(64), POINTS)
    with pytest.raises(midair.SceneError, match="Plane"):
        midair.plot(at_points)
    field = midair.field(small(), np.ones(64), midair.Plane(0.15, 0.02, pixels=5))
    with pytest.raises(midair.SceneError, match=r'"presure".*"pressure" or "radiation"'):
        midair.plot(field, quantity="presure")
    with pytest.raises(TypeError, match="Field"):
        midair.plot(field.pressure)
