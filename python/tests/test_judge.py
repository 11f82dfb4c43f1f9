"""`midair.judge` for many drives: double-precision results, and the same bits as for each drive alone."""

import re
from typing import Any

import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(9, 8, 10e-3)
RNG = np.random.default_rng(7)
NAMES = ("accuracy", "sigma", "uniformity", "level", "residual", "leak")


def drives(count: int, transducers: int = 72) -> Any:
    size = (count, transducers)
    return (RNG.uniform(0, 1, size) * np.exp(2j * np.pi * RNG.uniform(size=size))).astype(np.complex64)


def points(count: int, size: int) -> Any:
    return RNG.uniform(-0.04, 0.04, (count, size, 3)) + np.array([0, 0, 0.12])


# Sizes at which the SIMD lanes are full and partly empty: 35 problems, 21 points, and a single problem.
@pytest.mark.parametrize(("count", "size"), [(35, 4), (5, 21), (1, 2), (16, 16)])
@pytest.mark.parametrize("given", ["pressures", "weights", "nothing"])
def test_a_table_is_each_drive_judged_alone_and_exact(count: int, size: int, given: str) -> None:
    q, at = drives(count), points(count, size)
    requested: dict[str, Any] = {}
    if given != "nothing":
        requested["pressures"] = RNG.uniform(100, 400, (count, size))
    if given == "weights":
        requested["weights"] = np.where(RNG.uniform(size=(count, size)) < 0.3, 0, 1.5)
        requested["weights"][:, 0] = 1
    one = midair.judge(ARRAY, q, points=at, threads=1, **requested)
    table = midair.judge(ARRAY, q, points=at, threads=2, **requested)
    exact = midair.judge(ARRAY, q, points=at, precision="double", **requested)
    assert one == table
    for k in range(count):
        scene = midair.Scene(ARRAY, at[k], **{name: rows[k] for name, rows in requested.items()})
        alone = midair.judge(scene, q[k])
        double = midair.judge(scene, q[k], precision="double")
        for name in NAMES:
            assert getattr(table, name)[k] == getattr(alone, name)
            assert getattr(exact, name)[k] == getattr(double, name)
            # The documentation promises |p| to 1e-4 of what the array reaches; here rounding errors average
            # out.
            assert getattr(alone, name) == pytest.approx(getattr(double, name), rel=1e-4, abs=1e-5)


def test_a_batch_is_judged_as_it_says_of_itself() -> None:
    at = points(20, 3)
    batch = midair.solve_batch(ARRAY, at, solver="fast")
    judged = midair.judge(ARRAY, batch.drives, points=at)
    for name in NAMES:
        np.testing.assert_allclose(getattr(judged, name), getattr(batch.metrics, name), rtol=1e-5, atol=1e-6)


def test_many_drives_of_one_scene_of_a_matrix_and_behind_a_wall() -> None:
    q, at = drives(18), points(1, 3)[0]
    scene = midair.Scene(ARRAY, at, [300, 0, 200], weights=[1, 2, 0.5])
    matrix = midair.Propagation(scene.propagation())
    walled = midair.Scene(ARRAY, at, 250, obstacles=[midair.Wall([0, 0, 0.2], [0, 0, -1])])
    own, of_wall = midair.judge(scene, q), midair.judge(walled, q)
    of_matrix = midair.judge(matrix, q, pressures=[300, 0, 200])
    for k in (0, 17):
        assert own.residual[k] == midair.judge(scene, q[k]).residual
        assert own.leak[k] == midair.judge(scene, q[k]).leak
        assert of_wall.level[k] == midair.judge(walled, q[k]).level
        assert of_matrix.sigma[k] == midair.judge(matrix, q[k], pressures=[300, 0, 200]).sigma
    # Drives of any dtype and memory order give the same results.
    assert midair.judge(scene, q.astype(complex)) == own == midair.judge(scene, np.asfortranarray(q))
    assert midair.judge(scene, q.tolist()) == own
    assert midair.judge(scene, q, pressures=150).level[3] == midair.judge(scene, q[3], pressures=150).level


def test_a_stop_leaves_the_rest_unknown_and_progress_is_reported() -> None:
    q, at = drives(4000), np.repeat(points(1, 2), 4000, axis=0)
    reported: list[tuple[int, int, float]] = []
    whole = midair.judge(ARRAY, q, points=at, threads=1, progress=lambda *step: reported.append(step))
    assert reported[-1][:2] == (4000, 4000)
    assert reported[-1][2] == pytest.approx(np.mean(whole.residual))
    part = midair.judge(ARRAY, q, points=at, threads=1, progress=lambda *_: False)
    known = np.isfinite(part.level)
    assert known.any()
    assert not known.all()
    assert (part.level[known] == whole.level[known]).all()


REFUSED = {
    "no points": (lambda: midair.judge(ARRAY, drives(2)), "points"),
    "a row too many": (lambda: midair.judge(ARRAY, drives(2), points=points(3, 1)), "points"),
    "another N": (lambda: midair.judge(ARRAY, drives(2, 71), points=points(2, 1)), "drives"),
    "above 1": (lambda: midair.judge(ARRAY, 2 * drives(2), points=points(2, 1)), "problems[0]"),
    "a point on a transducer": (
        lambda: midair.judge(ARRAY, drives(1), points=[[ARRAY.positions[3]]]),
        "problems[0]",
    ),
    "no such precision": (
        lambda: midair.judge(ARRAY, drives(1), points=points(1, 1), precision="half"),
        "precision",
    ),
    "one drive, many threads": (
        lambda: midair.judge(midair.Scene(ARRAY, points(1, 1)[0]), drives(1)[0], threads=2),
        "drive",
    ),
    "no threads": (lambda: midair.judge(ARRAY, drives(1), points=points(1, 1), threads=0), "threads"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_is_refused_by_name(case: str) -> None:
    call, word = REFUSED[case]
    with pytest.raises(midair.SceneError, match=re.escape(word)):
        call()
