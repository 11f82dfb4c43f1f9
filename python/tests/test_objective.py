"""greedy with a Python function as its objective in place of eq. (7), and in several sweeps."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import midair

Real = NDArray[np.float64]


def squared(pressures: NDArray[np.complex64], targets: Real, weights: Real) -> Real:
    cost: Real = (weights * (targets - np.abs(pressures)) ** 2).sum(axis=1)
    return cost


def scene(seed: int) -> midair.Scene:
    rng = np.random.default_rng(seed)
    points = np.c_[rng.uniform(-0.05, 0.05, (5, 2)), np.full(5, 0.15)]
    return midair.Scene(midair.Array.preset("paper20"), points, weights=rng.uniform(0.5, 1, 5))


@pytest.mark.parametrize("options", [{}, {"amplitudes": 3}, {"sweeps": 2}, {"phases": 64, "order": "rows"}])
def test_the_built_in_objective_makes_the_built_in_choices(options: dict[str, object]) -> None:
    for seed in range(4):
        requested = scene(seed)
        own = midair.solve(requested, "greedy", objective=squared, seed=seed, **options)
        built_in = midair.solve(requested, "greedy", seed=seed, **options)
        assert (own.drive == built_in.drive).mean() > 0.85
        assert own.metrics.residual == pytest.approx(built_in.metrics.residual, abs=5e-4)
        assert own.options["objective"] == "squared"


def test_each_choice_is_the_best_of_its_turn() -> None:
    turns = []

    def noted(pressures: NDArray[np.complex64], targets: Real, weights: Real) -> Real:
        costs = squared(pressures, targets, weights)
        turns.append((pressures, costs))
        return costs

    requested = scene(9)
    solution = midair.solve(requested, "greedy", objective=noted, seed=9)
    assert len(turns) == 400
    # The next candidates' phases are spread over a full circle, so the mean of their fields is the field
    # that this turn has chosen.
    for (pressures, costs), (later, _) in pairwise(turns):
        chosen = np.abs(pressures - later.mean(axis=0)).max(axis=1).argmin()
        assert costs[chosen] <= costs.min() + 1e-6 * costs.max()
    final = turns[-1][0]
    np.testing.assert_allclose(np.abs(final - solution.pressures).max(axis=1).min(), 0, atol=1e-3 * np.abs(final).max())


def test_a_level_of_the_worst_point_is_evener_than_squares() -> None:
    def worst(pressures: NDArray[np.complex64], targets: Real, weights: Real) -> Real:
        level: Real = np.abs(pressures) / targets
        return -level.min(axis=1) - 0.01 * level.mean(axis=1)

    requested = scene(3)
    own = midair.solve(requested, "greedy", objective=worst, phases=64, sweeps=3)
    assert own.metrics.uniformity > midair.solve(requested, "greedy", phases=64).metrics.uniformity


def test_what_a_function_does_wrong_is_reported() -> None:
    requested = scene(1)
    with pytest.raises(ZeroDivisionError):
        midair.solve(requested, "greedy", objective=lambda *_: 1 / 0)
    with pytest.raises(midair.SceneError, match="objective is 1 values: return one for each of the 16"):
        midair.solve(requested, "greedy", objective=lambda *_: [1.0])
    with pytest.raises(midair.SceneError, match="NaN: give a finite number for each candidate"):
        midair.solve(requested, "greedy", objective=lambda p, *_: np.full(len(p), np.nan))
    with pytest.raises(midair.SceneError, match="greedy alone takes one"):
        midair.solve(requested, "uniform", objective=squared)
    with pytest.raises(midair.SceneError, match="start"):
        midair.solve(requested, "greedy", objective=squared, start=np.ones(400))


def test_progress_stops_and_keeps_what_was_found() -> None:
    solution = midair.solve(scene(1), "greedy", objective=squared, progress=lambda step, *_: step < 100)
    assert solution.status == "stopped"
    assert solution.steps == 100
    assert (np.abs(solution.drive) > 0).sum() == 100
