"""`midair.streaming`: the force against plain NumPy, its direction against the exact gradient,
and a map against single points.
"""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(12, 12, 10e-3)
SCENE = midair.Scene(ARRAY, [[0.02, 0, 0.12], [-0.02, 0.01, 0.12]], sound_speed=345, density=1.2)


def oracle(drive: np.ndarray, points: np.ndarray, alpha: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Returns pressures (P,) and their gradients (P, 3): sums of spherical waves in float64."""
    k = 2 * np.pi * 40e3 / 345
    apart = points[:, None] - ARRAY.positions
    r = np.linalg.norm(apart, axis=2)
    waves = 4.386 / r * np.exp((1j * k - alpha) * r) * drive
    slopes = ((1j * k - alpha - 1 / r) * waves / r)[..., None] * apart
    return waves.sum(axis=1), slopes.sum(axis=1)


def test_force_and_direction_are_those_of_numpy() -> None:
    solution = midair.solve(SCENE)
    points = np.random.default_rng(0).uniform([-0.05, -0.05, 0.06], [0.05, 0.05, 0.2], (300, 3))
    found = midair.streaming(SCENE, solution, points)
    pressure, slope = oracle(solution.drive, points)
    assert found.absorption == 0.15
    np.testing.assert_allclose(found.force, 0.15 * np.abs(pressure) ** 2 / (1.2 * 345**2), rtol=1e-3)
    flow = (pressure.conj()[:, None] * slope).imag
    length = np.linalg.norm(flow, axis=1)
    strong = length > 0.05 * np.median(length)
    cosine = (found.direction * flow / length[:, None]).sum(axis=1)
    assert cosine[strong].min() > 0.999
    np.testing.assert_allclose(np.linalg.norm(found.direction, axis=1), 1)


def test_the_published_size_of_the_force() -> None:
    # A pressure of 5 kPa and an absorption of 0.15 Np/m give 26.5 N/m^3.
    scene = midair.Scene(midair.Array([[0, 0, 0]], source_pressure=50), [[0, 0, 0.1]])
    found = midair.streaming(scene, [1], [[0, 0, 0.01]])
    assert found.force[0] == pytest.approx(0.15 * 5000**2 / (1.223 * 340**2), rel=1e-4)
    assert found.force[0] == pytest.approx(26.5, abs=0.1)
    np.testing.assert_allclose(found.direction[0], [0, 0, 1], atol=1e-3)


def test_absorption_is_the_scenes_or_given_or_that_of_air_at_40_khz() -> None:
    drive, points = np.ones(144), [[0, 0, 0.1]]
    own = midair.streaming(SCENE.replace(absorption=0.2), drive, points)
    pressure, _ = oracle(drive, np.array(points), 0.2)
    assert own.absorption == 0.2
    assert own.force[0] == pytest.approx(0.2 * abs(pressure[0]) ** 2 / (1.2 * 345**2), rel=1e-3)
    given = midair.streaming(SCENE, drive, points, absorption=0.3)
    assert given.force[0] == pytest.approx(2 * midair.streaming(SCENE, drive, points).force[0])
    with pytest.raises(midair.SceneError, match="absorption is left out at 25 kHz"):
        midair.streaming(SCENE.replace(frequency=25e3), drive, points)
    for wrong in (0, -1, float("nan")):
        with pytest.raises(midair.SceneError, match="absorption is"):
            midair.streaming(SCENE, drive, points, absorption=wrong)


@pytest.mark.filterwarnings("ignore:no point lies in")
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_map_is_the_same_as_its_points(axis: str) -> None:
    at = 0.12 if axis == "z" else 0.0
    center = (0, 0) if axis == "z" else (0, 0.1)
    plane = midair.Plane(size=0.06, pixels=7, center=center, axis=axis, at=at)
    drive = midair.solve(SCENE).drive
    found = midair.streaming(SCENE, drive, plane)
    assert found.force.shape == (7, 7)
    assert found.direction.shape == (7, 7, 3)
    for row, column in ((0, 0), (2, 5), (6, 3)):
        u, v = np.linspace(-0.03, 0.03, 7)[[column, row]]
        point = {
            "z": [u, v, at],
            "y": [u, at, center[1] + v],
            "x": [at, u, center[1] + v],
        }[axis]
        there = {"x": found.field.x, "y": found.field.y, "z": found.field.z}
        across, up = (name for name in "xyz" if name != axis)
        point["xyz".index(across)], point["xyz".index(up)] = there[across][column], there[up][row]
        one = midair.streaming(SCENE, drive, [point])
        assert found.force[row, column] == pytest.approx(one.force[0], rel=1e-3)
        assert found.direction[row, column] @ one.direction[0] > 0.99


def test_silence_pushes_nowhere() -> None:
    found = midair.streaming(SCENE, np.zeros(144), [[0, 0, 0.1]])
    assert found.force[0] == 0
    assert (found.direction == 0).all()


def test_quiet_points_behind_four_foci_take_force_for_little_level() -> None:
    array = midair.Array.grid(20, 20, 10e-3)
    foci = np.array([[x, y, 0.15] for x in (-0.03, 0.03) for y in (-0.03, 0.03)])
    scene = midair.Scene(array, foci)
    level = scene.reach().level

    def behind(count: int, seed: int) -> np.ndarray:
        random = np.random.default_rng(seed)
        around = 0.005 * np.sqrt(random.random(count)) * np.exp(2j * np.pi * random.random(count))
        z = random.uniform(0.02, 0.1, count)
        return foci[random.integers(4, size=count)] + np.c_[around.real, around.imag, z]

    quiet = scene.replace(
        points=np.r_[foci, behind(60, 1)],
        pressures=np.r_[level, np.zeros(60)],
        weights=np.r_[np.ones(4), np.full(60, 0.01)],
    )
    loud, less = midair.solve(scene, "lm", pressures=level), midair.solve(quiet, "lm")
    force = [midair.streaming(scene, one, behind(3000, 2)).force.mean() for one in (loud, less)]
    assert force[1] < 0.8 * force[0]
    assert np.abs(less.pressures[:4]).mean() > 0.98 * np.abs(loud.pressures).mean()


def test_a_plane_has_a_picture_and_points_have_none() -> None:
    mpl.use("Agg")
    import matplotlib.pyplot as plt

    found = midair.streaming(SCENE, midair.solve(SCENE), midair.Plane(0.12, 0.05, pixels=40))
    axes = found.plot(plt.figure().gca())
    assert axes.images[0].get_array().max() == pytest.approx(found.force.max())
    assert axes.collections
    plt.close("all")
    with pytest.raises(midair.SceneError, match="single points"):
        midair.streaming(SCENE, np.ones(144), [[0, 0, 0.1]]).plot()
