"""`midair.solve`: every step of the search, attributes, metrics, warnings, and the solver of a scene file."""

import warnings

import numpy as np
import pytest

import midair
import oracle
from scenes import GAIN, POINTS, exact, numbers, same_bits, small, usable

#: A step of greedy may choose a candidate whose energy is this much above the least energy, relative to E(0),
#: the energy of the all-zero drive: energy differences are in f32.
REGRET = 1e-6

#: A solver with one step per transducer, and one with one step per iteration.
KINDS = ("greedy", "wgs")
BALANCED = {"fast", "descent", "glide", "wgs", "uniform", "best"}
WITH_AIM = {"uniform", "best", "glide"}


def shuffled(count: int, seed: int) -> list[int]:
    """Returns the order of a seed: SplitMix64 and a Fisher-Yates shuffle from the last place to the
    second.
    """
    state, mask, order = seed, 2**64 - 1, list(range(count))
    for last in range(count - 1, 0, -1):
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        other = ((z ^ (z >> 31)) * (last + 1)) >> 64
        order[last], order[other] = order[other], order[last]
    return order


def scaled(part: float, **scene) -> midair.Scene:
    """Returns a scene of POINTS whose targets are a part of the balanced level."""
    level = oracle.balanced_factor(exact(small(**scene)), np.ones(4))
    return small(pressures=part * level, **scene)


def test_solvers_tell_their_options_and_defaults() -> None:
    solvers = midair.solvers()
    assert {"greedy", "naive"} <= set(solvers)
    for name, info in solvers.items():
        assert (info.name, info.balance) == (name, name in BALANCED)
        assert all((info.summary, info.source))
        assert all(option.doc for option in info.options.values())
        options = {option: about.default for option, about in info.options.items()}
        solution = midair.solve(small(), name)
        assert solution.solver == name
        aim = {"aim": "max"} if name in WITH_AIM else {}
        assert solution.options == {**options, "balance": info.balance, **aim}
        assert same_bits(midair.solve(small(), name, **options).drive, solution.drive)
    greedy = {name: about.default for name, about in solvers["greedy"].options.items()}
    expected = {
        "phases": 16,
        "amplitudes": 1,
        "objective": "l2",
        "order": "random",
        "seed": 0,
        "change": np.pi,
        "sweeps": 1,
    }
    assert greedy == expected
    assert solvers["naive"].options["limit"].default == "clamp"


def test_what_an_array_keeps_for_its_next_scene_changes_no_bit() -> None:
    def array() -> midair.Array:
        return midair.Array.grid(8, 8, pitch=0.01)

    kept = array()
    changes: list[dict] = [
        {},
        {"temperature": 25},
        {"frequency": 50e3, "absorption": 0.2},
        {"source_pressure": 2.0, "directivity": "t4010a1"},
        {},
        {"directivity": {"piston": 4.5e-3}},
        {"temperature": 25},
    ]
    for change in changes:
        fresh, scene = small(array=array(), **change), small(array=kept, **change)
        assert scene == fresh
        assert same_bits(scene.propagation(), fresh.propagation())
        expected = midair.solve(fresh, "fast").drive
        assert same_bits(midair.solve(scene, "fast").drive, expected)
        # A scene keeps its array and its medium when its points are replaced.
        again = scene.replace(points=POINTS[::-1]).replace(points=POINTS)
        assert same_bits(midair.solve(again, "fast").drive, expected)
        assert same_bits(midair.Solver(scene, "fast")(POINTS).drive, expected)
        assert scene.array == fresh.array
    dead = midair.solve(small(array=kept), "fast", mask=[False] + 63 * [True])
    assert dead.drive[0] == 0
    assert midair.solve(small(array=kept), "fast").drive[0] != 0


def test_default_solver_is_the_best_there_is() -> None:
    assert midair.solve(small()).solver == "uniform"


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("objective", ["l2", "l1"])
@pytest.mark.parametrize(("phases", "amplitudes"), [(2, 1), (16, 1), (5, 7)])
def test_greedy_takes_the_best_candidate_at_every_step(objective: str, phases: int, amplitudes: int) -> None:
    rng = np.random.default_rng(6)
    array = midair.Array(
        rng.uniform(-0.1, 0.1, (90, 3)) * [1, 1, 0.2], response=rng.uniform(0.3, 1, 90), directivity="t4010a1"
    )
    points = rng.uniform(-0.06, 0.06, (7, 3))
    points[:, 2] += 0.2
    targets, weights = np.array([900, 700, 0, 500, 900, 1100, 300.0]), np.array([1, 2, 1, 0.5, 1, 1, 0.0])
    scene = midair.Scene(array, points, targets, weights=weights)
    search = {"phases": phases, "amplitudes": amplitudes, "objective": objective}
    given = rng.permutation(90)
    for order, steps in (("rows", np.arange(90)), (given, given)):
        drive = midair.solve(scene, "greedy", order=order, **search).drive
        sizes = np.abs(drive.astype(complex)) * amplitudes
        turns = np.angle(drive.astype(complex)) / (2 * np.pi) * phases
        # The drive is on the grid of phases and amplitudes, up to f32 rounding.
        assert np.abs(sizes - np.round(sizes)).max() < 1e-6 * amplitudes
        assert sizes.min() > 0.5
        assert np.abs(turns - np.round(turns)).max() < 1e-6 * phases
        found = oracle.regrets(exact(scene), targets, drive, order=steps, weights=weights, **search)
        assert found.max() < REGRET


def test_random_order_is_that_of_its_seed() -> None:
    for seed in (0, 1, 2**64 - 1):
        by_seed = midair.solve(small(), "greedy", order="random", seed=seed).drive
        by_hand = midair.solve(small(), "greedy", order=shuffled(64, seed)).drive
        assert same_bits(by_seed, by_hand)
    other = midair.solve(small(), "greedy", seed=3).drive
    assert not np.array_equal(other, by_seed)
    assert same_bits(midair.solve(small(), "greedy", seed=3).drive, other)


def test_columns_run_along_y_from_the_corner_with_the_smallest_x() -> None:
    array = midair.Array.grid(5, 4, pitch=0.01)
    positions = array.positions.copy()
    # Positions that differ by less than 1 um are in the same column.
    positions[:, 0] += np.random.default_rng(7).uniform(-1e-7, 1e-7, 20)
    order = np.arange(20).reshape(4, 5).T.ravel()
    for made in (array, midair.Array(positions)):
        scene = small(array=made)
        by_name, by_hand = (midair.solve(scene, "greedy", order=o).drive for o in ("columns", order))
        assert same_bits(by_name, by_hand)
    assert not np.array_equal(by_name, midair.solve(scene, "greedy", order="rows").drive)


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("limit", ["clamp", "normalize", "full"])
def test_naive_is_the_sum_of_the_single_foci(limit: str) -> None:
    scene = small(pressures=[3e3, 2e3, 0, 1e3])
    expected = oracle.naive(exact(scene), scene.pressures, limit)
    found = midair.solve(scene, "naive", limit=limit).drive
    # A drive sums four elements of G; where they nearly cancel, the limit "full" magnifies the phase error.
    assert np.abs(found - expected).max() < (1e-2 if limit == "full" else 4 * GAIN)
    assert (np.abs(expected) > 0.999).any()


@pytest.mark.parametrize("solver", KINDS)
def test_solution_is_consistent_with_the_reference(solver: str) -> None:
    scene = scaled(0.8, absorption=0.15)
    solution = midair.solve(scene, solver, trace=True)
    G, drive = exact(scene), solution.drive.astype(complex)
    # Each summed element of G has an error of at most GAIN.
    assert (np.abs(solution.pressures - G @ drive) <= GAIN * (np.abs(G) @ np.abs(drive))).all()
    assert solution.amplitudes == pytest.approx(np.minimum(np.abs(drive), 1), rel=1e-12)
    assert solution.amplitudes * np.exp(1j * solution.phases) == pytest.approx(drive, abs=1e-7)
    assert (solution.phases >= 0).all()
    assert (solution.phases < 2 * np.pi).all()
    assert (solution.amplitudes <= 1).all()
    p_abs = np.abs(solution.pressures.astype(complex))
    assert solution.radiation == pytest.approx(p_abs**2 / (1.223 * 340**2), rel=1e-12)
    assert np.array_equal(solution.targets, scene.pressures)
    assert (solution.status, solution.elapsed > 0) in {("done", True), ("missed", True), ("out_of_steps", True)}
    assert len(solution.trace) == solution.steps >= 1
    assert midair.solve(scene, solver).trace is None


@pytest.mark.parametrize("solver", KINDS)
def test_metrics_are_those_of_the_reference(solver: str) -> None:
    targets, weights = [800, 0, 1200, 600.0], [1, 1, 0.5, 0]
    scene = small(pressures=targets, weights=weights)
    solution = midair.solve(scene, solver)
    p_abs = np.abs(solution.pressures.astype(complex))
    # Both sides compute in f64 from the same numbers.
    expected = oracle.metrics(p_abs, targets, weights)
    assert numbers(solution.metrics) == pytest.approx(expected, rel=1e-9, abs=1e-12)
    judged = oracle.metrics(np.abs(exact(scene) @ solution.drive), targets, weights)
    assert numbers(midair.judge(scene, solution.drive, precision="double")) == pytest.approx(
        judged, rel=1e-9, abs=1e-12
    )
    assert solution.metrics.leak > 0


def test_judge_takes_a_drive_of_any_kind_of_number() -> None:
    scene, rng = small(), np.random.default_rng(8)
    drive = rng.uniform(0, 0.7, 64) * np.exp(1j * rng.uniform(0, 6, 64))
    targets = np.full(4, oracle.balanced_factor(exact(scene), np.ones(4)))
    # The drive is rounded to complex64 (6e-8), which matters most for sigma, the spread of nearly equal
    # pressures. The targets are the balanced level, which is summed in f32.
    expected = oracle.metrics(np.abs(exact(scene) @ drive), targets)
    for given in (drive, drive.astype(np.complex64), drive.tolist()):
        judged = numbers(midair.judge(scene, given, precision="double"))
        assert judged["sigma"] == pytest.approx(expected["sigma"], rel=1e-6)
        assert judged["uniformity"] == pytest.approx(expected["uniformity"], rel=1e-6)
        assert judged["accuracy"] == pytest.approx(expected["accuracy"], rel=1e-5)
    ones = [1] * 64
    assert midair.judge(scene, ones) == midair.judge(scene, np.ones(64, dtype=np.float16))


def test_pressures_left_out_are_the_balanced_level() -> None:
    # Moduli do not depend on phases: f32 sums of 64 of them are accurate to 1e-5.
    for weights in (None, [1, 0, 2, 1]):
        scene = small(weights=weights)
        expected = oracle.balanced_factor(exact(scene), np.ones(4), weights)
        assert midair.solve(scene, "naive").targets == pytest.approx(np.full(4, expected), rel=1e-5)


def test_balance_solves_at_the_balanced_level_and_reduces_the_drive() -> None:
    ratios = np.array([1, 2, 0, 0.5])
    scene = small(pressures=ratios)
    G, order = exact(scene), np.arange(64)
    solution = midair.solve(scene, "greedy", balance=True, order="rows", trace=True)
    (reduced,) = np.unique(np.round(solution.amplitudes, 9))
    factor = oracle.balanced_factor(G, ratios)
    full = solution.drive / np.abs(solution.drive)
    requested = ratios > 0
    # The drive is scaled so that the mean pressure is the targets' mean.
    assert 1 / reduced == pytest.approx(np.mean(np.abs(G @ full)[requested] / ratios[requested]), rel=2e-4)
    # The unscaled drive is optimal at the balanced level, up to f32 rounding.
    found = oracle.regrets(G, ratios * factor, full, order=order)
    assert found.max() < REGRET
    # All results are for the scaled drive and the requested pressures.
    assert solution.targets.tolist() == ratios.tolist()
    p_abs = np.abs(G @ solution.drive)
    assert numbers(solution.metrics) == pytest.approx(oracle.metrics(p_abs, ratios), rel=1e-2)
    assert solution.metrics.level == pytest.approx(1, abs=2e-4)
    assert solution.trace[-1] == pytest.approx(solution.metrics.residual, abs=1e-4)
    assert solution.options["balance"] is True


def test_balance_leaves_targets_alone_that_are_strong_enough() -> None:
    for scene in (scaled(1.2), small()):
        with_it, without = (midair.solve(scene, "greedy", balance=balance) for balance in (True, False))
        assert same_bits(with_it.drive, without.drive)


def test_targets_below_half_the_balanced_level_are_warned_of() -> None:
    with pytest.warns(midair.SceneWarning, match="balanced level") as caught:
        weak = midair.solve(scaled(0.49), "greedy")
    assert usable(weak)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert len(str(caught[0].message).splitlines()) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        midair.solve(scaled(0.51), "greedy")
        midair.solve(scaled(0.01), "greedy", balance=True)
        midair.solve(small(), "greedy")


def test_scene_file_names_the_solver_by_default(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    small().save(path)
    table = '[solver]\nname = "greedy"\nphases = 4\nseed = 9\nbalance = true\n'
    path.write_text(table + path.read_text("utf-8"), encoding="utf-8")
    scene = midair.Scene.load(path)
    assert scene.solver == ("greedy", {"phases": 4, "seed": 9, "balance": True})
    plain = small()

    def same(found: midair.Solution, *name: str, **options) -> bool:
        expected = midair.solve(plain, *name, **options)
        return same_bits(found.drive, expected.drive) and found.options == expected.options

    assert same(midair.solve(scene), "greedy", phases=4, seed=9, balance=True)
    assert same(midair.solve(scene, phases=8), "greedy", phases=8, seed=9, balance=True)
    assert same(midair.solve(scene, "greedy", seed=2), "greedy", phases=4, seed=2, balance=True)
    assert same(midair.solve(scene, "greedy", balance=False), "greedy", phases=4, seed=9, balance=False)
    assert same(midair.solve(scene, "naive"), "naive")
    assert same(midair.solve(scene, phases=None), "greedy", phases=4, seed=9, balance=True)


def test_solution_scene():
    array = midair.Array.preset("autd3", quantization={})
    points = [[0, 0, 0.1], [0.02, 0, 0.1]]
    scene = midair.Scene(array, points, 100.0, weights=[1, 2], temperature=25)
    for solution in (midair.solve(scene), midair.Solver(scene)(points, [100, 100], weights=[1, 2])):
        assert solution.scene.json() == scene.json()
    plain = midair.Solver(array)(points).scene
    assert plain.pressures is None
    assert plain.weights is None
    assert midair.solve(midair.Propagation(np.ones((1, 3)))).scene is None
