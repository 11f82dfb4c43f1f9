"""Complex targets (pressures with phases):
the solver that is optimal for them, and what other solvers report.
"""

import pickle
import warnings
from pathlib import Path

import clarabel
import numpy as np
import pytest
import scipy.sparse
from numpy.typing import NDArray

import midair
import oracle
from midair import compare

Complex = NDArray[np.complex128]

ARRAY = midair.Array.preset("paper20", source_pressure=4.386)
POINTS = np.array([[-0.02, 0, 0.15], [0.02, 0, 0.15], [0, 0.03, 0.15]])
PRESSURES = np.array([4500j, -3500, 2500 + 2500j])


def least_error(G: Complex, p: Complex, weights: NDArray[np.float64]) -> float:
    """Returns the least value of norm(W^(1/2) (G q - p)) / norm(W^(1/2) p) over all drives with |q_i| <= 1.

    W is the diagonal matrix of the weights. The solution is by a second-order cone program.
    """
    root = np.sqrt(weights)
    scale = np.linalg.norm(root * p)
    A, b = root[:, None] * G / scale, root * p / scale
    M, N = G.shape
    field = np.block([[A.real, -A.imag], [A.imag, A.real]])
    first = np.zeros((2 * M + 1, 1 + 2 * N))
    first[0, 0] = -1
    first[1:, 1:] = field
    # One cone (1, Re q_i, Im q_i) for each transducer.
    disks = np.zeros((3 * N, 1 + 2 * N))
    disks[1::3, 1 : 1 + N] = -np.eye(N)
    disks[2::3, 1 + N :] = -np.eye(N)
    sides = np.concatenate([[0], b.real, b.imag, np.tile([1.0, 0, 0], N)])
    cones = [clarabel.SecondOrderConeT(2 * M + 1), *[clarabel.SecondOrderConeT(3)] * N]
    cost = np.zeros(1 + 2 * N)
    cost[0] = 1
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    matrix = scipy.sparse.csc_matrix(np.concatenate([first, disks]))
    quadratic = scipy.sparse.csc_matrix((1 + 2 * N, 1 + 2 * N))
    found = clarabel.DefaultSolver(quadratic, cost, matrix, sides, cones, settings).solve()
    assert "Solved" in str(found.status)
    return float(found.obj_val)


def error(G: Complex, drive: NDArray[np.complex64], p: Complex, weights: NDArray[np.float64]) -> float:
    """Returns the weighted relative error of a drive's complex pressures."""
    root = np.sqrt(weights)
    return float(np.linalg.norm(root * (G @ drive.astype(complex) - p)) / np.linalg.norm(root * p))


def laid(kind: str, count: int, seed: int) -> NDArray[np.float64]:
    """Returns points (M, 3): random in a plane or volume, or on a grid of a third of a wavelength."""
    random = np.random.default_rng(seed)
    if kind == "dense":
        side = int(np.ceil(np.sqrt(count)))
        x, y = np.meshgrid(*[0.0028 * (np.arange(side) - (side - 1) / 2)] * 2)
        return np.stack([x.ravel(), y.ravel(), np.full(side * side, 0.15)], axis=-1)[:count]
    points = random.uniform([-0.05, -0.05, 0.1], [0.05, 0.05, 0.2], (count, 3))
    return points if kind == "volume" else points * [1, 1, 0] + [0, 0, 0.15]


@pytest.mark.slow
@pytest.mark.parametrize("count", [8, 32, 128])
@pytest.mark.parametrize("kind", ["plane", "volume", "dense"])
def test_bounded_comes_within_a_hundredth_of_the_least_error(kind: str, count: int) -> None:
    array = midair.Array.grid(14, 14, 0.01)
    random = np.random.default_rng(count)
    for seed, level in [(1, 0.7), (2, 1.2)]:
        points = laid(kind, count, seed)
        # On a grid the phases rise linearly, as in a wave; elsewhere they are random.
        ramp, free = 2 * np.pi * points[:, 0] / 0.03, random.uniform(0, 2 * np.pi, count)
        phases = ramp if kind == "dense" else free
        moduli = level * midair.Scene(array, points).reach().level * random.uniform(0.5, 1, count)
        p, weights = moduli * np.exp(1j * phases), random.uniform(0.2, 2, count)
        scene = midair.Scene(array, points, p, weights=weights)
        solution = midair.solve(scene, "bounded")
        # The least error is above 1 % in nearly all scenes.
        assert solution.status in {"done", "missed"}
        assert solution.steps <= 30
        G = oracle.propagation(array.positions, points)
        found, least = error(G, solution.drive, p, weights), least_error(G, p, weights)
        # Errors below 1e-4 of the targets count as exact.
        assert found <= 1.01 * least + 1e-4, f"{kind}, {count} points: {found} for {least}"
        assert found >= 0.999 * least - 1e-5
        assert solution.complex_error == pytest.approx(found, rel=1e-3, abs=1e-5)
        assert np.abs(solution.drive).max() <= 1 + 1e-6


def test_what_can_be_had_is_had_with_its_phases() -> None:
    scene = midair.Scene(ARRAY, POINTS, PRESSURES)
    solution = midair.solve(scene, "bounded")
    assert solution.status == "done"
    np.testing.assert_allclose(solution.pressures, PRESSURES, atol=0.5)
    assert solution.complex_error < 1e-4
    assert solution.metrics.accuracy == pytest.approx(1, abs=1e-4)
    # Rounding to the board's phases causes an error of up to some thousandths.
    board = midair.solve(scene, "bounded", quantization={"phases": 256})
    assert 1e-5 < board.complex_error < 0.02


def test_weak_targets_are_met_without_balancing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = midair.solve(midair.Scene(ARRAY, POINTS, 1e-6 * PRESSURES), "bounded")
    assert solution.complex_error < 1e-4


def test_without_phases_bounded_takes_those_of_the_start_and_else_none() -> None:
    scene = midair.Scene(ARRAY, POINTS, np.abs(PRESSURES))
    plain = midair.solve(scene, "bounded")
    assert plain.complex_error is None
    np.testing.assert_allclose(plain.pressures, np.abs(PRESSURES), atol=0.5)
    turned = midair.solve(scene, "bounded", start=np.angle(PRESSURES))
    np.testing.assert_allclose(turned.pressures, PRESSURES, atol=0.5)
    # `start` does not change given phases.
    given = midair.solve(scene.replace(pressures=PRESSURES), "bounded", start=[0.0, 1.0, 2.0])
    np.testing.assert_allclose(given.pressures, PRESSURES, atol=0.5)


def test_a_scene_keeps_complex_pressures(tmp_path: Path) -> None:
    scene = midair.Scene(ARRAY, POINTS, PRESSURES, weights=[1, 2, 3])
    assert scene.pressures.dtype == np.complex128
    np.testing.assert_allclose(scene.pressures, PRESSURES, rtol=1e-15, atol=1e-12)
    real = scene.replace(pressures=np.abs(PRESSURES))
    assert real.pressures.dtype == np.float64
    assert real != scene != scene.replace(pressures=PRESSURES.conj())
    assert hash(scene) == hash(scene.replace(pressures=PRESSURES))
    assert "3 points" in repr(scene)
    assert "2500+2500j" in scene._repr_html_()
    for path in (tmp_path / "scene.toml", tmp_path / "scene.json"):
        scene.save(path)
        assert midair.Scene.load(path) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    # Parts that are not replaced stay the same, also the phases of the pressures.
    assert scene.replace(weights=None).replace(weights=[1, 2, 3]) == scene
    assert scene.replace(pressures=None).pressures is None
    with pytest.raises(midair.SceneError, match="pressures is kept from 3 points"):
        scene.replace(points=POINTS[:2])
    # One number applies to all points; a list of Python's own numbers is accepted, too.
    alike = midair.Scene(ARRAY, POINTS, 300j)
    np.testing.assert_allclose(alike.pressures, [300j] * 3, atol=1e-12)
    assert midair.Scene(ARRAY, POINTS, [4500j, -3500, 2500 + 2500j]) == scene.replace(weights=None)
    # A complex type has phases even if all imaginary parts are 0; a real type has none.
    assert midair.Scene(ARRAY, POINTS, [1 + 0j, 2, 3]).pressures.dtype == np.complex128
    assert midair.Scene(ARRAY, POINTS, np.array([1, 2, 3])).pressures.dtype == np.float64


def test_a_scene_file_has_phases() -> None:
    text = """
    array = { preset = "paper20", source_pressure = 4.386 }
    points = [{ position = [0.0, 0.0, 0.15], pressure = 500.0, phase = 1.5707963267948966 },
              { position = [0.02, 0.0, 0.15], pressure = 300.0 }]
    """
    np.testing.assert_allclose(midair.Scene.parse(text).pressures, [500j, 300], atol=1e-12)
    for wrong, reported in [
        ("phase = inf", r"points\[0\].phase is inf: give finite numbers"),
        ("phase = true", r"points\[0\].phase"),
    ]:
        with pytest.raises(midair.SceneError, match=reported):
            midair.Scene.parse(text.replace("phase = 1.5707963267948966", wrong))
    without = text.replace("pressure = 500.0, ", "").replace(", pressure = 300.0", "")
    with pytest.raises(midair.SceneError, match=r"points\[0\].phase is given without a pressure"):
        midair.Scene.parse(without)


def test_bad_complex_pressures_are_refused() -> None:
    for wrong, reported in [
        ([np.nan, 1j, 1], r"points\[0\].pressure"),
        ([1j, 1, complex(0, np.inf)], r"points\[2\].pressure"),
        ([1j, 1], "pressures is of shape"),
        ([0j, 0, 0], "all 0"),
        ("loud", "pressures is 'loud': give one real or complex number"),
        ([True, 1j, 1], "pressures"),
    ]:
        with pytest.raises(midair.SceneError, match=reported):
            midair.Scene(ARRAY, POINTS, wrong)
    with pytest.raises(midair.SceneError, match="weights"):
        midair.Scene(ARRAY, POINTS, 1.0, weights=[1j, 1, 1])


def test_every_door_takes_them_and_gives_the_same_answer(tmp_path: Path) -> None:
    scene = midair.Scene(ARRAY, POINTS, PRESSURES)
    solution = midair.solve(scene, "bounded")
    assert midair.solve(midair.Scene(ARRAY, POINTS), "bounded", pressures=PRESSURES) == solution
    solver = midair.Solver(ARRAY, "bounded")
    assert solver(POINTS, PRESSURES) == solution
    drive = np.empty(400, np.complex64)
    solver(POINTS, PRESSURES, out=drive)
    assert solver.complex_error == solution.complex_error
    np.testing.assert_array_equal(drive, solution.drive)
    # Phases apply to one call only.
    assert solver(POINTS, np.abs(PRESSURES)).complex_error is None
    batch = midair.solve_batch(ARRAY, np.stack([POINTS, POINTS]), [PRESSURES, PRESSURES.conj()], "bounded")
    assert batch[0] == solution
    np.testing.assert_allclose(batch.pressures[1], PRESSURES.conj(), atol=0.5)
    assert pickle.loads(pickle.dumps(batch)) == batch
    assert pickle.loads(pickle.dumps(batch))[1] == batch[1]
    matrix = midair.Propagation(scene.propagation())
    own = midair.solve(matrix, "bounded", pressures=PRESSURES)
    np.testing.assert_allclose(own.pressures, PRESSURES, atol=0.5)
    assert pickle.loads(pickle.dumps(own)) == own
    assert midair.solve_batch(matrix, None, [PRESSURES], "bounded")[0] == own
    assert pickle.loads(pickle.dumps(solution)) == solution
    assert solution.scene == scene
    for name in ("solution.npz", "solution.json"):
        solution.save(tmp_path / name)
        assert midair.Solution.load(tmp_path / name) == solution


def test_a_function_is_given_complex_targets() -> None:
    def inverse(propagation: Complex, targets: Complex, weights: object) -> Complex:
        assert targets.dtype == np.complex128
        drive = np.linalg.pinv(propagation) @ targets
        return drive / np.maximum(1, np.abs(drive))

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = midair.solve(midair.Scene(ARRAY, POINTS, PRESSURES), inverse)
    assert solution.complex_error < 0.05


USERS = sorted(name for name, info in midair.solvers().items() if info.uses_phases)


def test_every_solver_says_whether_it_uses_phases() -> None:
    assert USERS == ["bounded", "naive", "tikhonov"]
    scene = midair.Scene(ARRAY, POINTS, PRESSURES)
    for name in midair.solvers():
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            solution = midair.solve(scene, name)
            free = midair.solve(scene.replace(pressures=np.abs(PRESSURES)), name)
        reported = [str(warning.message) for warning in caught if "phases" in str(warning.message)]
        assert solution.complex_error is not None
        if name in USERS:
            assert reported == []
            assert solution.complex_error < 0.4
        else:
            assert len(reported) == 1
            assert "these use them: bounded, tikhonov, naive" in reported[0]
            # The drive is the same as without phases: they only cause the warning.
            np.testing.assert_array_equal(solution.drive, free.drive)


def test_sessions_tell_of_unused_phases_once() -> None:
    solver = midair.Solver(ARRAY, "fast")
    with pytest.warns(midair.SceneWarning, match="phases of the pressures are not used"):
        solver(POINTS, PRESSURES)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solver(POINTS, PRESSURES)
    with pytest.warns(
        midair.SceneWarning, match="in 2 of 2 problems, worst in .*: the phases of the pressures are not used"
    ):
        midair.solve_batch(ARRAY, np.stack([POINTS, POINTS]), PRESSURES, "fast")


def test_tikhonov_and_naive_take_given_phases() -> None:
    scene = midair.Scene(ARRAY, POINTS, PRESSURES, weights=[1, 2, 0.5])
    G, weights = oracle.propagation(ARRAY.positions, POINTS), np.array([0.5, 1, 0.25])
    rows, p = np.sqrt(weights)[:, None] * G, np.sqrt(weights) * PRESSURES
    H = rows @ rows.conj().T
    wanted = rows.conj().T @ np.linalg.solve(H + 0.07 * np.trace(H).real / 3 * np.eye(3), p)
    wanted /= np.maximum(1, np.abs(wanted))
    np.testing.assert_allclose(midair.solve(scene, "tikhonov").drive, wanted, atol=1e-3)
    foci = G.conj().T @ (PRESSURES / np.sum(np.abs(G) ** 2, axis=1))
    foci /= np.maximum(1, np.abs(foci))
    np.testing.assert_allclose(midair.solve(scene, "naive").drive, foci, atol=1e-3)


def test_a_comparison_has_a_column_of_complex_errors() -> None:
    table = compare(midair.Scene(ARRAY, POINTS, PRESSURES), ["bounded", "tikhonov"])
    errors = table.to_dict()["complex_error"]
    assert errors == [solution.complex_error for solution in table]
    assert errors[0] < 1e-4 < errors[1]
    assert "complex error" in repr(table)
    assert "complex_error" not in compare(midair.Scene(ARRAY, POINTS, 4000.0), ["naive"]).to_dict()
