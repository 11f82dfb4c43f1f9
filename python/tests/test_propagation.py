"""Propagation, a user's own matrix G, as an argument of `solve`, `Solver`, `solve_batch`,
`judge` and `bound`.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import midair
import oracle
from scenes import GAIN, POINTS, exact, numbers, same_bits, small

G = small().propagation()
MATRIX = midair.Propagation(G)
LEVEL = oracle.balanced_factor(exact(small()), np.ones(4))
#: Targets of three problems with the same matrix.
PRESSURES = LEVEL * np.array([[1, 1, 1, 1], [0.6, 1, 0.8, 0.9], [1.2, 0.7, 0.9, 1]])
MASK = np.ones(64, dtype=bool)
MASK[[0, 9, 63]] = False
BOARD: dict[str, Any] = {"quantization": {"phases": 16, "amplitudes": [0, 1]}, "mask": MASK}


def test_a_matrix_has_its_shape_and_may_be_of_any_layout_and_number() -> None:
    assert MATRIX.shape == (4, 64)
    assert "64 transducers at 4 points" in repr(MATRIX)
    drive = midair.solve(MATRIX, "naive").drive
    wide = np.zeros((8, 128), dtype=complex)
    wide[::2, ::2] = G
    for same in (G.astype(complex), G.tolist(), np.asfortranarray(G), wide[::2, ::2]):
        assert same_bits(midair.solve(midair.Propagation(same), "naive").drive, drive)
    ints = midair.solve(midair.Propagation(np.ones((1, 4), dtype=np.int8)), "naive", pressures=4)
    assert ints.pressures == pytest.approx([4])


NO_MATRIX = ["x", None, object(), True, [[True]], [["1"]], [[None]], [1, 2], 1.0, [], [[]], [[], []], [[[1]]]]


def one_line(call: Callable[[], object], *words: str) -> None:
    """Checks that `call` raises SceneError with a message of one line that contains these words."""
    with pytest.raises(midair.SceneError) as refused:
        call()
    assert "\n" not in str(refused.value)
    for word in words:
        assert word in str(refused.value)


@pytest.mark.parametrize("bad", NO_MATRIX, ids=lambda bad: repr(bad).partition(" at ")[0])
def test_what_is_no_matrix_of_numbers_is_refused(bad: object) -> None:
    one_line(lambda: midair.Propagation(bad), "propagation")


def test_an_entry_that_is_not_finite_is_named_by_row_and_column() -> None:
    for bad in (np.nan, np.inf, complex(0, np.nan), complex(1, -np.inf)):
        matrix = np.ones((3, 5), dtype=complex)
        matrix[2, 1] = bad
        one_line(lambda matrix=matrix: midair.Propagation(matrix), "propagation[2, 1]")


@pytest.mark.parametrize("solver", ["greedy", "gs"])
def test_every_door_gives_the_same_answer_on_the_board(solver: str) -> None:
    batch = midair.solve_batch(MATRIX, pressures=PRESSURES, solver=solver, balance=False, **BOARD)
    fixed = midair.Solver(MATRIX, solver, balance=False, **BOARD)
    out = np.empty(64, dtype=np.complex64)
    assert batch.drives.shape == (3, 64)
    for k, pressures in enumerate(PRESSURES):
        alone = midair.solve(MATRIX, solver, pressures=pressures, balance=False, **BOARD)
        assert (alone.drive[~MASK] == 0).all()
        played = alone.drive[MASK]
        # The drive is rounded only once, to f32. `turns` counts in steps of the 16 phases.
        turns = np.angle(played) / (2 * np.pi) * 16
        assert np.abs(turns - np.round(turns)).max() < 1e-5
        assert np.abs(np.abs(played) - np.round(np.abs(played))).max() < 1e-6
        assert alone.metrics.accuracy > 0.7
        for drive in (
            batch.drives[k],
            fixed(pressures=pressures).drive,
            fixed(pressures=pressures, out=out).drive,
        ):
            assert same_bits(drive, alone.drive)
        assert same_bits(batch.pressures[k], alone.pressures)
        assert (fixed.metrics, batch.metrics.sigma[k]) == (alone.metrics, alone.metrics.sigma)
        judged = midair.judge(MATRIX, alone.drive, pressures=pressures, mask=MASK, precision="double")
        expected = oracle.metrics(np.abs(G.astype(complex) @ alone.drive), pressures)
        assert numbers(judged) == pytest.approx(expected, rel=1e-9)
        most = midair.bound(MATRIX, pressures=pressures, mask=MASK)
        assert np.min(np.abs(alone.pressures) / pressures) <= most * (1 + 1e-6)


def test_a_mask_makes_columns_zero() -> None:
    masked, given = midair.Propagation(G * MASK), {"pressures": PRESSURES[0]}
    exact = {**given, "precision": "double"}
    assert midair.judge(MATRIX, np.ones(64), mask=MASK, **exact) == midair.judge(masked, MASK * 1.0, **exact)
    assert midair.bound(MATRIX, mask=MASK, **given) == midair.bound(masked, **given)
    assert midair.bound(MATRIX, mask=MASK, **given) < midair.bound(MATRIX, **given)


def test_pressures_left_out_are_the_balanced_level() -> None:
    assert midair.solve(MATRIX).targets == pytest.approx(np.full(4, LEVEL), rel=1e-4)
    assert midair.Solver(MATRIX)().targets == pytest.approx(np.full(4, LEVEL), rel=1e-4)


def test_weights_go_through_every_door() -> None:
    weights = [1, 1, 0, 1]
    requested = {"pressures": PRESSURES[1], "weights": weights}
    alone = midair.solve(MATRIX, "fast", **requested)
    rows = np.flatnonzero(weights)
    fewer = midair.solve(midair.Propagation(G[rows]), "fast", pressures=PRESSURES[1][rows])
    # A matrix is scaled by its mean modulus, which includes points of weight 0: the rounding differs.
    assert alone.pressures[rows] == pytest.approx(fewer.pressures, rel=1e-5)
    assert same_bits(midair.Solver(MATRIX, "fast")(**requested).drive, alone.drive)
    batch = midair.solve_batch(MATRIX, None, PRESSURES[1:2], "fast", weights=[weights])
    assert same_bits(batch.drives[0], alone.drive)


def test_columns_need_positions_and_follow_them() -> None:
    positions = midair.Array.grid(8, 8, pitch=0.01).positions
    requested = {"order": "columns", "positions": positions}
    alone = midair.solve(MATRIX, "greedy", pressures=PRESSURES[0], **requested)
    order = np.arange(64).reshape(8, 8).T.ravel()
    by_hand = midair.solve(MATRIX, "greedy", pressures=PRESSURES[0], order=order)
    assert same_bits(alone.drive, by_hand.drive)
    assert same_bits(midair.Solver(MATRIX, "greedy", **requested)(pressures=PRESSURES[0]).drive, alone.drive)
    batch = midair.solve_batch(MATRIX, pressures=PRESSURES[:1], solver="greedy", **requested)
    assert same_bits(batch.drives[0], alone.drive)
    one_line(lambda: midair.solve(MATRIX, "greedy", order="columns"), "order", "columns")


@pytest.mark.parametrize("solver", ["greedy", "wgs", "naive"])
def test_the_matrix_of_a_scene_gets_the_answer_of_the_scene(solver: str) -> None:
    options = {"order": "columns"} if solver == "greedy" else {}
    for pressures in PRESSURES:
        scene = small(pressures=pressures)
        known = midair.solve(scene, solver, balance=False, **options)
        given = {"pressures": pressures, "positions": scene.array.positions}
        found = midair.solve(MATRIX, solver, balance=False, **given, **options)
        assert numbers(found.metrics) == pytest.approx(numbers(known.metrics), abs=1e-3)
        # A matrix has no medium: the radiation is that of default air.
        p_abs = np.abs(found.pressures.astype(complex))
        assert found.radiation == pytest.approx(p_abs**2 / (1.223 * 340**2), rel=1e-12)
        bound = GAIN * np.abs(G).sum(axis=1)
        assert (np.abs(found.pressures - exact(scene) @ found.drive) <= bound).all()


def test_greedy_takes_the_best_candidate_at_every_step() -> None:
    rng = np.random.default_rng(9)
    matrix = rng.normal(size=(6, 80)) + 1j * rng.normal(size=(6, 80))
    matrix[:, 11] = 0
    targets = np.full(6, oracle.balanced_factor(matrix, np.ones(6)))
    search = {"order": "rows", "amplitudes": 2}
    drive = midair.solve(midair.Propagation(matrix), "greedy", pressures=targets, **search).drive
    assert drive[11] == 0
    # The tolerance is for f32 energy differences of a few points.
    assert oracle.regrets(matrix, targets, drive, order=range(80), amplitudes=2).max() < 1e-6


REFUSED: dict[str, tuple[Callable[[], object], tuple[str, ...]]] = {
    "points of a batch": (lambda: midair.solve_batch(MATRIX, np.zeros((3, 4, 3)), PRESSURES), ("points",)),
    "points of a call": (lambda: midair.Solver(MATRIX)(POINTS, PRESSURES[0]), ("points",)),
    "pressures of one problem": (
        lambda: midair.solve_batch(MATRIX, pressures=PRESSURES[0]), ("pressures is of shape (4,)",)
    ),
    "no pressures": (lambda: midair.solve_batch(MATRIX), ("pressures",)),
    "a mask of another length": (lambda: midair.solve(MATRIX, mask=[True] * 63), ("mask is 63 values", "64")),
    "a mask of another length, judged": (
        lambda: midair.judge(MATRIX, np.ones(64), pressures=1, mask=[True] * 63), ("mask is 63 values", "64")
    ),
    "a mask of another length, bound": (lambda: midair.bound(MATRIX, mask=[True] * 63), ("mask is 63",)),
    "a mask of numbers": (lambda: midair.Solver(MATRIX, mask=[1] * 64), ("mask is ",)),
    "a mask of no one": (lambda: midair.solve(MATRIX, mask=[False] * 64), ("points[0]", "no transducer")),
    "a quantization of one phase": (
        lambda: midair.solve(MATRIX, quantization={"phases": 1}), ("phases is 1",)
    ),
    "too few positions": (
        lambda: midair.solve(MATRIX, "greedy", order="columns", positions=np.zeros((63, 3))),
        ("positions is 63",),
    ),
    "positions of two numbers": (lambda: midair.solve(MATRIX, positions=np.zeros((64, 2))), ("positions",)),
    "positions of an array": (
        lambda: midair.Solver(small(), points=4, positions=np.zeros((64, 3))), ("positions", "Propagation")
    ),
    "the medium of a scene": (lambda: midair.Solver(MATRIX, frequency=4e4), ("frequency",)),
    "a drive of another length": (lambda: midair.judge(MATRIX, np.ones(63), pressures=1), ("drive",)),
    "points for fewer than there are": (lambda: midair.Solver(MATRIX, points=3), ("points is 3", "4 points")),
    "pressures of another length": (lambda: midair.Solver(MATRIX)(pressures=[1, 2]), ("pressures",)),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_go_with_a_matrix_is_refused_in_one_line(case: str) -> None:
    call, words = REFUSED[case]
    one_line(call, *words)


def test_positions_are_refused_beside_a_scene() -> None:
    one_line(lambda: midair.solve(small(), positions=np.zeros((64, 3))), "positions", "Scene")


def test_a_matrix_has_no_field() -> None:
    with pytest.raises(TypeError, match="Scene"):
        midair.field(MATRIX, np.ones(64))
