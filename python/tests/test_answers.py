"""Requests that are odd but can be meant get an answer, from every solver."""

import warnings
from collections.abc import Callable

import numpy as np
import pytest

import midair
from scenes import POINTS, numbers, same_bits, small, usable

SOLVERS = sorted(midair.solvers())
ARRAY = midair.Array.grid(5, 5, pitch=0.01)


def two(**scene) -> midair.Scene:
    """Two points 3 cm apart above 5 x 5 transducers."""
    return small(array=ARRAY, points=[[-0.015, 0, 0.1], [0.015, 0.002, 0.1]], **scene)


ODD: dict[str, Callable[[], midair.Scene]] = {
    "one point": lambda: small(array=ARRAY, points=[[0.01, 0.02, 0.1]]),
    "one transducer": lambda: midair.Scene(midair.Array([[0, 0, 0]]), POINTS),
    "one of each": lambda: midair.Scene(midair.Array([[0, 0, 0]]), [[0, 0, 0.1]]),
    "more points than transducers": lambda: small(
        array=midair.Array.grid(2, 1, pitch=0.01), points=np.random.default_rng(0).uniform(0.05, 0.1, (40, 3))
    ),
    "coincident points": lambda: small(array=ARRAY, points=[[0, 0, 0.1]] * 3),
    "coincident points of different pressures": lambda: small(
        array=ARRAY, points=[[0, 0, 0.1]] * 2, pressures=[500, 1500]
    ),
    "coincident transducers": lambda: midair.Scene(midair.Array(np.zeros((9, 3))), POINTS),
    "a quiet point": lambda: two(pressures=[1000, 0]),
    "a quiet point where the loud one is": lambda: small(
        array=ARRAY, points=[[0, 0, 0.1]] * 2, pressures=[1000, 0]
    ),
    "behind a point source array": lambda: small(array=ARRAY, points=[[0, 0, -0.1], [0.02, 0, -0.1]]),
    "in the plane of the array": lambda: small(array=ARRAY, points=[[0.3, 0, 0], [0.005, 0.005, 0]]),
    "a point of weight 0": lambda: two(weights=[1, 0]),
    "weights of all sizes": lambda: two(weights=[1e-30, 1e30]),
    "pressures of all sizes": lambda: two(pressures=[1e-9, 1e3]),
    "far more than the array can": lambda: two(pressures=1e9),
    "a silent transducer": lambda: small(array=midair.Array(ARRAY.positions, response=np.arange(25.0))),
    "a kilometre away": lambda: small(array=ARRAY, points=[[0, 0, 1000], [300, 0, 1000]]),
    "in another place": lambda: midair.Scene(midair.Array([[1e3, 1e3, 1e3]]), [[1e3, 1e3, 1e3 + 0.1]]),
    "thick air": lambda: two(absorption=200.0),
    "megahertz": lambda: two(frequency=2e6, sound_speed=1500),
}


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("odd", ODD)
def test_odd_request_is_answered(odd: str, solver: str) -> None:
    scene = ODD[odd]()
    for balance in (False, True):
        solution = midair.solve(scene, solver, balance=balance)
        assert usable(solution)
        assert solution.status in {"done", "out_of_steps"}
        assert solution.drive.any()
        assert np.isfinite(list(numbers(midair.judge(scene, solution.drive)).values())).all()


@pytest.mark.parametrize("solver", SOLVERS)
def test_metrics_of_one_point_have_no_spread(solver: str) -> None:
    metrics = midair.solve(ODD["one point"](), solver).metrics
    assert (metrics.sigma, metrics.uniformity, metrics.leak) == (0, 1, 0)
    # Regularised methods stay below a target at the edge of reach: evd by half.
    assert metrics.accuracy == metrics.level > 0.49


@pytest.mark.parametrize("solver", SOLVERS)
def test_quiet_point_is_quieter_for_being_asked_to(solver: str) -> None:
    solution = midair.solve(two(pressures=[1000, 0]), solver)
    loud, quiet = np.abs(solution.pressures)
    assert solution.metrics.leak == pytest.approx(quiet / 1000, rel=1e-6)
    assert quiet < loud
    assert solution.metrics.uniformity == 1


@pytest.mark.parametrize("solver", SOLVERS)
def test_point_of_weight_0_changes_no_bit_wherever_it_is(solver: str) -> None:
    scene = two(pressures=[800, 700])
    plain = midair.solve(scene, solver, balance=True)
    for place in ([0.02, 0.02, 0.1], [0, 0, 0], [0, 0, 1e-5]):
        points = np.insert(scene.points, 1, place, axis=0)
        ignoring = small(array=ARRAY, points=points, pressures=[800, 5e4, 700], weights=[1, 0, 1])
        solution = midair.solve(ignoring, solver, balance=True)
        assert same_bits(solution.drive, plain.drive)
        assert solution.metrics == plain.metrics
        assert same_bits(solution.pressures[[0, 2]], plain.pressures)
        assert np.isfinite(solution.pressures[1])


@pytest.mark.parametrize("solver", SOLVERS)
def test_transducer_without_effect_gets_no_drive(solver: str) -> None:
    response = np.ones(25, dtype=complex)
    response[[3, 11]] = 0
    normals = np.tile([0.0, 0.0, 1.0], (25, 1))
    normals[7] = [0, 0, -1]
    array = midair.Array(ARRAY.positions, normals, response=response, directivity="cos")
    solution = midair.solve(small(array=array), solver)
    for i in (3, 7, 11):
        assert same_bits(solution.drive[i : i + 1], np.zeros(1, dtype=np.complex64))
        assert (solution.phases[i], solution.amplitudes[i]) == (0, 0)
    assert np.count_nonzero(solution.drive) == 22


@pytest.mark.parametrize("solver", SOLVERS)
def test_response_is_compensated_for(solver: str) -> None:
    # A transducer's phase offset asks for the opposite phase; rounding that to one of 256 costs 1e-4.
    rng = np.random.default_rng(1)
    response = np.exp(1j * rng.uniform(-np.pi, np.pi, 25))
    accuracies = []
    for offsets in (None, response):
        scene = small(array=midair.Array(ARRAY.positions, response=offsets), points=[[0, 0, 0.1]])
        phases = 256 if solver == "greedy" else None
        accuracies.append(midair.solve(scene, solver, phases=phases).metrics.accuracy)
    assert accuracies[1] == pytest.approx(accuracies[0], abs=1e-3)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("size", [1e-50, 1e-36, 1e30, 1e40, 1e150, 1e300])
def test_units_at_the_ends_of_f32_are_refused_or_answered(size: float, solver: str) -> None:
    def whole(request: Callable[[], midair.Solution]) -> bool:
        try:
            solution = request()
        except midair.SceneError as error:
            return len(str(error).splitlines()) == 1
        return usable(solution) and solution.metrics.accuracy > 0.5

    with warnings.catch_warnings():
        # What does not fit complex64 is not to be found out by numpy's warnings.
        warnings.simplefilter("error")
        assert whole(lambda: midair.solve(two(source_pressure=size), solver))
        strong = {"source_pressure": size, "pressures": 20 * size}
        assert whole(lambda: midair.solve(two(**strong), solver, balance=True))
        propagation = np.full((1, 4), size)
        assert whole(lambda: midair.solve(midair.Propagation(propagation), solver))
        assert whole(lambda: midair.solve(midair.Propagation(propagation), solver, pressures=size, balance=True))


def test_field_where_no_drive_goes_is_refused_or_finite() -> None:
    for size in (1e-50, 1e40):
        try:
            field = midair.field(two(source_pressure=size), np.ones(25), POINTS)
        except midair.SceneError:
            continue
        assert np.isfinite(field.pressure).all()
        assert field.pressure.all()
