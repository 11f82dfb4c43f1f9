"""Spheres and meshes as obstacles: spheres against their series, meshes against spheres,
in every interface.
"""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

import midair

pytest.importorskip("scipy")
from sphere_series import total

CENTER = np.array([0.0, 0.0, 0.1])
RADIUS = 0.02
#: Here the sphere's inside resonates (k a = 4 pi): an equation without the normal derivative fails.
RESONANCE = 4 * np.pi / RADIUS * 340 / (2 * np.pi)
#: One point in the sphere's shadow and three beside it.
POINTS = [[0, 0, 0.145], [0.04, 0, 0.1], [-0.035, 0.01, 0.11], [0, 0.03, 0.12]]


pytestmark = pytest.mark.usefixtures("cache")


def icosphere(cuts: int, radius: float = RADIUS, center: Any = CENTER) -> tuple[Any, Any]:
    """Returns the vertices and faces of a subdivided icosahedron; it has 20 times 4^cuts faces."""
    golden = (1 + 5**0.5) / 2
    corners = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)]
    vertices = np.array([np.roll(corner, shift) for shift in range(3) for corner in corners])
    near = np.linalg.norm(vertices[:, None] - vertices, axis=2) < 2.1
    faces = [
        (a, b, c) if np.linalg.det(vertices[[a, b, c]]) > 0 else (a, c, b)
        for a, b, c in combinations(range(12), 3)
        if near[a, b] and near[b, c] and near[a, c]
    ]
    parts = vertices[np.array(faces)]
    for _ in range(cuts):
        a, b, c = parts.swapaxes(0, 1)
        ab, bc, ca = a + b, b + c, c + a
        parts = np.concatenate([np.stack(part, 1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        parts /= np.linalg.norm(parts, axis=2, keepdims=True)
    unit = parts.reshape(-1, 3) / np.linalg.norm(parts.reshape(-1, 3), axis=1, keepdims=True)
    _, first, index = np.unique(unit.round(9), axis=0, return_index=True, return_inverse=True)
    return radius * unit[first] + center, index.reshape(-1, 3)


def ball(cuts: int = 3, kind: Any = "rigid", radius: float = RADIUS) -> midair.Mesh:
    return midair.Mesh(*icosphere(cuts, radius), kind)


def exact(scene: midair.Scene, points: Any, kind: str = "rigid") -> NDArray[np.complex128]:
    """Returns G (P, N) beside the sphere by its exact series."""
    k = 2 * np.pi * scene.frequency / scene.sound_speed
    own = scene.array
    found: NDArray[np.complex128] = total(points, own.positions, CENTER, RADIUS, k, kind).T
    return own.source_pressure * found


@pytest.mark.filterwarnings("ignore:.*behind every transducer:midair.SceneWarning")
@pytest.mark.parametrize("kind", ["rigid", "soft"])
@pytest.mark.parametrize(("radius", "away"), [(0.0005, 0.02), (0.02, 0.1), (0.02, 0.03), (0.09, 0.13)])
def test_a_sphere_is_its_series(kind: Any, radius: float, away: float) -> None:
    rng = np.random.default_rng(1)
    array = midair.Array(np.c_[rng.uniform(-0.05, 0.05, (12, 2)), np.zeros(12)])
    center = np.array([0.003, -0.002, away])
    rays = rng.normal(size=(30, 3))
    rays *= (
        radius
        * np.r_[np.full(10, 1.0001), rng.uniform(1.02, 3, 20)][:, None]
        / np.linalg.norm(rays, axis=1, keepdims=True)
    )
    places = center + rays
    places = places[np.linalg.norm(places[:, None] - array.positions, axis=2).min(1) > 1e-3]
    scene = midair.Scene(array, places, obstacles=[midair.Sphere(center, radius, kind)])
    k = 2 * np.pi * scene.frequency / scene.sound_speed
    expected = array.source_pressure * total(places, array.positions, center, radius, k, kind).T
    assert np.abs(scene.propagation() - expected).max() < 1e-5 * np.abs(expected).max()
    drive = np.exp(1j * np.arange(12))
    pressure = midair.field(scene, drive, places).pressure
    assert np.abs(pressure - expected @ drive).max() < 1e-5 * np.abs(expected @ drive).max()


@pytest.mark.filterwarnings("ignore:array.positions")
def test_a_sphere_of_pistons_is_what_least_squares_find() -> None:
    reported = json.loads((Path(__file__).parent / "sphere_pistons.json").read_text("utf-8"))
    air = {name: reported[name] for name in ("frequency", "sound_speed")}
    for case in reported["cases"]:
        sphere = midair.Sphere(case["center"], case["radius"], case["kind"])
        array = midair.Array(case["sources"], case["normals"], directivity=case["directivity"], source_pressure=1.0)
        found = midair.Scene(array, case["points"], obstacles=[sphere], **air).propagation()
        expected = np.array(case["totals"]) @ [1, 1j]
        assert np.abs(found - expected.T).max() < 1e-5 * np.abs(expected).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "frequency"),
    [
        ("rigid", 40e3),
        ("soft", RESONANCE),
        *(pytest.param(*case, marks=pytest.mark.long) for case in (("soft", 40e3), ("rigid", RESONANCE))),
    ],
)
def test_a_mesh_of_a_sphere_is_the_sphere(kind: Any, frequency: float) -> None:
    array = midair.Array.preset("paper20")
    rays = np.random.default_rng(2).normal(size=(40, 3))
    rays *= np.random.default_rng(3).uniform(1.2, 4, (40, 1)) / np.linalg.norm(rays, axis=1, keepdims=True)
    places = CENTER + RADIUS * rays
    places = places[places[:, 2] > 5e-3]
    scene = midair.Scene(array, places, frequency=frequency, obstacles=[ball(kind=kind)])
    expected = exact(scene, places, kind)
    off = scene.propagation() - expected
    assert np.linalg.norm(off) < 0.03 * np.linalg.norm(expected)
    drive = np.exp(1j * np.arange(400))
    field = midair.field(scene, drive, places).pressure
    assert np.abs(field - scene.propagation() @ drive).max() < 1e-4 * np.abs(field).max()
    # Inside the sphere the pressure is 0.
    assert midair.field(scene, drive, [CENTER, np.add(CENTER, [0, 0, 0.99 * RADIUS])]).pressure.tolist() == [
        0,
        0,
    ]


@pytest.mark.slow
def test_solving_beside_a_sphere() -> None:
    scene = midair.Scene(midair.Array.preset("paper20"), POINTS)
    received = exact(scene, POINTS)
    behind = scene.replace(obstacles=[midair.Sphere(CENTER, RADIUS)])
    meshed = scene.replace(obstacles=[ball()])
    level = np.abs(midair.solve(behind, "uniform").pressures).mean()
    found = {}
    for name, one in {"ignored": scene, "sphere": behind, "mesh": meshed}.items():
        p = np.abs(received @ midair.solve(one, "uniform").drive)
        found[name] = (p.min() / p.max(), p.mean() / level)
    assert found["ignored"][0] < 0.85
    assert found["sphere"][0] > 0.999
    assert found["mesh"][0] > 0.97
    assert found["mesh"][1] > 0.99


@pytest.mark.parametrize("obstacle", [midair.Sphere(CENTER, RADIUS), ball(1, "soft", 0.008)], ids=str)
def test_every_door_takes_bodies(obstacle: Any, tmp_path: Path) -> None:
    array = midair.Array.grid(6, 5, 10e-3)
    scene = midair.Scene(array, POINTS[:2], obstacles=[obstacle])
    assert scene.obstacles == [obstacle]
    assert pickle.loads(pickle.dumps(obstacle)) == obstacle
    assert hash(pickle.loads(pickle.dumps(obstacle))) == hash(obstacle)
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert pickle.loads(pickle.dumps(scene)).obstacles == [obstacle]
    for ending in ("toml", "json"):
        scene.save(tmp_path / f"scene.{ending}")
        assert midair.Scene.load(tmp_path / f"scene.{ending}") == scene
    drive = midair.solve(scene, "fast").drive
    solver = midair.Solver(array, "fast", obstacles=[obstacle])
    assert np.array_equal(solver(POINTS[:2]).drive, drive)
    moved = np.add(POINTS[:2], [0, 0, 0.01])
    assert np.array_equal(solver(moved).drive, midair.solve(scene.replace(points=moved), "fast").drive)
    batch = midair.solve_batch(scene, np.array([POINTS[:2]] * 3), solver="fast")
    assert np.array_equal(batch.drives[1], drive)
    path = np.array([[[1e-4 * t, 0.0, 0.14]] for t in range(20)])
    sequence = midair.sequence(array, path, rate=1000.0, change=0.5, pressures=200.0, obstacles=[obstacle])
    own = midair.Scene(array, path[7], obstacles=[obstacle])
    assert np.allclose(sequence.pressures[7], abs(own.propagation() @ sequence.drives[7]), rtol=1e-5)
    solution = midair.solve(scene, "greedy")
    solution.save(tmp_path / "solution.npz")
    assert midair.Solution.load(tmp_path / "solution.npz").scene.obstacles == [obstacle]


def test_responses_and_masks_are_those_of_the_array() -> None:
    array = midair.Array.grid(4, 3, 10e-3)
    response = np.exp(1j * np.arange(12)) * np.linspace(0.5, 1, 12)
    other = midair.Array(array.positions, response=response, mask=np.arange(12) != 5)
    for obstacle in (midair.Sphere(CENTER, RADIUS), ball(1, radius=0.008)):
        own, bare = (midair.Scene(one, POINTS[:2], obstacles=[obstacle]) for one in (other, array))
        expected = bare.propagation() * response * (np.arange(12) != 5)
        assert np.abs(own.propagation() - expected).max() < 1e-6 * np.abs(expected).max()


def test_pictures_show_where_bodies_are() -> None:
    plane = midair.Plane(axis="y", at=0.0, size=0.16, pixels=40, center=(0, 0.1))
    scene = midair.Scene(midair.Array.grid(6, 5, 10e-3), POINTS[:1], obstacles=[midair.Sphere(CENTER, RADIUS)])
    axes: Axes = midair.plot(midair.solve(scene.replace(plane=plane), "fast"))
    circle: Any = axes.patches[0]
    assert (circle.center, round(circle.radius, 6)) == ((0.0, 100.0), 20.0)
    scene = scene.replace(obstacles=[ball(1, "soft", 0.008)], plane=plane)
    from matplotlib import pyplot as plt

    axes = midair.plot(midair.solve(scene, "fast"), ax=plt.figure().add_subplot())
    lines = next(one for one in axes.collections if isinstance(one, LineCollection))
    places = np.concatenate(lines.get_segments()) - [0, 100]
    # The edges of this coarse mesh lie up to an eighth of the radius inside the sphere.
    assert (np.linalg.norm(places, axis=1) <= 8 + 1e-6).all()
    assert (np.linalg.norm(places, axis=1) > 7).all()


@pytest.mark.slow
def test_a_mesh_is_solved_once(cache: Path) -> None:
    array = midair.Array.grid(4, 3, 10e-3)
    mesh = ball(1, radius=0.0079)
    before = set(cache.rglob("*.npz"))
    first = midair.Scene(array, POINTS[:2], obstacles=[mesh]).propagation()
    kept = set(cache.rglob("*.npz")) - before
    assert len(kept) == 1
    # The result comes from the file; a broken file is computed again.
    for spoil in (b"", b"\x93NUMPY nonsense"):
        other = midair.Array.grid(4, 3, 10e-3)
        assert np.array_equal(midair.Scene(other, POINTS[:2], obstacles=[mesh]).propagation(), first)
        kept.copy().pop().write_bytes(spoil)
    assert not list(cache.rglob("*.part"))
    # Each combination of mesh and medium has a file of its own: these scenes add two files.
    midair.Scene(array, POINTS[:2], frequency=39e3, obstacles=[mesh])
    midair.Scene(array, POINTS[:2], obstacles=[ball(1, "soft", 0.0079)])
    assert len(set(cache.rglob("*.npz")) - before) == 3


@pytest.mark.slow
def test_files_of_modellers(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = icosphere(1, 8.0, np.zeros(3))
    model = trimesh.Trimesh(vertices, faces)
    for ending in ("stl", "obj", "ply"):
        model.export(tmp_path / f"ball.{ending}")
        mesh = midair.Mesh.from_file(tmp_path / f"ball.{ending}", scale=1e-3, offset=[0, 0, 0.1])
        assert len(mesh.faces) == 80
        assert np.allclose(np.linalg.norm(mesh.vertices - CENTER, axis=1), 0.008, rtol=1e-5)
    text = {
        "array": {"grid": {"nx": 6, "ny": 5, "pitch": 0.01}},
        "points": [{"position": [0, 0, 0.145]}],
        "obstacles": [{"file": "ball.stl", "scale": 1e-3, "offset": [0, 0, 0.1], "kind": "soft"}],
    }
    (tmp_path / "scene.json").write_text(json.dumps(text), encoding="utf-8")
    scene = midair.Scene.load(tmp_path / "scene.json")
    assert repr(scene.obstacles) == "[<midair.Mesh of 80 faces, 16 x 16 x 16 mm, soft>]"
    text["obstacles"][0]["file"] = "gone.stl"
    (tmp_path / "scene.json").write_text(json.dumps(text), encoding="utf-8")
    with pytest.raises(midair.SceneError, match=r'obstacles\[0\].file is "[^"]*gone.stl": there is no such file'):
        midair.Scene.load(tmp_path / "scene.json")
    (tmp_path / "empty.stl").write_bytes(b"solid nothing\nendsolid\n")
    (tmp_path / "text.xyzzy").write_text("no mesh", "utf-8")
    for name in ("empty.stl", "text.xyzzy", "gone.stl"):
        with pytest.raises(midair.SceneError) as refusal:
            midair.Mesh.from_file(tmp_path / name)
        assert str(refusal.value).startswith(f'path is "{tmp_path / name}": ')
        assert "\n" not in str(refusal.value)
    with pytest.raises(midair.SceneError, match="scale is 0"):
        midair.Mesh.from_file(tmp_path / "ball.stl", scale=0)
    # A surface is closed even if a texture has seams on it, or if a face has no area.
    corners = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"vt 0.{k} 0.5" for k in range(3 * len(faces))]
    seams = ["f " + " ".join(f"{v + 1}/{3 * k + c + 1}" for c, v in enumerate(face)) for k, face in enumerate(faces)]
    (tmp_path / "seams.obj").write_text("\n".join([*corners, *seams, "f 1/1 1/2 2/3"]) + "\n", encoding="utf-8")
    assert len(midair.Mesh.from_file(tmp_path / "seams.obj", scale=1e-3).faces) == 80
    (tmp_path / "half.stl").write_bytes((tmp_path / "ball.stl").read_bytes()[:1000])
    for name, reported in [
        ("", "it is a folder"),
        ("half.stl", "trimesh cannot read it .*, export it again, as .stl"),
    ]:
        with pytest.raises(midair.SceneError, match=reported):
            midair.Mesh.from_file(tmp_path / name)
    # A file in millimetres, read as if in metres.
    big = midair.Mesh.from_file(tmp_path / "ball.stl", offset=[0, 0, 20])
    with pytest.raises(midair.SceneError, match=r"obstacles\[0\] is \d+ elements .*; a file in mm wants"):
        midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[big])


def test_what_cannot_be_is_refused_in_a_line() -> None:
    array = midair.Array.grid(6, 5, 10e-3)
    vertices, faces = icosphere(1, 0.008)
    for made, reported in [
        ((vertices, faces[1:]), r"mesh.faces\[\d+\] is beside a hole, along its edge"),
        ((vertices, np.r_[faces[1:], faces[:1, ::-1]]), r"mesh.faces\[\d+\] is turned against faces\[\d+\]"),
        ((vertices, faces[:, ::-1]), r"mesh is inside out .*: swap two corners of every face"),
        ((vertices, np.r_[faces, faces[:1]]), r"mesh.faces\[80\] is turned against faces\[0\], or doubles"),
        ((vertices, faces - 1), r"mesh.faces\[\d+\] is \[.*: give indices below the 42 vertices"),
        ((vertices, []), r"mesh.faces is \[\]: give whole numbers of shape"),
        ((np.full((3, 3), np.nan), [[0, 1, 2]]), r"mesh.vertices\[0\] is \[NaN, NaN, NaN\]"),
        ((vertices, faces, "hard"), 'mesh.kind is "hard": give "rigid" or "soft"'),
        ((vertices, faces.astype(float)), "mesh.faces is"),
    ]:
        with pytest.raises(midair.SceneError, match=reported) as refusal:
            midair.Mesh(*made)
        assert "\n" not in str(refusal.value)
    mesh = midair.Mesh(vertices, faces)
    beside, low, high = (
        midair.Mesh(np.add(vertices, by), faces) for by in ([0.03, 0, 0], [0, 0, -0.095], [0, 0, 0.045])
    )
    inside = r"points\[0\].position is .*: inside the"
    sphere = midair.Sphere(CENTER, RADIUS)
    for given, reported in [
        ([sphere, mesh], r"obstacles\[0\] is a sphere among others: its series knows of no other obstacle"),
        ([midair.Sphere([0, 0, 0.01], RADIUS)], r"obstacles\[0\] is a sphere that crosses the array"),
        ([midair.Sphere(CENTER, -1.0)], r"obstacles\[0\].radius is -1"),
        ([midair.Sphere([0, 0, 1], 0.5)], r"obstacles\[0\].radius is 0.5 m: give at most 0.102 m"),
        ([low], r"obstacles\[0\] is a mesh that crosses the array: transducer \d+ is inside or within"),
        ([mesh, midair.Wall([0.0085, 0, 0], [-1, 0, 0])], "it crosses the array"),
        ([beside, midair.Wall([0.035, 0, 0], [-1, 0, 0])], "before the wall"),
        ([midair.Sphere([0, 0, 0.145], RADIUS)], inside + r" sphere obstacles\[0\]"),
        ([high], inside + r" mesh obstacles\[0\]"),
    ]:
        with pytest.raises(midair.SceneError, match=reported) as refusal:
            midair.Scene(array, [[0, 0, 0.145]], obstacles=given)
        assert "\n" not in str(refusal.value)
    text: dict[str, Any] = json.loads(midair.Scene(array, [[0, 0, 0.145]], obstacles=[sphere]).json())
    for changed, reported in [
        (
            {"center": [0, 0, 0.1], "point": [0, 0, 0]},
            r"obstacles\[0\] is described in two ways: give",
        ),
        ({"kind": "soft"}, r"obstacles\[0\] is not described"),
        ({"center": [0, 0, 0.1]}, r"obstacles\[0\].radius is left out"),
        (
            {"vertices": vertices.tolist(), "faces": faces[1:].tolist()},
            r"obstacles\[0\].faces\[\d+\] is beside a hole",
        ),
        ({"scale": 2}, r"obstacles\[0\].file is left out"),
    ]:
        text["obstacles"] = [changed]
        with pytest.raises(midair.SceneError, match=reported):
            midair.Scene.parse(json.dumps(text))


@pytest.mark.slow
def test_memory_is_requested_before_it_is_taken() -> None:
    code = (
        "import midair, test_bodies\n"
        "midair.Scene(midair.Array.grid(4, 3, 0.01), [[0, 0, 0.145]], obstacles=[test_bodies.ball()])"
    )
    environment = os.environ | {"MIDAIR_MEMORY": "10MB", "PYTHONPATH": str(Path(__file__).parent)}
    found = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, encoding="utf-8")
    assert "MemoryError: the boundary of the meshes of N = 12 transducers and M = 1280 points needs 0.013 GB" in (
        found.stderr
    )


@pytest.mark.slow
def test_ctrl_c_is_noticed_while_a_mesh_is_solved(tmp_path: Path) -> None:
    code = (
        "import midair, numpy as np, test_bodies\n"
        "mesh = midair.Mesh(*test_bodies.icosphere(4, 0.04, np.array([0, 0, 0.1])))\n"
        "print('now', flush=True)\n"
        "midair.Scene(midair.Array.preset('paper20'), [[0, 0, 0.2]], obstacles=[mesh])"
    )
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": str(Path(__file__).parent)}
    program = subprocess.Popen(
        [sys.executable, "-c", code],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    assert program.stdout is not None
    assert program.stdout.readline() == "now\n"
    time.sleep(0.5)
    program.send_signal(signal.SIGINT)
    error = program.communicate(timeout=60)[1]
    assert error.strip().endswith("KeyboardInterrupt")
    assert not list(tmp_path.rglob("*.npz")) + list(tmp_path.rglob("*.part"))
