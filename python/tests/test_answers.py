"""Solutions of unusual but valid requests, from every solver.

This module has only those scenes that the core's own tests do not have.
"""

import warnings
from collections.abc import Callable
from contextlib import nullcontext

import numpy as np
import pytest

import midair
from scenes import POINTS, numbers, same_bits, small, usable

SOLVERS = sorted(midair.solvers())
ARRAY = midair.Array.grid(5, 5, pitch=0.01)


def two(**scene) -> midair.Scene:
    """Returns a scene of two points 3 cm apart above 5 x 5 transducers."""
    return small(array=ARRAY, points=[[-0.015, 0, 0.1], [0.015, 0.002, 0.1]], **scene)


ODD: dict[str, Callable[[], midair.Scene]] = {
    "coincident transducers": lambda: midair.Scene(midair.Array(np.zeros((9, 3))), POINTS),
    "a quiet point where the loud one is": lambda: small(array=ARRAY, points=[[0, 0, 0.1]] * 2, pressures=[1000, 0]),
    "in the plane of the array": lambda: small(array=ARRAY, points=[[0.3, 0, 0], [0.005, 0.005, 0]]),
    "weights of all sizes": lambda: two(weights=[1e-30, 1e30]),
    "pressures of all sizes": lambda: two(pressures=[1e-9, 1e3]),
    "far away": lambda: small(array=ARRAY, points=[[0, 0, 200], [60, 0, 200]]),
    "in another place": lambda: midair.Scene(midair.Array([[1e3, 1e3, 1e3]]), [[1e3, 1e3, 1e3 + 0.1]]),
    "thick air": lambda: two(absorption=200.0),
    "megahertz": lambda: two(frequency=2e6, sound_speed=1500),
}


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("odd", ODD)
def test_odd_request_is_answered(odd: str) -> None:
    scene = ODD[odd]()
    for solver in SOLVERS:
        for balance in (False, True):
            solution = midair.solve(scene, solver, balance=balance)
            assert usable(solution), solver
            assert solution.status in {"done", "missed", "out_of_steps"}, solver
            assert solution.drive.any(), solver
            judged = numbers(midair.judge(scene, solution.drive))
            assert np.isfinite(list(judged.values())).all(), solver


def test_metrics_of_one_point_have_no_spread() -> None:
    for solver in SOLVERS:
        metrics = midair.solve(small(array=ARRAY, points=[[0.01, 0.02, 0.1]]), solver).metrics
        assert (metrics.sigma, metrics.uniformity, metrics.leak) == (0, 1, 0), solver
        # Regularised methods stay below a target that can just be reached; evd reaches half of such a target.
        assert metrics.accuracy == metrics.level > 0.49, solver


def test_quiet_point_is_quieter_for_being_requested_to() -> None:
    for solver in SOLVERS:
        # `glide` does not use quiet points in its search: the pressure there is reported as a miss.
        missed = solver == "glide"
        with pytest.warns(midair.SceneWarning, match="missed by") if missed else nullcontext():
            solution = midair.solve(two(pressures=[1000, 0]), solver)
        loud, quiet = np.abs(solution.pressures)
        if solver in {"uniform", "best", "descent", "glide"}:
            assert (solution.status == "missed") == missed, solver
        elif solution.status != "out_of_steps":
            assert (solution.status == "missed") == (np.hypot(loud - 1000, quiet) > 10), solver
        assert solution.metrics.leak == pytest.approx(quiet / 1000, rel=1e-6), solver
        assert quiet < loud, solver
        assert solution.metrics.uniformity == 1, solver


def test_transducer_without_effect_gets_no_drive() -> None:
    response = np.ones(25, dtype=complex)
    response[[3, 11]] = 0
    normals = np.tile([0.0, 0.0, 1.0], (25, 1))
    normals[7] = [0, 0, -1]
    array = midair.Array(ARRAY.positions, normals, response=response, directivity="cos")
    for solver in SOLVERS:
        solution = midair.solve(small(array=array), solver)
        for i in (3, 7, 11):
            assert same_bits(solution.drive[i : i + 1], np.zeros(1, dtype=np.complex64)), solver
            assert (solution.phases[i], solution.amplitudes[i]) == (0, 0), solver
        assert np.count_nonzero(solution.drive) == 22, solver


def test_response_is_compensated_for() -> None:
    # The drive must have the opposite of a transducer's phase offset; rounding to 256 phases changes the
    # accuracy by up to 1e-3.
    rng = np.random.default_rng(1)
    response = np.exp(1j * rng.uniform(-np.pi, np.pi, 25))
    for solver in SOLVERS:
        found = []
        for offsets in (None, response):
            scene = small(array=midair.Array(ARRAY.positions, response=offsets), points=[[0, 0, 0.1]])
            phases = 256 if solver == "greedy" else None
            found.append(midair.solve(scene, solver, phases=phases))
        # A method with few phases rounds some of the 25 transducers differently.
        few = len(set(found[0].phases.round(4))) <= 16
        plain, shifted = (solution.metrics.accuracy for solution in found)
        assert shifted == pytest.approx(plain, abs=0.05 if few else 1e-3), solver


@pytest.mark.parametrize("size", [1e-50, 1e-36, 1e30, 1e40, 1e150, 1e300])
def test_units_at_the_ends_of_f32_are_refused_or_answered(size: float) -> None:
    def whole(request: Callable[[], midair.Solution]) -> bool:
        try:
            solution = request()
        except midair.SceneError as error:
            return len(str(error).splitlines()) == 1
        return usable(solution) and solution.metrics.accuracy > 0.5

    def requests(solver: str) -> list[Callable[[], midair.Solution]]:
        strong = {"source_pressure": size, "pressures": 20 * size}
        matrix = np.full((1, 4), size)
        return [
            lambda: midair.solve(two(source_pressure=size), solver),
            lambda: midair.solve(two(**strong), solver, balance=True),
            lambda: midair.solve(midair.Propagation(matrix), solver),
            lambda: midair.solve(midair.Propagation(matrix), solver, pressures=size, balance=True),
        ]

    with warnings.catch_warnings():
        # Warnings become errors, so a value that does not fit complex64 must be rejected before numpy warns.
        warnings.simplefilter("error")
        for solver in SOLVERS:
            assert all(whole(request) for request in requests(solver)), solver


def test_field_where_no_drive_goes_is_refused_or_finite() -> None:
    for size in (1e-50, 1e40):
        try:
            field = midair.field(two(source_pressure=size), np.ones(25), POINTS)
        except midair.SceneError:
            continue
        assert np.isfinite(field.pressure).all()
        assert field.pressure.all()
