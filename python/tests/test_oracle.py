"""Known results of the NumPy reference with which midair is compared."""

import numpy as np
import pytest

import oracle


def grid(n: int) -> np.ndarray:
    """Returns an n x n grid with a pitch of 10 mm, centred in z = 0."""
    line = 0.01 * (np.arange(n) - (n - 1) / 2)
    x, y = np.meshgrid(line, line)
    return np.stack([x.ravel(), y.ravel(), np.zeros(n * n)], axis=1)


@pytest.mark.parametrize(("n", "expected"), [(20, 2.36066), (36, 6.40341)])
def test_reach_of_known_arrays(n: int, expected: float) -> None:
    G = oracle.propagation(grid(n), [[0, 0, 0.15]], source_pressure=1e-3)
    assert oracle.reach(G)[0] == pytest.approx(expected, abs=6e-6)


def test_patterns_have_known_values() -> None:
    knots = np.radians(np.arange(0, 91, 10))
    assert oracle.pattern("t4010a1", 740.0, knots) == pytest.approx(oracle.T4010A1)
    for directivity in [("piston", 0.005), ("sinc", 0.01), ("cos", 2.0), "t4010a1"]:
        ahead, behind = oracle.pattern(directivity, 740.0, np.array([0.0, 2.0]))
        assert (ahead, behind) == (1, 0)


def test_single_focus() -> None:
    G = oracle.propagation(grid(20), [[0.013, -0.008, 0.15]], source_pressure=1e-3)
    search = {"phases": 16, "amplitudes": 2, "order": np.random.default_rng(1).permutation(400)}
    found = oracle.greedy(G, [9.0], **search)
    waves = found * G[0]
    turns = np.angle(waves * waves[search["order"][0]].conj())
    assert np.abs(turns).max() <= 2 * np.pi / 16 + 1e-9
    assert oracle.regrets(G, [9.0], found, **search).max() <= 1e-12
    assert oracle.regrets(G, [9.0], found / 2, **search).min() > 1e-6
    assert oracle.naive(G, [9e3]) == pytest.approx(G[0].conj() / np.abs(G[0]))


@pytest.mark.parametrize("objective", ["l2", "l1"])
def test_changes_add_up_to_the_energy(objective: str) -> None:
    rng = np.random.default_rng(2)
    G = rng.normal(size=(5, 30)) + 1j * rng.normal(size=(5, 30))
    t, w = np.array([3.0, 2.0, 0.0, 5.0, 9.0]), np.array([1.0, 2.0, 1.0, 0.5, 0.0])
    search = {"weights": w, "amplitudes": 3, "objective": objective}
    drive = oracle.greedy(G, t, order=range(30), **search)
    walk = oracle._Walk(G, t, **search)
    energy = walk.silent
    for i, q in enumerate(drive):
        energy += walk.changes(i, np.array([q]))[0]
        walk.add(i, q)
    whole = w @ np.abs(t - np.abs(G @ drive)) ** walk.power
    assert energy == pytest.approx(whole, abs=1e-12 * walk.silent)
    assert whole < 0.2 * walk.silent


def test_balanced_factor_uses_the_whole_budget() -> None:
    G = np.array([[3.0, 4j], [1.0, 1.0], [1.0, 0.0]])
    assert oracle.balanced_factor(G, [7.0, 2.0, 1.0], [1.0, 1.0, 0.0]) == pytest.approx(0.5**0.5)


def test_metrics_at_the_edges() -> None:
    some = oracle.metrics([1.0, 4.0, 0.5, 7.0], [2.0, 4.0, 0.0, 1.0], [1.0, 2.0, 1.0, 0.0])
    assert list(some.values()) == pytest.approx([5 / 6, 0.25, 0.5, 0.75, 1 / 36, 0.125])
    silent = oracle.metrics([0.0], [2.0])
    assert list(silent.values()) == [0, 0, 0, 0, 1, 0]
