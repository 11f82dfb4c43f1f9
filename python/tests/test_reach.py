"""Reach and bound: the pressures an array can reach, warnings beyond them,
and the bound against a conic solver.
"""

from pathlib import Path

import clarabel
import numpy as np
import pytest
import scipy.sparse

import midair
from midair import _cli as cli
from scenes import POINTS, exact, small


def relaxation(G: np.ndarray, targets: np.ndarray) -> float:
    """Returns the bound by a conic solver: the square root of the least sum of d_i over all d and w
    with diag(d) >= sum_m w_m a_m a_m^H, sum w = 1 and w >= 0.

    a_m is the conjugate of row m of G, divided by the target of point m.
    """
    M, N = G.shape
    columns, rows = np.tril_indices(2 * N)  # the upper triangle, column by column
    scale = np.where(rows == columns, 1, np.sqrt(2))

    def packed(matrix: np.ndarray) -> np.ndarray:
        real = np.block([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]])
        return scale * real[rows, columns]

    shares = [packed(np.diag(row)) for row in np.eye(N)]
    points = [packed(np.outer(row.conj(), row)) for row in G / targets[:, None]]
    slack = np.column_stack([*shares, *(-point for point in points)])
    total = np.concatenate([np.zeros(N), np.ones(M)])
    positive = np.hstack([np.zeros((M, N)), np.eye(M)])
    A = scipy.sparse.csc_matrix(np.vstack([total, -positive, -slack]))
    b = np.concatenate([[1], np.zeros(M), np.zeros(len(slack))])
    cones = [clarabel.ZeroConeT(1), clarabel.NonnegativeConeT(M), clarabel.PSDTriangleConeT(2 * N)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cost = np.concatenate([np.ones(N), np.zeros(M)])
    empty = scipy.sparse.csc_matrix((N + M, N + M))
    answer = clarabel.DefaultSolver(empty, cost, A, b, cones, settings).solve()
    # Each eigenvalue occurs twice, which limits the solver's accuracy.
    assert str(answer.status) in {"Solved", "AlmostSolved"}
    return float(np.sqrt(answer.obj_val))


@pytest.mark.parametrize("seed", range(6))
def test_bound_is_the_value_of_the_relaxation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    M = int(rng.integers(6, 9))
    G = rng.normal(size=(M, 8)) + 1j * rng.normal(size=(M, 8))
    targets = rng.uniform(0.5, 2, M)
    best = relaxation(G, targets)
    found = midair.bound(midair.Propagation(G), pressures=targets)
    # The bound is not below the optimum, up to the conic solver's accuracy, and at most half a per cent
    # above.
    assert best * (1 - 1e-5) < found < best * 1.005


@pytest.mark.slow
def test_bound_of_few_points_is_below_the_relaxation_and_reached() -> None:
    scene = midair.Scene(midair.Array.grid(5, 4, 10e-3), POINTS[:3], [300, 200, 250])
    best = midair.judge(scene, midair.solve(scene, "best", aim="max"), precision="double")
    bound = midair.bound(scene)
    assert bound < relaxation(exact(scene), scene.pressures) * (1 + 1e-5)
    assert bound * (1 - 2e-4) < best.level * best.uniformity < bound * (1 + 1e-6)


def test_bound_of_many_points_is_above_the_best_field() -> None:
    points = np.random.default_rng(1).uniform(0.05, 0.15, (65, 3))
    scene = midair.Scene(midair.Array.grid(8, 8, 10e-3), points)
    best = midair.judge(scene, midair.solve(scene, "uniform", aim="max"), precision="double")
    assert best.level * best.uniformity < midair.bound(scene) < 3 * best.level


def test_reach_is_the_sum_of_the_moduli_and_the_balanced_level() -> None:
    scene = small(pressures=[100, 200, 0, 50])
    reach = scene.reach()
    np.testing.assert_allclose(reach.alone, np.abs(exact(scene)).sum(axis=1), rtol=1e-12)
    # The level is computed from the rows of G in f32.
    assert np.sum((reach.level / reach.alone) ** 2) == pytest.approx(1, abs=1e-4)
    np.testing.assert_allclose(reach.level / reach.level[0], [1, 2, 0, 0.5], rtol=1e-12)
    left_out = small()
    np.testing.assert_allclose(left_out.reach().level, midair.solve(left_out, "naive").targets, rtol=1e-12)
    assert "Pa alone" in repr(reach)


def test_a_request_beyond_reach_is_warned_of_and_answered() -> None:
    alone = small().reach().alone
    pressures = [100, 1.2 * alone[1], 100, 100]
    with pytest.warns(midair.SceneWarning, match=r"points\[1\].pressure is .* Pa, beyond reach") as caught:
        solution = midair.solve(small(pressures=pressures), "wgs")
    assert len(caught) == 1
    assert solution.status == "missed"
    with pytest.warns(midair.SceneWarning, match="no drive gives more than 0.6"):
        midair.solve(small(pressures=0.8 * alone), "greedy")


def test_requests_near_the_balanced_level_are_nobodys_mistake() -> None:
    for part in (0.6, 1.0, 1.15):
        midair.solve(small(pressures=part * small().reach().level), "naive")


def test_compare_shows_how_far_the_best_is_from_the_bound(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = small(pressures=[300, 200, 0, 250], weights=[1, 1, 1, 0])
    path = tmp_path / "scene.toml"
    scene.save(path)
    with pytest.raises(SystemExit) as left:
        cli.main(["compare", str(path), "--solvers", "naive,wgs", "--balance"])
    out, _ = capsys.readouterr()
    assert left.value.code == 0
    pressures = midair.solve(scene, "wgs", balance=True).pressures
    weakest = np.min(np.abs(pressures[:2]) / [300, 200])
    rows = [line.split() for line in out.partition("\n solver")[2].splitlines()]
    gap = rows[0].index("gap") + 1
    assert [row[0] for row in rows[2:4]] == ["naive", "wgs"]
    assert rows[3][gap] == f"{1 - weakest / midair.bound(scene):.1%}"
    assert float(rows[2][gap].rstrip("%")) > 0
