"""Traps: signatures, the force on beads against finite differences, and the strength of traps."""

import copy
import pickle
import warnings
from typing import Any

import numpy as np
import pytest

import midair
import oracle
import traps
from oracle import Complex, Real
from traps import least, scattered

# Boards: positions and normals, half the size in m of the box of trap points, their least distance in m.
BOARDS = {
    "openmpd": (traps.openmpd, [0.05, 0.05, 0.02], 0.02),
    "tinylev": (traps.tinylev, [0.02, 0.02, 0.005], 0.01),
}


@pytest.mark.parametrize("preset", ["openmpd_pair", "tinylev"])
def test_presets_have_the_geometry_of_their_boards(preset: str) -> None:
    array = midair.Array.preset(preset)
    positions, normals = {"openmpd_pair": traps.openmpd, "tinylev": traps.tinylev}[preset]()
    apart = np.linalg.norm(array.positions[:, None] - positions, axis=2)
    nearest = apart.argmin(axis=1)
    assert sorted(nearest) == list(range(len(positions)))
    # The rings' radii and heights are published with a precision of 10 um.
    assert apart.min(axis=1).max() < 2e-5
    assert np.allclose(array.normals, normals[nearest], atol=1e-3)


@pytest.mark.parametrize("absorption", [0.0, 0.9])
@pytest.mark.parametrize(
    "directivity", ["point", {"piston": 4.5e-3}, {"piston": 9e-3}, {"sinc": 9e-3}, {"cos": 3.376}, "t4010a1"]
)
def test_gorkov_is_what_differences_in_double_precision_give(directivity: Any, absorption: float) -> None:
    rng = np.random.default_rng(3)
    positions = rng.uniform(-0.05, 0.05, (12, 3)) * [1, 1, 0.2]
    normals = rng.uniform(-0.4, 0.4, (12, 3)) + np.array([0, 0, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    response = rng.normal(size=12) + 1j * rng.normal(size=12)
    drive = np.exp(2j * np.pi * rng.random(12)).astype(np.complex64) * np.float32(0.7)
    points = rng.uniform(-0.03, 0.03, (5, 3)) + np.array([0, 0, 0.12])
    array = midair.Array(positions, normals, response=response, directivity=directivity)
    scene = midair.Scene(array, points, absorption=absorption, signature="twin")
    particle = {"radius": 4e-4, "density": 40.0, "sound_speed": 1200.0}
    found = midair.gorkov(scene, drive, bead=particle)
    kind = directivity if isinstance(directivity, str) else next(iter(directivity.items()))

    def pressure(at: Real) -> Complex:
        keywords: dict[str, Any] = {"normals": normals, "response": response, "absorption": absorption}
        matrix = oracle.propagation(positions, at.reshape(-1, 3), directivity=kind, **keywords)
        return (matrix @ drive.astype(complex)).reshape(at.shape[:-1])

    # Differences of fourth order in the third derivatives of a pressure take a second.
    one = slice(0, 1) if absorption else slice(1, 2)
    potential, force, hessian = traps.felt(pressure, points[one], **particle)
    k = 2 * np.pi / traps.WAVELENGTH
    scale = abs(potential).max()
    # The measured pattern's second derivative jumps every 10 degrees, so differences across a jump are
    # coarse.
    coarse = 1e4 if directivity == "t4010a1" else 1.0
    np.testing.assert_allclose(found.potential[one], potential, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(found.force[one], force, rtol=0, atol=1e-9 * coarse * k * scale)
    np.testing.assert_allclose(found.hessian[one], hessian, rtol=0, atol=1e-8 * coarse * k * k * scale)
    np.testing.assert_array_equal(found.stiffness, np.diagonal(found.hessian, axis1=1, axis2=2))
    # A point alone gives the same bits as all points together.
    alone = midair.gorkov(scene, drive, points[3:4], bead=particle)
    assert alone.potential[0] == found.potential[3]
    assert np.array_equal(alone.hessian[0], found.hessian[3])
    assert pickle.loads(pickle.dumps(found)) == found != alone


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_a_plane_standing_wave_has_the_force_of_all_partial_waves_and_no_jump_in_the_radius() -> None:
    """Checks F = 2 pi E/k^2 sin(2 k z) sum_n (n + 1) (-1)^n Im(T_n) of the partial waves, against which 1 mm
    has 26 % less than by Gor'kov.
    """
    far = 200.0
    array = midair.Array([[0, 0, -far], [0, 0, far]], [[0, 0, 1], [0, 0, -1]], source_pressure=1e3 * far)
    k = 2 * np.pi / traps.WAVELENGTH
    z = traps.WAVELENGTH / 16
    scene = midair.Scene(array, [[0, 0, z]])

    def force(radius: float) -> float:
        return float(midair.gorkov(scene, [1, 1], bead={"radius": radius}).force[0, 2])

    n = np.arange(10)
    for radius in (5e-5, 5e-4, 1e-3, 1.06e-3, 1.08e-3, 1.25e-3, 3e-3):
        # p = 2 P cos(k z) up to a phase, so the energy density is (2 P)^2/(4 rho c^2).
        energy = (2e3) ** 2 / (4 * traps.DENSITY * traps.SOUND_SPEED**2)
        sum_of_all = ((n + 1) * (-1.0) ** n * traps.pairs(radius, orders=10).imag).sum()
        exact = -8 * np.pi * energy / k**2 * np.sin(2 * k * z) * sum_of_all / 2
        assert force(radius) == pytest.approx(exact, rel=1.5e-3)
    # The force is towards a pressure node, upwards from z = 0.
    assert force(1e-3) > 0
    # The share of the force by volume of a small sphere, in air of 25 degrees Celsius.
    scene = scene.replace(temperature=25)
    ratios = [force(r) / r**3 / force(5e-5) * (5e-5) ** 3 for r in (0.5e-3, 1.0e-3, 1.08e-3, 1.25e-3)]
    assert np.allclose(ratios, [0.934, 0.748, 0.709, 0.618], rtol=2e-3)
    sizes = np.arange(0.9e-3, 1.3e-3, 5e-6)
    relative = np.array([force(r) / r**3 for r in sizes])
    assert abs(np.diff(relative) / relative[1:]).max() < 0.01


@pytest.mark.usefixtures("cache")
@pytest.mark.parametrize("body", ["sphere", "mesh"])
def test_forces_beside_a_body_are_the_slopes_of_the_field(body: str) -> None:
    # The forces are compared with finite differences of G, which has six correct digits beside bodies.
    center, radius = np.array([0.0, 0.0, 0.1]), 0.008
    ball = pytest.importorskip("trimesh").creation.icosphere(2, radius)
    mesh = midair.Mesh(ball.vertices + center, ball.faces, "soft")
    obstacle = midair.Sphere(center, radius) if body == "sphere" else mesh
    points = [[0, 0, 0.145], [0.04, 0, 0.1]]
    scene = midair.Scene(midair.Array.grid(6, 5, 10e-3), points, obstacles=[obstacle])
    drive = midair.solve(scene, "fast").drive
    away = np.array([[5, 1, -1], [-1, 4, 2], [1, -1, 5]])
    places = center + (radius + 6e-3) * away / np.linalg.norm(away, axis=1, keepdims=True)
    felt = midair.gorkov(scene, drive, places)
    assert scene.medium["sound_speed"] == pytest.approx(traps.SOUND_SPEED)
    c = traps.response()

    def slope(of: Any, at: Any) -> Any:
        step = 2e-4
        all_of = [of((at[:, None] + n * step * np.eye(3)).reshape(-1, 3)) for n in (1, -1, 2, -2)]
        up, down, up2, down2 = (found.reshape(-1, 3, *found.shape[1:]) for found in all_of)
        return (8 * (up - down) - (up2 - down2)) / (12 * step)

    def pressure(at: Any) -> Any:
        return scene.replace(points=at, pressures=None).propagation() @ drive

    def first(at: Any) -> Any:
        return slope(pressure, at)

    def second(at: Any) -> Any:
        return slope(first, at)

    p, one, two, three = pressure(places), first(places), second(places), slope(second, places)
    sizes = [abs(p) ** 2, (abs(one) ** 2).sum(axis=1), (abs(two) ** 2).sum(axis=(1, 2))]
    assert np.allclose(felt.potential, -c.real @ sizes / 2, rtol=3e-4)
    force = c[0] * p.conj()[:, None] * one + c[1] * np.einsum("pj,pij->pi", one.conj(), two)
    force = (force + c[2] * np.einsum("pjk,pijk->pi", two.conj(), three)).real
    assert abs(felt.force - force).max() < 1e-3 * abs(force).max()
    with pytest.raises(midair.SceneError, match="from an obstacle's surface: leave"):
        midair.gorkov(scene, drive, center + np.array([[0, 0, radius + 1e-5]]))


@pytest.mark.filterwarnings("ignore:traps hold:midair.SceneWarning")
def test_a_rest_and_a_bead_can_be_copied() -> None:
    boards = midair.Array.preset("openmpd_pair", quantization={})
    bead = midair.Bead(radius=0.5e-3, density=998, gravity=[0, -9.81, 0])
    scene = midair.Scene(boards, [[0, 0, 0], [0, 0, 0.5]], signature="trap", bead=bead)
    found = midair.solve(scene).rest()
    for again in (pickle.loads(pickle.dumps(found)), copy.copy(found), copy.deepcopy(found)):
        for name in ("place", "held", "stiffness", "axes", "basin", "restoring", "frequencies", "mass"):
            np.testing.assert_array_equal(getattr(again, name), getattr(found, name))
    assert pickle.loads(pickle.dumps(bead)) == copy.deepcopy(bead) == bead == eval(repr(bead), vars(midair))
    assert len({bead, midair.Bead(), scene.bead}) == 2


def test_beads_rest_where_the_net_force_is_0() -> None:
    boards = midair.Array.preset("openmpd_pair", quantization={})
    points = scattered(4, [0.03, 0.03, 0.01], 0.015, 5)
    solution = midair.solve(midair.Scene(boards, points, pressures=3000, signature="trap"), aim="max")
    bead = midair.Bead(density=100.0, gravity=[0, -9.81, 0])
    rest = solution.rest(bead=bead)
    there = solution.gorkov(rest.place, bead=bead)
    air, volume = solution.scene.medium["density"], 4 / 3 * np.pi * 1e-9
    assert rest.held.all()
    assert np.allclose(there.weight, [0, -9.81 * (100 - air) * volume, 0], atol=1e-20)
    assert abs(there.net).max() < 1e-6 * abs(there.weight).max()
    assert np.allclose(np.linalg.eigvalsh(there.hessian), rest.stiffness, rtol=1e-6)
    mass = (100 + air / 2) * volume
    assert rest.mass == there.mass == pytest.approx(mass)
    assert np.allclose(rest.frequencies, np.sqrt(rest.stiffness / mass) / (2 * np.pi))
    assert np.allclose(rest.acceleration, rest.restoring / mass)
    # A spring with the trap's stiffness would have this force already within the width of the basin.
    assert (rest.restoring < rest.stiffness[:, :, None] * rest.basin).all()
    assert (rest.basin > 1.5e-3).all()
    lost = midair.rest(solution.scene, np.zeros(512), points)
    assert not lost.held.any()
    assert np.isnan(lost.stiffness).all()


@pytest.mark.parametrize("name", ["trap", "twin", "vortex"])
def test_a_signature_multiplies_the_responses_and_is_not_played(name: str) -> None:
    positions, normals = traps.openmpd()
    points = np.array([[0.01, -0.02, 0.01], [-0.02, 0.03, -0.015]])
    array = midair.Array(positions, normals)
    scene = midair.Scene(array, points, signature=name)
    plain = midair.Scene(array, points)
    way = positions - points[:, None]
    signs = {
        "trap": np.where(way[..., 2] > 0, -1, 1),
        "twin": np.where(way[..., 0] < 0, -1, 1),
        "vortex": np.exp(1j * np.arctan2(way[..., 1], way[..., 0])),
    }[name]
    expected = oracle.propagation(positions, points, normals=normals) * signs
    np.testing.assert_allclose(scene.propagation(), expected, rtol=1e-3, atol=1e-3)
    solution = midair.solve(scene, "uniform")
    drive = solution.drive.astype(complex)
    np.testing.assert_allclose(solution.pressures, expected @ drive, rtol=1e-4)
    real = oracle.propagation(positions, points, normals=normals) @ drive
    np.testing.assert_allclose(midair.field(scene, solution, points).pressure, real, atol=1.0)
    assert (abs(real) < 0.5 * abs(solution.pressures)).all()
    # Signatures given as factors give the same foci, and a single signature applies to all points.
    given = plain.replace(signature=signs)
    foci = [midair.solve(which, "uniform", pressures=1000.0, aim="max").drive for which in (given, scene)]
    assert np.array_equal(*foci)
    # Only the name "trap" makes the solver also increase the stiffness.
    assert np.array_equal(midair.solve(given, "uniform").drive, solution.drive) == (name != "trap")
    one = midair.Scene(array, points[:1], signature=signs[0])
    assert np.array_equal(midair.solve(one, "fast").drive, midair.solve(scene.replace(points=points[:1]), "fast").drive)
    assert midair.judge(scene, solution).accuracy == pytest.approx(solution.metrics.accuracy, rel=1e-4)


def test_every_door_takes_a_signature(tmp_path: Any) -> None:
    positions, normals = traps.tinylev()
    array = midair.Array(positions, normals)
    points = np.array([[0.0, 0, 0.002], [0.005, 0, -0.01]])
    scene = midair.Scene(array, points, signature="Trap")
    assert scene.signature == "trap"
    assert midair.Scene(array, points).signature is None
    expected = midair.solve(scene, "fast")
    for solver in (midair.Solver(scene, "fast"), midair.Solver(array, "fast", signature="trap")):
        assert np.array_equal(solver(points).drive, expected.drive)
        again = pickle.loads(pickle.dumps(solver))
        assert np.array_equal(again(points[::-1]).drive, midair.solve(scene.replace(points=points[::-1]), "fast").drive)
        assert again(points).scene == scene
    batch = midair.solve_batch(scene, np.stack([points, points[::-1]]), solver="fast")
    assert np.array_equal(batch.drives[0], expected.drive)
    assert batch[0].scene == scene
    assert pickle.loads(pickle.dumps(batch)) == batch
    plain = midair.Solver(scene, "fast", signature=None)
    assert np.array_equal(plain(points).drive, midair.solve(scene.replace(signature=None), "fast").drive)
    assert not np.array_equal(plain(points).drive, expected.drive)
    factors = np.exp(1j * np.arange(72))
    for other in (
        scene,
        scene.replace(signature=factors),
        scene.replace(signature=np.stack([factors, -factors])),
    ):
        assert pickle.loads(pickle.dumps(other)) == other
        solution = midair.solve(other, "fast", weights=[1, 0])
        assert pickle.loads(pickle.dumps(solution)) == solution
    assert scene != scene.replace(signature="twin") != scene.replace(signature=None)
    assert scene.replace(pressures=100.0).signature == "trap"
    np.testing.assert_array_equal(scene.replace(signature=factors).signature, factors)
    for ending in ("toml", "json"):
        scene.save(tmp_path / f"scene.{ending}")
        assert midair.Scene.load(tmp_path / f"scene.{ending}") == scene
    for ending in ("npz", "json"):
        expected.save(tmp_path / f"drive.{ending}")
        assert midair.Solution.load(tmp_path / f"drive.{ending}") == expected
    assert midair.Propagation(scene.propagation()).shape == (2, 72)


def test_what_cannot_be_a_trap_is_refused_in_one_line(tmp_path: Any) -> None:
    array = midair.Array.preset("paper20")
    points = [[0, 0, 0.1]]
    scene = midair.Scene(array, points)
    for signature, reported in [
        ("bottle", 'unknown signature "bottle"'),
        (np.ones(3), 'signature is of shape (3,): give "trap"'),
        (np.ones((2, 400)), "signature is 800 factors: give one for each of the 400 transducers"),
        (np.full(400, 2.0), "signature[0, 0] is 2+0i: give factors of modulus 1"),
        (np.full(400, np.nan), "signature[0, 0] is"),
        (3, "signature is"),
    ]:
        with pytest.raises(midair.SceneError) as refusal:
            scene.replace(signature=signature)
        assert reported in str(refusal.value)
        assert "\n" not in str(refusal.value)
    with pytest.raises(midair.SceneError, match="signature is a list of factors: files know"):
        scene.replace(signature=np.ones(400)).save(tmp_path / "scene.toml")
    with pytest.raises(midair.SceneError, match="signature is given: multiply the matrix"):
        midair.Solver(midair.Propagation(np.ones((1, 4))), signature="trap")
    with pytest.raises(midair.SceneError, match="points is 5000 of them: with a signature G is kept"):
        midair.solve(midair.Scene(array, np.tile([0, 0, 0.1], (5000, 1)), signature="trap"))
    with pytest.raises(midair.SceneError, match=r"points\[0\] is .* m from transducer 0"):
        midair.solve(midair.Scene(array, array.positions[:1], signature="trap"))
    drive = np.ones(400)
    for keywords, reported in [
        ({"bead": {"radius": 0}}, "bead.radius is 0.0: give a number above 0"),
        ({"bead": {"density": np.inf}}, "bead.density is inf"),
        ({"bead": {"sound_speed": -1}}, "bead.sound_speed is -1.0"),
        ({"points": [[0, 0, np.nan]]}, r"points[0] is"),
        ({"points": array.positions[7:8]}, "from transducer 7"),
    ]:
        with pytest.raises(midair.SceneError) as refusal:
            midair.gorkov(scene, drive, **keywords)
        assert reported in str(refusal.value)
        assert "\n" not in str(refusal.value)
    with pytest.warns(midair.SceneWarning, match="bead.radius is 0.002 m: the force has waves up to the quadrupole"):
        midair.rest(scene, drive, bead={"radius": 2e-3})
    edge = midair.Array([[0, 0, 0]], directivity={"cos": 0.5})
    with pytest.raises(midair.SceneError, match="move it off the plane"):
        midair.gorkov(midair.Scene(edge, points), [1], [[0.1, 0, 0]])


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("count", range(1, 9))
def test_facing_boards_trap_in_all_three_axes(board: str, count: int) -> None:
    made, box, apart = BOARDS[board]
    array = midair.Array(*made(), directivity={"piston": 4.5e-3})
    for seed in range(4):
        points = scattered(count, box, apart, seed)
        scene = midair.Scene(array, points, signature="trap")
        found = midair.gorkov(scene, midair.solve(scene))
        assert (found.stiffness > 0).all(), found.stiffness
        # 72 transducers have few degrees of freedom left for the lateral stiffness of eight points.
        assert board == "tinylev" or (np.linalg.eigvalsh(found.hessian) > 0).all(), found.hessian


@pytest.mark.filterwarnings("ignore:traps hold:midair.SceneWarning")
def test_twin_and_vortex_fail_for_several_points_between_two_boards() -> None:
    """Checks that both keep a single bead but lose some of eight in most scenes,
    where standing waves keep all.
    """
    array = midair.Array(*traps.openmpd())
    for name, points in [("twin", 1), ("vortex", 1)]:
        scene = midair.Scene(array, np.zeros((points, 3)), signature=name)
        assert (least(scene, midair.solve(scene)) > 0).all()
    lost = {"trap": 0, "twin": 0, "vortex": 0}
    for name in lost:
        for seed in range(8):
            points = scattered(8, [0.05, 0.05, 0.02], 0.02, seed)
            scene = midair.Scene(array, points, signature=name)
            lost[name] += (least(scene, midair.solve(scene)) <= 0).any()
    assert lost["trap"] == 0
    assert lost["twin"] >= 4
    assert lost["vortex"] >= 4


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 4, 8])
def test_the_weakest_trap_is_nearly_what_direct_optimisation_finds(count: int) -> None:
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals)
    for seed in range(3):
        points = scattered(count, [0.05, 0.05, 0.02], 0.02, seed)
        scene = midair.Scene(array, points, signature="trap")
        drives = [midair.solve(scene), midair.solve(scene, "best")]
        starts = [
            np.angle(drives[0].drive),
            np.random.default_rng(seed).uniform(0, 2 * np.pi, len(positions)),
        ]
        best = least(scene, traps.direct(positions, points, starts)).min()
        for drive in drives:
            part = least(scene, drive).min() / best
            assert 0.9 <= part <= 1.02, "above 1, direct optimisation did not get to its end"


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 4, 8])
@pytest.mark.parametrize("quantization", [None, {}, {"phases": 16}], ids=["board", "free", "16"])
def test_beads_of_traps_rest_at_their_points(quantization: Any, count: int) -> None:
    given = {} if quantization is None else {"quantization": quantization}
    boards = midair.Array.preset("openmpd_pair", **given)
    for seed in range(20, 24):
        points = scattered(count, *BOARDS["openmpd"][1:], seed)
        solution = midair.solve(midair.Scene(boards, points, signature="trap"))
        rest = solution.rest()
        assert rest.held.all()
        # With 16 phases, eight beads rest slightly farther away.
        most = 1e-4 if quantization == {"phases": 16} else 5e-5
        assert np.linalg.norm(rest.place - points, axis=1).max() < most


@pytest.mark.parametrize("board", BOARDS)
def test_traps_of_which_nothing_is_requested_are_stiffer_than_equal_foci(board: str) -> None:
    """Compares the stiffness along the softest direction of each point, for ten phases, too."""
    made, box, apart = BOARDS[board]
    for quantization in ({}, {"phases": 10}):
        array = midair.Array(*made(), quantization=quantization)
        for seed in range(4):
            scene = midair.Scene(array, scattered(4, box, apart, seed), signature="trap")
            solutions = [midair.solve(scene), midair.solve(scene, pressures=1000.0, aim="max")]
            softest = [np.linalg.eigvalsh(midair.gorkov(scene, one).hessian).min() for one in solutions]
            assert softest[0] > softest[1]
            assert solutions[0].status == "done"
            assert solutions[0].metrics.uniformity < solutions[1].metrics.uniformity


@pytest.mark.parametrize("last", [10, 20, 35])
def test_a_stop_keeps_the_traps_that_there_are(last: int) -> None:
    array = midair.Array(*traps.openmpd())
    scene = midair.Scene(array, scattered(4, [0.05, 0.05, 0.02], 0.02, 1), signature="trap")
    foci = least(scene, midair.solve(scene, pressures=1000.0, aim="max")).min()
    calls = []

    def progress(step: int, *_: object) -> bool:
        calls.append(step)
        return len(calls) < last

    stopped = midair.solve(scene, progress=progress)
    assert (stopped.status, len(calls)) == ("stopped", last)
    whole = least(scene, midair.solve(scene)).min()
    assert 0.99 * foci < least(scene, stopped).min() <= whole * 1.01


@pytest.mark.slow
def test_foci_that_are_requested_are_not_made_others() -> None:
    array = midair.Array(*traps.openmpd())
    points = scattered(3, [0.05, 0.05, 0.02], 0.02, 1)
    scene = midair.Scene(array, points, signature="trap")
    requested = midair.solve(scene, pressures=[2000.0, 3000.0, 1000.0])
    np.testing.assert_allclose(abs(requested.pressures), [2000, 3000, 1000], rtol=1e-3)
    started = midair.solve(scene, start=requested)
    np.testing.assert_allclose(abs(started.pressures), abs(started.pressures).mean(), rtol=1e-3)


@pytest.mark.slow
def test_beads_of_traps_beside_a_sphere_rest_at_their_points() -> None:
    points = np.array([[0.012, 0, 0.004], [-0.015, 0.01, 0]])
    ball = midair.Sphere([0, 0.03, 0], 0.006)
    scene = midair.Scene(midair.Array(*traps.openmpd()), points, signature="trap", obstacles=[ball])
    solution, foci = midair.solve(scene), midair.solve(scene, pressures=1000, aim="max")
    rest = solution.rest()
    assert rest.held.all()
    assert abs(rest.place - points).max() < 5e-5
    assert least(scene, solution).min() > 1.02 * least(scene, foci).min()


#: A SonicSurface below a plate; least restoring accelerations in m/s^2 of a bead at rest in a trap and in a focus.
SURFACE = midair.Array.preset("sonicsurface")


def firmness(point: list[float], height: float) -> tuple[float, ...]:
    """Returns both accelerations, and the distances in m of both beads from their point."""
    scene = midair.Scene(SURFACE, [point], obstacles=[midair.Wall([0, 0, height], [0, 0, -1])])
    trap, focus = (midair.rest(scene, midair.solve(scene.replace(signature=name))) for name in ("trap", None))
    assert trap.held.all()
    least = [rest.acceleration.min() for rest in (trap, focus)]
    return *least, *[np.linalg.norm(rest.place[0] - point) for rest in (trap, focus)]


@pytest.mark.slow
def test_before_a_reflector_a_trap_holds_as_well_as_a_focus() -> None:
    quarter = SURFACE.medium["sound_speed"] / SURFACE.medium["frequency"] / 4
    nodes = [firmness([0, 0, height - odd * quarter], height) for height in (0.06, 0.1, 0.15) for odd in (1, 3, 5)]
    part = np.array([trap / focus for trap, focus, *_ in nodes])
    # Two of the foci hold their beads more firmly, but 1.5 mm from the points.
    assert part.min() > 0.6
    assert np.sort(part)[2] > 1.04
    assert np.median(part) > 1.05
    rng = np.random.default_rng(3)
    places = [
        ([*rng.uniform(-0.03, 0.03, 2), rng.uniform(0.03, height - 0.003)], height)
        for height in (0.06, 0.1, 0.15)
        for _ in range(8)
    ]
    found = np.array([firmness(*place) for place in places])
    part = found[:, 0] / found[:, 1]
    for trap, focus, _, apart in [*nodes, *found]:
        assert not apart <= quarter / 2 or trap > 1.02 * focus, "a focus that holds its bead at the point"
    assert part.min() > 0.6
    assert np.median(part) > 1.02
    assert found[:, 2].max() < 1.2e-3
    assert np.median(found[:, 2]) < 0.3e-3


def test_before_a_reflector_pictures_are_drawn_and_without_it_the_trap_is_a_vortex() -> None:
    point = [0, 0, 0.0958]
    bare = midair.Scene(SURFACE, [point], signature="trap")
    assert np.array_equal(bare.propagation(), bare.replace(signature="vortex").propagation())
    # A wall beside the board is no second side.
    beside = bare.replace(obstacles=[midair.Wall([0.1, 0, 0], [-1, 0, 0])])
    assert np.array_equal(beside.propagation(), beside.replace(signature="vortex").propagation())
    above = bare.replace(obstacles=[midair.Wall([0, 0, 0.1], [0, 0, -1])])
    direct, whole = bare.replace(signature=None).propagation(), above.replace(signature=None).propagation()
    factors = above.propagation() / whole
    wanted = (2 * direct - whole) / whole
    np.testing.assert_allclose(factors, wanted / abs(wanted), rtol=1e-4)
    assert midair.solve(above).plot()


#: Four points beside the axis of a TinyLev.
FOUR = [[0.01, 0, 0], [-0.01, 0, 0], [0, 0.01, 0], [0, -0.01, 0]]


@pytest.mark.filterwarnings("always::midair.SceneWarning")
@pytest.mark.parametrize(("channels", "kept"), [({}, 0), ({"channels": range(72)}, 4)])
def test_a_solve_warns_of_beads_that_fall(channels: dict[str, Any], kept: int) -> None:
    scene = midair.Scene(midair.Array.preset("tinylev", **channels), FOUR, signature="trap")
    solver = midair.Solver(scene)
    for call in (lambda: midair.solve(scene), lambda: solver(FOUR)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            solution = call()
        assert solution.beads == (kept, 4)
        assert solution.rest().held.sum() == kept
        fallen = [warning.message for warning in caught if getattr(warning.message, "code", "") == "fallen"]
        assert [str(each).partition(":")[0] for each in fallen] == ["traps hold 0 of 4 beads"] * (kept == 0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # A session says it once; a batch does not look.
        solver(FOUR)
        midair.solve_batch(scene.array, [FOUR], signature="trap")


def test_beads_are_those_of_named_traps() -> None:
    boards = midair.Array.preset("openmpd_pair", quantization={})
    points = [[-0.02, 0, 0], [0.02, 0, 0]]
    assert midair.solve(midair.Scene(boards, points)).beads is None
    mixed = midair.Scene(boards, points, pressures=[0, 1000], signature=["trap", None])
    assert midair.solve(mixed).beads == (1, 1)
    quiet = midair.Scene(boards, points, pressures=[2000, 0], signature="trap")
    assert midair.solve(quiet).beads == (1, 1)
    given = midair.Scene(boards, points, signature=np.ones(len(boards)))
    assert midair.solve(given).beads is None
