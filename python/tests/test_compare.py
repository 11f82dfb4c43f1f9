"""`midair.compare`: one scene solved by several solvers, as a table in text, numbers and HTML."""

import numpy as np
import pytest

import midair
from scenes import METRICS, POINTS, small


def test_a_comparison_is_what_each_solver_gives_alone() -> None:
    scene = small()
    table = midair.compare(scene, ["naive", ("greedy", {"phases": 8}), "uniform"])
    assert table.names == ("naive", "greedy", "uniform")
    assert [solution.solver for solution in table] == list(table.names)
    alone = [
        midair.solve(scene, "naive"),
        midair.solve(scene, "greedy", phases=8),
        midair.solve(scene, "uniform"),
    ]
    for name, solution in zip(table.names, alone, strict=True):
        assert np.array_equal(table[name].drive, solution.drive)
    assert table[-1] is table["uniform"]
    columns = table.to_dict()
    for metric in METRICS:
        assert columns[metric] == [getattr(solution.metrics, metric) for solution in alone]
    # The gap is the distance of the weakest point's level from the bound, which no drive exceeds.
    most = midair.bound(scene)
    weakest = [np.min(np.abs(solution.pressures) / solution.targets) for solution in alone]
    assert columns["gap"] == pytest.approx([1 - least / most for least in weakest])
    assert all(gap > 0 for gap in columns["gap"])


def test_a_comparison_prints_as_a_table() -> None:
    table = midair.compare(small(), ("greedy", {"phases": 8}))
    head, rule, row = repr(table).splitlines()
    assert head.split() == ["solver", *METRICS[:5], "gap", "limit", "steps", "time", "status"]
    assert set(rule) == {"-"}
    assert row.split()[:2] == ["greedy", f"{table[0].metrics.accuracy:.4f}"]
    assert str(table) == repr(table)
    html = table._repr_html_()
    assert html.count("<tr>") == 2
    assert all(cell in html for cell in row.split())


def test_a_solver_that_is_there_twice_is_distinguished_by_its_options() -> None:
    given = [("greedy", {"phases": 4}), ("greedy", {"phases": 8}), "naive", "naive"]
    table = midair.compare(small(), given)
    assert table.names == ("greedy, phases=4", "greedy, phases=8", "naive", "naive (2)")
    assert table["greedy, phases=8"].options["phases"] == 8
    with pytest.raises(KeyError, match="greedy, phases=4"):
        table["greedy"]


def test_left_out_solvers_are_all_there_are() -> None:
    assert midair.compare(small(points=[[0, 0, 0.1]])).names == tuple(midair.solvers())


def test_pressures_weights_and_balance_hold_for_every_solver() -> None:
    matrix = midair.Propagation(small().propagation())
    table = midair.compare(
        matrix, ["naive", "greedy"], pressures=[500, 500, 500, 0], weights=[1, 1, 0, 1], balance=True
    )
    assert all(solution.options["balance"] for solution in table)
    assert all(solution.targets.tolist() == [500, 500, 500, 0] for solution in table)
    assert "leak" in repr(table)
    weakest = np.min(np.abs(table[0].pressures[:2]) / 500)
    most = midair.bound(matrix, pressures=[500, 500, 500, 0], weights=[1, 1, 0, 1])
    assert table.gaps[0] == pytest.approx(1 - weakest / most)


@pytest.mark.slow
def test_beyond_the_points_that_a_bound_takes_there_is_no_gap() -> None:
    points = np.random.default_rng(1).uniform([-0.04, -0.04, 0.15], [0.04, 0.04, 0.15], (65, 3))
    table = midair.compare(small(points=points), "naive")
    assert (table.bound, table.gaps) == (None, None)
    assert "gap" not in table.to_dict()
    # Only points with a target and a weight above 0 count.
    assert midair.compare(small(points=points, weights=[0, *[1] * 64]), "naive").bound is not None


@pytest.mark.parametrize(
    ("solvers", "words"),
    [
        (["naive", "nave"], 'unknown solver "nave"'),
        (["naive", ("greedy", {"phase": 3})], 'unknown option of greedy "phase"'),
        ([], "solvers is empty"),
        (3, "solvers is 3: give names"),
        ([3], "solver is 3"),
    ],
)
def test_what_is_no_solver_is_refused_before_any_works(solvers, words: str) -> None:
    with pytest.raises(midair.SceneError, match=words):
        midair.compare(small(), solvers)


@pytest.mark.parametrize("pressures", ["loud", [1, 2], [np.nan] * 4])
def test_pressures_are_refused_by_name(pressures) -> None:
    with pytest.raises(midair.SceneError, match="pressure"):
        midair.compare(midair.Propagation(small(points=POINTS).propagation()), "naive", pressures=pressures)
