"""Warnings about a solution's quality: one for a solve and for a Solver, one with counts for a batch."""

import warnings
from collections.abc import Callable

import numpy as np
import pytest

import midair

ARRAY = midair.Array.preset("paper20")
POINTS = np.array([[-0.03, 0, 0.15], [0.03, 0, 0.15]])
#: Targets of five problems: two request too much (800 Pa at a point that can have 2.3 Pa), one very little.
PRESSURES = np.array([[1, 1], [800, 1], [1, 1], [1, 400], [0.01, 0.01]])


def received(call: Callable[[], object]) -> list[str]:
    """Returns the texts of the SceneWarnings of a call."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert all(warning.category is midair.SceneWarning for warning in caught)
    texts = [str(warning.message) for warning in caught]
    assert not any("\n" in text for text in texts)
    return texts


def test_a_batch_tells_each_kind_once_with_counts() -> None:
    points = np.broadcast_to(POINTS, (5, 2, 3))
    batches = []
    texts = received(lambda: batches.append(midair.solve_batch(ARRAY, points, PRESSURES, "wgs", balance=False)))
    assert len(texts) == 2
    assert texts[0].startswith("in 2 of 5 problems, worst in problems[1]: points[0].pressure is 800.000 Pa")
    assert texts[1].startswith("in 1 of 5 problems, worst in problems[4]: targets are 6.1e-3 of the")
    assert batches[0].beyond.tolist() == [False, True, False, True, False]
    assert batches[0].weak.tolist() == [False, False, False, False, True]
    assert batches[0].beyond.dtype == batches[0].weak.dtype == bool


def test_a_batch_without_a_shortcoming_is_silent() -> None:
    batch = midair.solve_batch(ARRAY, np.broadcast_to(POINTS, (3, 2, 3)), solver="wgs")
    assert not batch.beyond.any()
    assert not batch.weak.any()
    # With balancing, or with a method that finds the level itself, no result is marked as too weak.
    for options in ({"solver": "wgs", "balance": True}, {"solver": "uniform"}):
        assert not midair.solve_batch(ARRAY, POINTS[None], 0.01, **options).weak.any()


def test_a_batch_counts_what_is_left_to_the_supply() -> None:
    array = midair.Array.preset("paper20", quantization={"amplitudes": [1]})
    points, pressures = np.stack([POINTS, POINTS]), [[1, 1], [0.1, 0.1]]
    texts = received(lambda: midair.solve_batch(array, points, pressures, balance=True))
    assert len(texts) == 1
    assert texts[0].startswith("in 2 of 2 problems, worst in problems[1]: the device has no such amplitude")
    assert "scale all drives by 0." in texts[0]


@pytest.mark.parametrize("out", [None, np.empty(400, np.complex64)])
def test_a_solver_tells_each_kind_once(out: np.ndarray | None) -> None:
    solver = midair.Solver(ARRAY, "wgs", balance=False)

    def texts(pressures: object) -> list[str]:
        return received(lambda: solver(POINTS, pressures, out=out))

    assert texts(1.0) == []
    (text,) = texts([1, 800])
    assert text.startswith("points[1].pressure is 800.000 Pa, beyond reach")
    assert texts(800) == []
    (text,) = texts(0.01)
    assert text.endswith("balance=True cures it")
    assert texts(0.01) == []


def test_as_loud_as_can_be_is_beyond_nothing() -> None:
    scene = midair.Scene(ARRAY, POINTS, 1e6)
    assert received(lambda: midair.solve(scene, aim="max")) == []
    assert "beyond reach" in received(lambda: midair.solve(scene, aim="target"))[0]
    levitator = midair.Array.preset("tinylev")
    lift = midair.path.line([0, 0, 0], [0, 0, 0.003], speed=0.01)
    assert received(lambda: midair.sequence(levitator, lift, rate=100, signature="trap")) == []


def test_a_solver_looks_once_for_what_cannot_be_had_together() -> None:
    points = np.array([[-0.06, 0.05, 0.15], [0.06, 0.05, 0.15], [-0.06, -0.05, 0.15], [0.06, -0.05, 0.15]])
    solver = midair.Solver(ARRAY, "wgs")
    assert "of all of them at the same time" in received(lambda: solver(points, 2.0))[0]
    assert received(lambda: solver(points, 2.0)) == []


def test_a_warning_made_an_error_leaves_the_drive_written() -> None:
    solver, out = midair.Solver(ARRAY, "naive"), np.zeros(400, np.complex64)
    with pytest.raises(midair.SceneWarning):
        solver(POINTS, 800, out=out)
    assert np.abs(out).max() > 0.5
    assert solver(POINTS, 800).status == "missed"


def test_the_second_harmonic_has_a_warning_where_it_is_large() -> None:
    """Checks the estimate 3 pi beta |p|/(2 rho c^2), beta = 1.2:
    it warns above 0.25, for pressures that are reached.
    """
    board, point = midair.Array.preset("autd3", (2, 2)), [[0, 0, 0.15]]
    air = board.medium
    assert not received(lambda: midair.solve(midair.Scene(board, point, 6000)))
    share = 1.5 * np.pi * 1.2 * 8000 / (air["density"] * air["sound_speed"] ** 2)
    line = f"at 8.0 kPa the second harmonic, which is not in the model, is estimated at {share:.2f} of |p|"
    loud = midair.Scene(board, point, 8000)
    solver = midair.Solver(loud)
    for call in (lambda: midair.solve(loud), lambda: solver(loud.points, 8000)):
        (text,) = received(call)
        assert text.startswith(line)
    assert not received(lambda: solver(loud.points, 8000))
    # The pressures at a trap are not those of its focus, and where the highest are wanted none is requested.
    for other, aim in ((loud.replace(signature="twin"), "target"), (loud, "max")):
        assert not any("harmonic" in text for text in received(lambda: midair.solve(other, aim=aim)))  # noqa: B023
    (text,) = received(lambda: midair.solve_batch(board, [point, point], [[6000], [8000]]))
    assert text.startswith(f"in 1 of 2 problems, worst in problems[1]: {line}")


def test_a_solve_a_solver_and_a_batch_give_the_same_warnings_in_the_same_order() -> None:
    """Of a board of 32 phases, by a bound below a step of them: the drive stands still."""
    array, points = midair.Array.preset("sonicsurface"), np.array([[0, 0, 0.12], [0.02, 0, 0.12]])
    first = midair.solve(midair.Scene(array, points), "glide")
    asked = np.array([1e5, 1e5])
    texts = received(lambda: midair.solve(midair.Scene(array, points, asked), "glide", change=0.05, start=first))
    assert "beyond reach" in texts[0]
    (still,) = (text for text in texts if "less than a step of the board's 32 phases" in text)
    solver = midair.Solver(array, "glide", change=0.05)
    assert received(lambda: solver(points, asked, start=first)) == texts
    starts = np.stack([first.drive] * 2)
    batch = received(
        lambda: midair.solve_batch(array, np.stack([points] * 2), asked, "glide", change=0.05, start=starts)
    )
    assert batch == [f"in 2 of 2 problems, worst in problems[0]: {text}" for text in texts]
    # Without a start, the phases are free.
    assert still not in received(lambda: midair.solve(midair.Scene(array, points), "glide", change=0.05))


def test_a_batch_warns_of_quiet_points_that_leak() -> None:
    """As a solve does: 25 quiet points are more than 25 transducers can silence."""
    array, x = midair.Array.grid(5, 5, 0.01), np.linspace(-0.06, 0.06, 5)
    points = np.array([[0.005, 0.005, 0.12], *([a, b, 0.1] for a in x for b in x)])
    asked = np.r_[100.0, np.zeros(25)]
    texts = received(lambda: midair.solve(midair.Scene(array, points, asked)))
    assert any("quiet points leak" in text for text in texts)
    batch = received(lambda: midair.solve_batch(array, points[None], asked))
    assert batch == [f"in 1 of 1 problems, worst in problems[0]: {text}" for text in texts]


@pytest.mark.parametrize("method", ["sdp", "gspat", "naive"])
def test_a_method_whose_limit_plays_louder_than_requested_is_not_done(method: str) -> None:
    solution = midair.solve(midair.Scene(ARRAY, POINTS, 0.02), method, limit="normalize")
    assert solution.status == "missed"
    assert solution.metrics.level > 10


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("method", [name for name in midair.solvers() if name != "bounded"])
def test_no_method_is_done_beyond_the_reach(method: str) -> None:
    status = midair.solve(midair.Scene(ARRAY, POINTS, 30.0), method).status
    assert status in {"missed", "out_of_steps"}
    assert set(midair.solve_batch(ARRAY, [POINTS] * 20, 30.0, method).status) == {status}
