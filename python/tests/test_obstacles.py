"""Walls as obstacles, compared with sums of image sources in NumPy, through every interface."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from numpy.typing import NDArray

import midair

#: A wall at x = 60 mm, whose front faces -x.
WALL = midair.Wall([0.06, 0.3, -2.0], [-3, 0, 0])
POINTS = [[-0.02, 0.0, 0.12], [0.03, 0.01, 0.1], [0.055, -0.02, 0.12]]


def array() -> midair.Array:
    """Returns pistons tilted in random directions, one of them dead,
    one at half amplitude and out of phase.
    """
    grid = midair.Array.grid(8, 6, 9e-3)
    tilts = np.random.default_rng(3).normal([0.0, 0.0, 1.0], 0.3, (48, 3))
    response = np.ones(48, complex)
    response[3], response[5] = 0, 0.5j
    return midair.Array(grid.positions, tilts, directivity={"piston": 4.5e-3}, response=response)


def direct(scene: midair.Scene, positions: Any, normals: Any, points: Any) -> NDArray[np.complex128]:
    """Returns eq. (5) in NumPy for pistons with absorption, (P, N)."""
    from scipy.special import j1

    rays = np.asarray(points)[:, None] - positions
    r = np.linalg.norm(rays, axis=2)
    cosine = np.einsum("pik,ik->pi", rays, normals) / r
    k = 2 * np.pi * scene.frequency / scene.sound_speed
    x = k * 4.5e-3 * np.sqrt(1 - np.minimum(cosine**2, 1))
    directivity = np.where(cosine < 0, 0, np.where(x < 1e-9, 1, 2 * j1(x) / np.maximum(x, 1e-12)))
    wave = scene.array.source_pressure / r * directivity * np.exp((1j * k - scene.absorption) * r)
    found: NDArray[np.complex128] = wave * scene.array.response
    return found


def images(scene: midair.Scene, points: Any, sign: float) -> NDArray[np.complex128]:
    """Returns G (P, N) in front of the wall: sources plus `sign` times their images."""
    mirror = np.array([-1, 1, 1])
    own = (scene.array.positions, scene.array.normals)
    seen = (own[0] * mirror + [0.12, 0, 0], own[1] * mirror)
    return direct(scene, *own, points) + sign * direct(scene, *seen, points)


@pytest.mark.parametrize(("kind", "sign"), [("rigid", 1.0), ("soft", -1.0)])
def test_a_wall_is_the_sum_of_images(kind: Any, sign: float) -> None:
    pytest.importorskip("scipy")
    wall = midair.Wall(WALL.point, WALL.normal, kind)
    scene = midair.Scene(array(), POINTS, absorption=0.2, obstacles=[wall])
    exact = images(scene, POINTS, sign)
    assert np.abs(scene.propagation() - exact).max() < 1e-6 * np.abs(exact).max()
    plane = midair.Plane(axis="y", at=0.0, size=0.2, pixels=41, center=(0, 0.12))
    drive = np.exp(1j * np.arange(48))
    found = midair.field(scene, drive, plane)
    places = np.array([[x, 0.0, z] for z in found.z for x in found.x])
    expected = images(scene, places, sign) @ drive
    expected[places[:, 0] > 0.06 + 1e-9] = 0
    assert np.abs(found.pressure.ravel() - expected).max() < 1e-5 * np.abs(expected).max()
    # The forces are those of the field with the wall.
    places = np.array([[0.03, 0.01, 0.1], [0.05, 0.0, 0.1]])
    stiffness = midair.gorkov(scene, drive, places).hessian
    away = 1e-6 * np.eye(3)
    up, down = (midair.gorkov(scene, drive, (places[:, None] + s * away).reshape(-1, 3)).force for s in (1, -1))
    slope = (up - down).reshape(2, 3, 3) / 2e-6
    assert np.allclose(stiffness, -(slope + slope.swapaxes(1, 2)) / 2, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("solver", list(midair.solvers()))
def test_every_solver_meets_the_same_waves(solver: str) -> None:
    scene = midair.Scene(array(), POINTS, obstacles=[WALL])
    solution = midair.solve(scene, solver, seed=1) if solver == "greedy" else midair.solve(scene, solver)
    expected = scene.propagation() @ solution.drive
    assert np.abs(solution.pressures - expected).max() < 2e-5 * np.abs(expected).max()
    ignored = midair.solve(scene.replace(obstacles=None), solver).drive
    own, other = (midair.judge(scene, drive) for drive in (solution.drive, ignored))
    # A drive solved with the wall is at least as accurate in front of it as one solved without.
    assert own.accuracy > other.accuracy - 0.02


def test_every_door_takes_obstacles(tmp_path: Path) -> None:
    scene = midair.Scene(array(), POINTS, obstacles=[WALL], frequency=39e3)
    assert scene.obstacles == [WALL]
    assert scene.replace(obstacles=None).obstacles == []
    assert scene != scene.replace(obstacles=[])
    assert scene.replace(pressures=100.0).obstacles == [WALL]
    for same in (copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        assert same == scene
        assert hash(same) == hash(scene)
        assert same.obstacles == [WALL]
    assert pickle.loads(pickle.dumps(WALL)) == WALL
    assert hash(WALL) == hash(copy.copy(WALL))
    assert repr(WALL) == 'Wall(point=(0.06, 0.3, -2.0), normal=(-3.0, 0.0, 0.0), kind="rigid")'
    for ending in ("toml", "json"):
        scene.save(tmp_path / f"scene.{ending}")
        assert midair.Scene.load(tmp_path / f"scene.{ending}") == scene
    drive = midair.solve(scene, "fast").drive
    for solver in (
        midair.Solver(scene, "fast"),
        midair.Solver(array(), "fast", frequency=39e3, obstacles=[WALL]),
    ):
        assert np.array_equal(solver(POINTS).drive, drive)
        moved = np.add(POINTS, [0, 0, 0.01])
        assert np.array_equal(solver(moved).drive, midair.solve(scene.replace(points=moved), "fast").drive)
    plain = midair.Solver(scene, "fast", obstacles=None)
    assert np.array_equal(plain(POINTS).drive, midair.solve(scene.replace(obstacles=None), "fast").drive)
    batch = midair.solve_batch(scene, np.array([POINTS] * 20), solver="fast")
    assert np.array_equal(batch.drives[7], drive)
    assert np.array_equal(pickle.loads(pickle.dumps(batch))[3].drive, drive)
    solution = midair.solve(scene, "greedy")
    solution.save(tmp_path / "solution.npz")
    assert midair.Solution.load(tmp_path / "solution.npz").scene.obstacles == [WALL]


def test_a_sequence_meets_them(tmp_path: Path) -> None:
    path = np.array([[[1e-4 * t, 0.0, 0.12]] for t in range(30)])
    keywords: dict[str, Any] = {"rate": 1000.0, "change": 0.5, "pressures": 500.0}
    sequence = midair.sequence(array(), path, obstacles=[WALL], **keywords)
    scene = midair.Scene(array(), path[20], obstacles=[WALL])
    expected = abs(scene.propagation() @ sequence.drives[20])
    assert np.allclose(sequence.pressures[20], expected, rtol=1e-5)
    sequence.save(tmp_path / "sequence.npz")
    again = midair.Sequence.load(tmp_path / "sequence.npz")
    assert again == sequence == pickle.loads(pickle.dumps(sequence))
    assert again.scene(3).obstacles == [WALL]
    assert sequence != midair.sequence(array(), path, **keywords)


def test_pictures_show_where_they_are() -> None:
    scene = midair.Scene(array(), POINTS[:1], obstacles=[WALL, midair.Wall([0, 0.1, 0], [0, 1, 0], "soft")])
    axes: Axes = midair.plot(midair.solve(scene, "fast"))
    lines: list[Any] = list(axes.lines)
    assert [line.get_linestyle() for line in lines] == ["-", "--"]
    first = [tuple(np.round(line.get_xy1(), 9)) for line in lines]
    assert first == [(60, 0), (0, 100)]


def test_boards_that_reflect_are_mirrors_in_the_planes_of_their_transducers() -> None:
    pytest.importorskip("scipy")
    preset = "openmpd_pair"
    bare, half = (midair.Array.preset(preset, response=np.ones(512), reflecting=r) for r in (0, 0.5))
    points = [[0.0, 0.0, 0.0], [0.03, -0.01, 0.05]]
    scene = midair.Scene(half, points)
    places, normals, gap = bare.positions.copy(), bare.normals.copy(), 0.2365
    expected = np.zeros((2, 512), complex)
    for bounces in range(4):
        expected += 0.5**bounces * direct(midair.Scene(bare, points), places, normals, points)
        # Each wave goes to the board that it faces, and comes back as if from behind that board.
        places[:, 2] = normals[:, 2] * gap - places[:, 2]
        normals = normals * [1, 1, -1]
    np.testing.assert_allclose(np.asarray(scene.propagation()), expected, atol=2e-5 * abs(expected).max())
    whole = midair.Scene(midair.Array.preset(preset, response=np.ones(512), reflecting=1), points)
    walls = [midair.Wall([0, 0, z], [0, 0, 1]) for z in (-gap / 2, gap / 2)]
    beside = midair.Scene(bare, points, obstacles=walls)
    np.testing.assert_allclose(np.asarray(whole.propagation()), np.asarray(beside.propagation()), rtol=1e-6)
    # The value is part of the array, in files and copies too.
    assert midair.Scene.parse(scene.json()).array.reflecting == 0.5
    assert pickle.loads(pickle.dumps(half)) == half != bare
    assert half.moved(rotation=[0, 0.3, 0], translation=[0.1, 0, 0]).reflecting == 0.5
    with pytest.raises(midair.SceneError, match=r"reflecting is 0\.5: only two flat boards"):
        midair.Array.preset("tinylev", reflecting=0.5)
    with pytest.raises(midair.SceneError, match=r"reflecting is 2: give the part of \|p\| that returns"):
        midair.Array.preset(preset, reflecting=2)
    with pytest.raises(midair.SceneError, match=r"turned by 135\.000 degrees: .* turn it to a board"):
        scene.replace(obstacles=[midair.Wall([0.5, 0, 0], [1, 0, 1])])


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ([WALL, 3], "obstacles[1] is 3: give a list of midair.Wall"),
        (5, "obstacles is 5: give a list of midair.Wall"),
        ([midair.Wall([0, 0, 0.05], [0, 0, 1])], "points[0].position is [-0.02, 0.0, 0.12]: behind the wall"),
        ([midair.Wall([0.001, 0, 0], [1, 0, 0])], "it crosses the array, transducer"),
        ([WALL, midair.Wall([0, 0.1, 0], [0.1, 1, 0])], "obstacles[1].normal is turned by 84.289 degrees"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(given: Any, reported: str) -> None:
    with pytest.raises(midair.SceneError) as refusal:
        midair.Scene(array(), POINTS, obstacles=given)
    assert reported in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_walls_and_files_are_refused_by_name() -> None:
    for arguments, reported in [
        (([0, 0], [0, 0, 1]), "wall.point is"),
        (([0, 0, 0], "up"), "wall.normal is"),
        (([0, 0, 0], [0, 0, 1], "hard"), 'wall.kind is "hard": give "rigid" or "soft"'),
    ]:
        with pytest.raises(midair.SceneError, match=reported):
            midair.Wall(*arguments)  # type: ignore[arg-type]
    text = json.loads(midair.Scene(array(), POINTS, obstacles=[WALL]).json())
    text["obstacles"][0]["kind"] = "hard"
    with pytest.raises(midair.SceneError, match=r"obstacles\[0\].kind"):
        midair.Scene.parse(json.dumps(text))
    with pytest.raises(midair.SceneError, match="a matrix has them in it"):
        midair.Solver(midair.Propagation(np.ones((1, 4))), "fast", obstacles=[WALL])
    behind = midair.Solver(midair.Scene(array(), POINTS, obstacles=[WALL]), "fast")
    with pytest.raises(midair.SceneError, match=r"points\[0\].*behind the wall obstacles\[0\]"):
        behind([[0.07, 0, 0.1]])


def test_sweeps_say_that_they_take_none(tmp_path: Path) -> None:
    scene = midair.Scene(array(), POINTS, obstacles=[WALL])
    with pytest.raises(midair.SceneError, match="scenes: 0 has obstacles, which sweeps do not take"):
        midair.sweep({"scenes": [scene], "solver": [{"name": "fast"}]}, tmp_path / "sweep")


def test_more_points_than_are_kept_are_refused_and_a_sequence_of_them_is_not() -> None:
    board = midair.Array.preset("paper20")
    path = np.tile([0, 0, 0.15], (3000, 1, 1))
    path[:, 0, 0] = np.linspace(-0.01, 0.01, 3000)
    scene = midair.Scene(board, path[:, 0], obstacles=[midair.Wall([0.12, 0, 0], [1, 0, 0])])
    with pytest.raises(midair.SceneError, match="points is 3000 of them: with obstacles G is kept: give at most 2621"):
        scene.propagation()
    drives = np.ones((3000, 400), np.complex64)
    sequence = midair.Sequence(board, path, np.ones((3000, 1)), drives, rate=1e3, obstacles=scene.obstacles)
    p = abs(midair.field(scene, drives[0], path[::1000, 0]).pressure)
    assert np.allclose(sequence.pressures[::1000, 0], p, rtol=1e-4)
