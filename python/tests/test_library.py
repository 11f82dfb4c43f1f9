"""Arrays, scenes and `scene.propagation()`: names, shapes, files, and eq. (5) against the reference."""

import inspect

import numpy as np
import pytest

import midair
import oracle
from scenes import GAIN, POINTS, exact, same_bits, small

NAMES = """
    Array Array.grid Array.preset Array.presets Array.positions Array.normals
    Scene Scene.load Scene.save Scene.propagation Scene.solver Scene.plane Scene.pressures Scene.weights
    Propagation Plane Plane.x Plane.y field Field.pressure Field.radiation Field.x Field.y
    solve Solution.drive Solution.phases Solution.amplitudes Solution.pressures Solution.radiation
    Solution.metrics Solution.status Solution.steps Solution.elapsed Solution.trace
    Metrics.accuracy Metrics.sigma Metrics.uniformity Metrics.level Metrics.residual Metrics.leak
    judge plot solvers SceneError SceneWarning
"""


def test_the_names_of_the_design_are_there() -> None:
    for name in NAMES.split():
        thing = midair
        for part in name.split("."):
            thing = getattr(thing, part)
        assert callable(thing) or inspect.isdatadescriptor(thing), name


def test_errors_are_of_the_kinds_that_people_catch() -> None:
    assert issubclass(midair.SceneError, ValueError)
    assert issubclass(midair.SceneWarning, UserWarning)
    assert set(midair.__all__) <= set(dir(midair))


def test_keywords_have_the_names_and_order_of_the_design() -> None:
    air = midair._midair.scene_keys()["medium"]
    assert {"frequency", "sound_speed", "temperature", "absorption", "density"} <= set(air)
    parameters = {
        midair.Scene: f"array points pressures weights signature bead obstacles {' '.join(air)} "
        "source_pressure directivity reflecting response mask channels pins quantization",
        midair.Array: "positions normals unit source_pressure directivity reflecting response mask channels pins "
        "quantization",
        midair.Plane: "z size pixels center axis at",
        midair.solve: "scene solver pressures weights quantization mask positions balance aim start progress "
        "trace options",
        midair.solve_batch: "scene points pressures solver weights start out threads progress options",
        midair.Solver: "scene solver points options",
        midair.bound: "scene pressures weights mask",
        midair.judge: "scene drive points pressures weights mask precision threads progress",
        midair.field: "scene drive plane",
        midair.gorkov: "scene drive points bead",
        midair.rest: "scene drive points bead",
        midair.fly: "sequence beads speeds duration tau hold bead",
        midair.weigh: "solution frequency ring_down point axis",
        midair.path.fastest: "points array closed margin speed bead air",
        midair.grad.amplitude: "scene drive points cotangent",
        midair.grad.force: "scene drive points cotangent bead",
        midair.torch.field: "scene drive points quantity positions normals sound_speed bead",
        midair.jax.field: "scene drive points quantity positions normals sound_speed bead",
        midair.plot: "what ax plane quantity vmax cmap size",
    }
    for function, names in parameters.items():
        assert list(inspect.signature(function).parameters) == names.split()


def test_defaults_are_those_of_the_conventions() -> None:
    scene = midair.Scene(midair.Array([[0, 0, 0]]), [[0, 0, 0.1]])
    assert (scene.frequency, scene.sound_speed, scene.absorption, scene.density) == (40e3, 340, 0, 1.223)
    array = scene.array
    assert (array.source_pressure, array.directivity, array.response) == (4.386, "point", None)
    assert (scene.pressures, scene.weights, scene.solver, scene.plane) == (None, None, None, None)
    assert scene.wavelength == pytest.approx(8.5e-3, rel=1e-15)
    assert array.normals.tolist() == [[0, 0, 1]]
    plane = midair.Plane(0.15, 0.1)
    assert (plane.pixels, plane.center) == (200, (0, 0))


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_shapes_and_types_are_those_of_the_conventions() -> None:
    scene = small(pressures=[1e3, 2e3, 0, 500], weights=[1, 2, 3, 0])
    solution = midair.solve(scene, "greedy", amplitudes=3, trace=True)
    field = midair.field(scene, solution.drive, midair.Plane(0.15, 0.1, pixels=5))
    n, m = 64, 4
    expected = [
        (scene.array.positions, (n, 3), np.float64),
        (scene.array.normals, (n, 3), np.float64),
        (scene.points, (m, 3), np.float64),
        (scene.pressures, (m,), np.float64),
        (scene.weights, (m,), np.float64),
        (scene.propagation(), (m, n), np.complex64),
        (solution.drive, (n,), np.complex64),
        (solution.phases, (n,), np.float64),
        (solution.amplitudes, (n,), np.float64),
        (solution.pressures, (m,), np.complex64),
        (solution.radiation, (m,), np.float64),
        (solution.targets, (m,), np.float64),
        (solution.trace, (n,), np.float64),
        (scene.reach().alone, (m,), np.float64),
        (scene.reach().level, (m,), np.float64),
        (field.pressure, (5, 5), np.complex64),
        (field.radiation, (5, 5), np.float64),
        (field.x, (5,), np.float64),
        (field.y, (5,), np.float64),
        (scene.array.mask, (n,), np.bool_),
    ]
    for array, shape, dtype in expected:
        assert (array.shape, array.dtype) == (shape, dtype)
    assert len(scene.array) == n
    for thing, names, kind in [
        (solution, "scale elapsed", float),
        (solution, "steps", int),
        (solution, "status solver", str),
        (solution, "options", dict),
        (solution.metrics, "accuracy sigma uniformity level residual leak", float),
        (scene, "frequency sound_speed wavelength absorption density", float),
        (field.plane, "z size", float),
    ]:
        for name in names.split():
            assert type(getattr(thing, name)) is kind, name


def test_grid_is_centred_and_x_runs_fastest() -> None:
    positions = midair.Array.grid(3, 2, pitch=0.01).positions
    x, y = [-0.01, 0, 0.01], [-0.005, 0.005]
    assert positions == pytest.approx(np.array([[i, j, 0] for j in y for i in x]), abs=1e-17)


def test_normals_are_normalised_once_and_then_stay() -> None:
    given = [[0, 3, 4], [1e-200, 0, 0], [0, -1e300, 1e300], [1, 2, 3]]
    array = midair.Array(np.eye(4)[:, :3], given)
    expected = [[0, 0.6, 0.8], [1, 0, 0], [0, -(0.5**0.5), 0.5**0.5], np.array([1, 2, 3]) / 14**0.5]
    assert array.normals == pytest.approx(np.array(expected), abs=1e-15)
    again = midair.Array(array.positions, array.normals).normals
    assert same_bits(again, array.normals)


@pytest.mark.parametrize(("preset", "p1"), [("paper20", 2.36066), ("paper36", 6.40341)])
def test_preset_reaches_the_pressure_of_the_paper(preset: str, p1: float) -> None:
    scene = midair.Scene(midair.Array.preset(preset), [[0, 0, 0.15]])
    # The tolerance is the last printed digit; f32 sums of hundreds of positive terms are accurate to 1e-6.
    assert np.abs(scene.propagation()).sum(dtype=float) == pytest.approx(p1, abs=8e-6)
    assert scene.in_paper_unit
    assert scene.array.source_pressure == 1e-3


@pytest.mark.parametrize("tiles", [(1, 1), (2, 2), (3, 1)])
def test_autd3_is_its_boards_lattice_less_three_sites(tiles: tuple[int, int]) -> None:
    expected = []
    for board in np.ndindex(tiles[::-1]):
        for iy, ix in np.ndindex(14, 18):
            if (ix, iy) not in {(1, 1), (2, 1), (16, 1)}:
                expected.append([board[1] * 0.192 + ix * 0.01016, board[0] * 0.1514 + iy * 0.01016, 0])
    span = np.array([(tiles[0] - 1) * 0.192 + 17 * 0.01016, (tiles[1] - 1) * 0.1514 + 13 * 0.01016, 0])
    array = midair.Array.preset("autd3", tiles=tiles)
    assert len(array) == 249 * tiles[0] * tiles[1]
    assert array.positions == pytest.approx(np.array(expected) - span / 2, abs=1e-15)
    assert np.ptp(array.positions, axis=0) == pytest.approx(span, abs=1e-15)
    assert (array.source_pressure, array.directivity) == (4.386, "t4010a1")


def test_preset_facts_agree_with_the_presets() -> None:
    assert set(midair.Array.presets()) == set(midair.presets()) >= {"paper20", "paper36", "autd3"}
    for name, info in midair.presets().items():
        array = midair.Array.preset(name)
        assert (len(array), array.source_pressure) == (info.count, info.source_pressure)
        assert info.summary
        assert info.source
        if info.tiles:
            assert len(midair.Array.preset(name, (1, 2))) == 2 * info.count


def test_keywords_override_what_a_preset_or_array_says() -> None:
    response = np.linspace(0, 1, 400)
    array = midair.Array.preset("paper20", source_pressure=2.5, directivity={"cos": 2}, response=response)
    assert (array.source_pressure, array.directivity) == (2.5, {"cos": 2})
    assert np.array_equal(array.response, response)
    scene = midair.Scene(array, [[0, 0, 0.15]], source_pressure=3.5, directivity="t4010a1")
    assert (scene.array.source_pressure, scene.array.directivity) == (3.5, "t4010a1")
    assert np.array_equal(scene.array.response, response)
    assert array.source_pressure == 2.5


def test_bare_directivity_names_have_their_usual_parameters() -> None:
    bare = {"piston": 4.5e-3, "sinc": 9e-3, "cos": 3.376}
    for name, parameter in bare.items():
        assert midair.Array([[0, 0, 0]], directivity=name).directivity == {name: parameter}


def test_temperature_gives_the_sound_speed() -> None:
    scene = small(temperature=20)
    assert scene.sound_speed == pytest.approx(331.3 * (1 + 20 / 273.15) ** 0.5, rel=1e-15)


# Errors are relative to a point source's field: where a pattern is nearly 0, f32 leaves it no correct digits.
# The largest absorption, which no air has, causes a warning.
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize(
    ("directivity", "absorption"),
    [
        ("point", 0.0), ("t4010a1", 0.15), ("piston", 0.9), ("sinc", 0.15), ("cos", 0.0),
        ({"piston": 7e-3}, 0.15), ({"sinc": 0.02}, 0.9), ({"cos": 0}, 0.15), ({"cos": 1.5}, 0.0),
    ],
    ids=str,
)  # fmt: skip
def test_propagation_is_eq_5_for_tilted_transducers_of_any_response(
    directivity: str | dict[str, float], absorption: float
) -> None:
    rng = np.random.default_rng(3)
    positions, normals = rng.uniform(-0.1, 0.1, (90, 3)), rng.normal(size=(90, 3))
    response = rng.uniform(0.1, 2, 90) * np.exp(1j * rng.uniform(-np.pi, np.pi, 90))
    response[7] = 0
    # Points all around: less than 1 m from every transducer, and no nearer than 5 cm.
    points = rng.uniform(-0.4, 0.4, (70, 3))
    points = points[np.linalg.norm(points, axis=1) > 0.23]
    array = midair.Array(positions, normals, response=response, directivity=directivity, source_pressure=2.0)
    scene = midair.Scene(array, points, frequency=41e3, sound_speed=345.0, absorption=absorption)
    model = {"response": response, "frequency": 41e3, "sound_speed": 345.0, "absorption": absorption}
    bare = {"piston": ("piston", 4.5e-3), "sinc": ("sinc", 9e-3), "cos": ("cos", 3.376)}
    pattern = next(iter(directivity.items())) if isinstance(directivity, dict) else bare.get(directivity, directivity)
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    expected = oracle.propagation(positions, points, normals=unit, source_pressure=2.0, directivity=pattern, **model)
    scale = np.abs(oracle.propagation(positions, points, source_pressure=2.0, **model))
    found = scene.propagation()
    assert (np.abs(found - expected) <= GAIN * scale).all()
    assert np.array_equal(found == 0, expected == 0)
    behind = (np.einsum("jik,ik->ji", points[:, None] - positions, normals) < 0) & (response != 0)
    assert behind.any()
    assert (found[behind] == 0).all() == (directivity != "point")
    assert (found[:, 7] == 0).all()


@pytest.mark.filterwarnings("ignore:.*nearer than k a:midair.SceneWarning")
@pytest.mark.parametrize(
    ("directivity", "frequency"),
    [
        ({"piston": 0.05}, 40e3),
        ({"piston": 0.2}, 40e3),
        ({"piston": 1.0}, 40e3),
        ({"piston": 0.1}, 4e6),
        ({"sinc": 1.0}, 40e3),
        ({"cos": 0.3}, 40e3),
        ({"cos": 1000}, 40e3),
    ],
    ids=str,
)
def test_propagation_is_accurate_at_every_angle_or_refused(directivity: dict, frequency: float) -> None:
    theta = np.radians(np.linspace(0, 89.99, 5000))
    points = 0.1 * np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=1)
    try:
        array = midair.Array([[0, 0, 0]], directivity=directivity)
        found = midair.Scene(array, points, frequency=frequency).propagation()
    except midair.SceneError:
        assert directivity != {"piston": 0.05}, "ten times a real transducer is no slip of the pen"
        return
    expected = oracle.propagation([[0, 0, 0]], points, directivity=next(iter(directivity.items())), frequency=frequency)
    # Only moduli are compared: at 4 MHz, 0.1 m is as many wavelengths as 10 m at 40 kHz, too many for f32
    # phases.
    assert np.abs(np.abs(found) - np.abs(expected)).max() <= GAIN * 4.386 / 0.1


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_propagation_reaches_two_metres_wherever_the_origin_is(offset: float) -> None:
    rng = np.random.default_rng(4)
    positions, points = rng.uniform(-0.1, 0.1, (50, 3)), rng.uniform(-0.7, 0.7, (50, 3))
    points[:, 2] += 1.2
    # Coordinates of 1 km are themselves rounded to 1e-13 m, a phase of 1e-10 rad.
    expected = oracle.propagation(positions + offset, points + offset)
    found = midair.Scene(midair.Array(positions + offset), points + offset).propagation()
    far = np.linalg.norm(points[:, None] - positions, axis=2).max()
    assert 1.9 < far < 2.2
    # At twice the distance the spacing of f32 numbers is twice as large.
    assert (np.abs(found - expected) <= 2 * GAIN * np.abs(expected)).all()


# Transducers metres apart cause a warning.
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("ending", ["toml", "json"])
def test_a_saved_scene_is_read_back_to_the_last_bit(tmp_path, ending: str) -> None:
    rng = np.random.default_rng(5)
    path = tmp_path / f"scene.{ending}"
    for _ in range(20):
        array = midair.Array(
            0.03 * rng.normal(size=(5, 3)),
            np.eye(3)[rng.integers(0, 3, 5)],
            response=rng.normal(size=5) + 1j * rng.normal(size=5),
            source_pressure=rng.uniform(0.1, 9),
            directivity={"cos": rng.uniform(0, 9)},
        )
        medium = {"frequency": rng.uniform(2e4, 6e4), "sound_speed": rng.uniform(300, 360)}
        medium |= {"absorption": rng.uniform(0, 0.2), "density": rng.uniform(0.9, 1.5)}
        lists = {"pressures": rng.uniform(0, 9e3, 3), "weights": rng.uniform(0, 9, 3)}
        scene = midair.Scene(array, rng.normal(size=(3, 3)), **lists, **medium)
        scene.save(path)
        loaded = midair.Scene.load(path)
        for name in ("points", "pressures", "weights"):
            assert same_bits(getattr(loaded, name), getattr(scene, name)), name
        for name in ("positions", "normals", "response"):
            assert same_bits(getattr(loaded.array, name), getattr(scene.array, name)), name
        assert {name: getattr(loaded, name) for name in medium} == medium
        assert loaded.array.directivity == array.directivity
        assert loaded.array.source_pressure == array.source_pressure
        assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize("ending", ["toml", "json"])
def test_a_saved_grid_preset_solver_and_plane_come_back(tmp_path, ending: str) -> None:
    source, path = tmp_path / "ring.toml", tmp_path / f"saved.{ending}"
    source.write_text(
        """
        [medium]
        temperature = 25.0
        [array]
        preset = "autd3"
        tiles = [2, 1]
        directivity = "t4010a1"
        [solver]
        name = "greedy"
        phases = 8
        order = "rows"
        balance = true
        [plane]
        z = 0.2
        size = 0.05
        pixels = 11
        center = [0.01, -0.02]
        [[points]]
        position = [0.01, 0.02, 0.2]
        pressure = 2000
        [[points]]
        position = [0.0, 0.0, 0.2]
        pressure = 0.0
        weight = 0.5
        """,
        encoding="utf-8",
    )
    midair.Scene.load(source).save(path)
    scene = midair.Scene.load(path)
    assert scene.sound_speed == pytest.approx(331.3 * (1 + 25 / 273.15) ** 0.5, rel=1e-15)
    assert (len(scene.array), scene.array.directivity) == (498, "t4010a1")
    assert scene.solver == ("greedy", {"phases": 8, "order": "rows", "balance": True})
    assert scene.plane == midair.Plane(0.2, 0.05, 11, (0.01, -0.02))
    assert (scene.pressures.tolist(), scene.weights.tolist()) == ([2000, 0], [1, 0.5])
    assert "positions" not in path.read_text("utf-8")


def test_a_scalar_stands_for_all_points_and_integers_are_numbers() -> None:
    scene = small(pressures=1000, weights=np.float32(2))
    assert (scene.pressures.tolist(), scene.weights.tolist()) == ([1000] * 4, [2] * 4)
    ints = midair.Scene(midair.Array(np.zeros((1, 3), dtype=np.int8)), [[0, 0, 1], [1, 0, 1]], pressures=[1, 2])
    assert ints.points.dtype == np.float64
    columns = np.asfortranarray(np.array(POINTS))
    assert np.array_equal(small(points=columns[::2]).points, np.array(POINTS)[::2])


def test_scene_keeps_its_own_copy_of_what_it_was_given() -> None:
    points = np.array(POINTS)
    scene = small(points=points)
    points[:] = 0
    with pytest.raises(ValueError, match="read-only"):
        scene.points[:] = 0
    assert scene.points.tolist() == POINTS
    assert exact(scene).shape == (4, 64)
