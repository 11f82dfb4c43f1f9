"""Solvers written in Python: the arguments of such a function, its results, and the checks around it."""

import functools

import numpy as np
import pytest

import midair
from scenes import POINTS, exact, numbers, small, usable

TARGETS = [900.0, 700.0, 500.0, 800.0]


def foci(propagation, targets, weights, share=1.0):
    """Returns the superposition of single foci, with |q| limited to 1."""
    drive = share * propagation.conj().T @ (weights * targets / (np.abs(propagation) ** 2).sum(axis=1))
    return drive / np.maximum(1, np.abs(drive))


def test_it_is_given_the_points_that_take_part_in_pascals() -> None:
    seen = []

    def spy(*arguments, **keywords):
        seen.append((arguments, keywords))
        return foci(*arguments)

    scene = small(pressures=TARGETS, weights=[2.0, 0.0, 1.0, 4.0], temperature=25)
    solution = midair.solve(scene, spy, lambda_=3, name="x", order=[1, 2])
    (propagation, targets, weights), keywords = seen[0]
    assert keywords == {"lambda_": 3, "name": "x", "order": [1, 2]}
    assert propagation.dtype == np.complex64
    assert (propagation == scene.propagation()[[0, 2, 3]]).all()
    assert targets.tolist() == [900, 500, 800]
    assert weights.tolist() == [0.5, 0.25, 1]
    assert solution.pressures.shape == (4,)
    # With balancing, the targets are scaled to the balanced level.
    weak = small(pressures=[1.0] * 4)
    midair.solve(weak, spy, balance=True)
    assert seen[1][0][1] == pytest.approx(weak.reach().level, rel=1e-12)


def test_what_surrounds_a_method_surrounds_it() -> None:
    array = midair.Array.grid(8, 8, 0.01, quantization={"phases": 16, "amplitudes": [0, 0.5, 1]})
    scene = small(array=array, pressures=TARGETS)
    own = midair.solve(scene, foci, share=2.0, trace=True)
    assert usable(own)
    assert (own.solver, own.status, own.steps) == ("foci", "missed", 1)
    assert own.options == {"share": 2.0, "balance": False}
    assert own.trace.tolist() == [own.metrics.residual]
    assert set(np.abs(own.drive).round(6).tolist()) <= {0, 0.5, 1}
    turns = own.phases / (2 * np.pi) * 16
    # Rounding to f32 causes errors of 6e-8 turns, which are 1e-6 of the 16 phases' step.
    assert turns == pytest.approx(np.round(turns), abs=1e-5)
    assert numbers(own.metrics) == pytest.approx(numbers(midair.judge(scene, own.drive)), abs=1e-4)
    assert midair.solve(scene, foci, progress=lambda *step: False).status == "stopped"
    with pytest.warns(midair.SceneWarning, match="balance=True cures it"):
        midair.solve(small(pressures=[1.0] * 4), foci)
    with pytest.warns(midair.SceneWarning, match="beyond reach"):
        midair.solve(small(pressures=[1e5] * 4), foci)


def test_it_is_as_good_as_the_built_in_method_of_the_same_formula() -> None:
    scene = small(pressures=TARGETS)
    ours, built_in = midair.solve(scene, foci), midair.solve(scene, "naive")
    # Both solvers sum 4 rows in f32; rounding decides whether a drive near |q| = 1 is limited.
    assert np.abs(ours.drive - built_in.drive).max() < 1e-5
    assert (ours.status, built_in.status, built_in.solver) == ("missed", "missed", "naive")


def test_a_matrix_will_do_and_what_is_off_stays_off() -> None:
    mask = np.arange(64) % 5 != 2
    matrix = midair.Propagation(exact(small()))

    def careless(propagation, targets, weights):
        drive = foci(propagation, targets, weights)
        with np.errstate(invalid="ignore"):
            return drive / np.abs(drive)

    solution = midair.solve(matrix, careless, pressures=TARGETS, mask=mask)
    assert usable(solution)
    assert ((solution.drive != 0) == mask).all()


@pytest.mark.parametrize(
    ("drive", "words"),
    [
        (np.zeros(3), "drive by wrong is 3 values: give one for each of the 64 transducers"),
        (np.zeros((64, 1)), "drive by wrong is of shape (64, 1): give numbers of shape (N,)"),
        (np.full(64, np.nan), "drive[0] by wrong is NaN+0i: give finite numbers"),
        (np.full(64, 1e200), "drive[0] by wrong is inf+0i: give finite numbers"),
        (np.full(64, 1.01j), "drive[0] by wrong is 0+1.01i: a drive's modulus is at most 1; divide all"),
        (None, "drive by wrong is None: give numbers"),
        (["x"] * 64, "drive by wrong is ['x', 'x'"),
        (np.ones(64, bool), "drive by wrong is of dtype bool"),
    ],
)
def test_what_is_no_drive_is_refused_in_one_line(drive, words: str) -> None:
    def wrong(propagation, targets, weights):
        return drive

    with pytest.raises(midair.SceneError) as refused:
        midair.solve(small(), wrong)
    assert str(refused.value).startswith(words)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("error", [KeyboardInterrupt, ZeroDivisionError("mine"), SystemExit(3)])
def test_what_it_raises_comes_out_unchanged(error) -> None:
    def broken(propagation, targets, weights):
        raise error

    with pytest.raises(error if isinstance(error, type) else type(error)) as raised:
        midair.solve(small(), broken)
    assert raised.value is error or isinstance(error, type)
    # The traceback ends in the function itself, so that a user can find the fault.
    assert [entry.name for entry in raised.traceback][-1] == "broken"
    assert usable(midair.solve(small(), foci))


def test_what_a_function_cannot_have_is_refused_in_one_line() -> None:
    scene = small()
    for keywords, words in [
        ({"aim": "max"}, 'aim is given to "foci": leave it out'),
        ({"start": np.ones(64, complex)}, 'start is given to "foci": leave it out'),
        ({"share": np.eye(2)}, "share is of dtype float64"),
    ]:
        with pytest.raises(midair.SceneError) as refused:
            midair.solve(scene, foci, **keywords)
        assert str(refused.value).startswith(words)
    with pytest.raises(midair.SceneError, match=r"by midair\.solve, or many by midair\.solve_batch$"):
        midair.Solver(scene, foci)
    with pytest.raises(midair.SceneError, match=r"pressures is 'greedy': .* a solver goes by keyword"):
        midair.solve_batch(scene.array, [POINTS], "greedy", seed=1)


def test_another_signature_is_refused_with_the_one_that_is_called() -> None:
    def mine(propagation):
        return propagation[0]

    for call in (midair.solve, lambda scene, solver: midair.solve_batch(scene, [POINTS], solver=solver)):
        with pytest.raises(TypeError, match=r"mine: too many .*: a solver is called as solver\(propagation"):
            call(small(), mine)


@pytest.mark.filterwarnings("always::midair.SceneWarning")
def test_a_drive_that_was_not_scaled_is_reported() -> None:
    with pytest.warns(midair.SceneWarning, match=r"missed by (99|100).* scale the drive, up to \|q\| = 1"):
        midair.solve(small(), lambda *given: 1e-4 * foci(*given))


@pytest.mark.slow
def test_a_function_solves_many_scenes() -> None:
    scene, rng = small(), np.random.default_rng(3)
    points = POINTS + rng.uniform(-0.01, 0.01, (20, *np.shape(POINTS)))
    targets = rng.uniform(600, 900, (20, len(POINTS)))
    batch = midair.solve_batch(scene.array, points, targets, foci, share=0.5)
    for k, place in enumerate(points):
        one = midair.solve(midair.Scene(scene.array, place, targets[k]), foci, share=0.5)
        assert np.array_equal(batch.drives[k], one.drive)

    def broken(*given):
        raise ZeroDivisionError("a fault of the user")

    with pytest.raises(ZeroDivisionError, match="a fault of the user"):
        midair.solve_batch(scene.array, points, targets, broken)


def test_a_sweep_takes_functions() -> None:
    request = {
        "array": {"preset": "paper20"},
        "points": {"count": 2, "x": [-0.05, 0.05], "y": [-0.05, 0.05], "z": 0.15},
        "solver": [{"name": foci, "share": [0.5, 1.0]}, {"name": "naive"}],
        "seeds": 3,
    }
    table = midair.sweep(request)
    assert table["solver"].tolist() == ["foci"] * 6 + ["naive"] * 3
    assert table["share"].tolist() == [0.5] * 3 + [1.0] * 3 + [None] * 3
    points = 0.05 * (2 * np.random.default_rng([0, 1, 2]).random((2, 3)) - 1)
    points[:, 2] = 0.15
    one = midair.solve(midair.Scene(midair.Array.preset("paper20"), points), foci, share=0.5)
    assert table["accuracy"][1] == pytest.approx(one.metrics.accuracy, rel=1e-6)
    with pytest.raises(TypeError, match=r"<lambda>: .*: a solver is called as solver\(propagation"):
        midair.sweep({**request, "solver": {"name": lambda propagation: propagation[0]}})
    with pytest.raises(midair.SceneError, match=r"solver\.name is a function: give a method by its name"):
        midair.dataset({**request, "solver": {"name": foci}}, "data")


def test_anything_that_can_be_called_will_do() -> None:
    class Method:
        def __call__(self, propagation, targets, weights):
            return midair.solve(midair.Propagation(propagation), "naive", pressures=targets).drive

    assert midair.solve(small(pressures=TARGETS), Method()).solver == "Method"
    assert midair.solve(small(), lambda *arguments: foci(*arguments)).solver == "<lambda>"
    half = midair.solve(small(), functools.partial(foci, share=0.5))
    assert half.solver == "foci"
    assert half.options == {"balance": False}
