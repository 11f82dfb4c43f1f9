"""Paths played together and one after the other: points, joints, and fades between paths."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from midair import path
from paths import SQUARE, Numbers, Z, ring, steps, still

# The same examples in every run, so that a failure can be repeated.
steady = settings(max_examples=100, derandomize=True, deadline=None)


def test_paths_beside_one_another_keep_their_points() -> None:
    a, b = ring(points=2, pressures=900), path.line([0, 0, Z], [0.01, 0, Z], frequency=50, pressures=400)
    both = a & b
    assert (both.points, both.closed, both.pascals, both.duration) == (3, False, True, 0.02)
    points, targets = both.frames(1e3)
    times = np.arange(21) / 1e3
    assert (points == np.concatenate([a.at([*times[:-1].tolist(), 0.0]), b.at(times)], axis=1)).all()
    assert (targets == [900, 900, 400]).all()
    assert both.speed([0.01]) == pytest.approx(np.concatenate([a.speed([0.01]), b.speed([0.01])], axis=1))
    assert (a.beside(b).at(times) == both.at(times)).all()


def test_closed_paths_beside_one_another_go_around_until_both_are_back() -> None:
    both = ring(frequency=60) & ring(frequency=40, points=2) & ring(frequency=20)
    assert (both.points, both.closed) == (4, True)
    assert both.duration == pytest.approx(0.05)
    points, _ = both.frames(12e3)
    for k, frequency in enumerate((60, 40, 40, 20)):
        chord = 0.04 * math.sin(math.pi * frequency / 12e3)
        assert steps(points, closed=True)[:, k] == pytest.approx(np.full(600, chord), rel=1e-9)


def test_paths_that_meet_are_joined_without_a_fade() -> None:
    out = path.polyline(SQUARE, speed=0.5)
    home = path.line(SQUARE[-1], SQUARE[0], speed=0.5)
    joined = out.then(home)
    whole = path.polyline(SQUARE, speed=0.5, closed=True)
    assert joined.closed
    assert joined.points == 1
    assert joined.duration == pytest.approx(whole.duration)
    # A fade applies only where paths do not meet.
    assert out.then(home, fade=0.1).duration == joined.duration
    assert joined.frames(1e3)[0] == pytest.approx(whole.frames(1e3)[0])
    assert joined.speed([0, 0.1, 0.2]) == pytest.approx(np.full((3, 1), 0.5))
    assert (joined.targets(np.linspace(-1, 1, 9)) == 1).all()
    assert not out.then(path.line(SQUARE[-1], SQUARE[1], speed=0.5)).closed


def test_points_that_meet_in_another_order_go_on() -> None:
    a, b = still(0.0, 0.01, 0.02, pressures=[1, 2, 3]), still(0.02, 0.0, 0.01, pressures=[3, 1, 2])
    joined = a.then(b)
    points, targets = joined.frames(100)
    assert steps(points).max() == 0
    assert (targets == [1, 2, 3]).all()
    assert joined.closed


def there(points: Numbers, targets: Numbers, most: float) -> None:
    """Checks that no audible point moves further than `most` in a step, and that targets change smoothly."""
    seen = (targets[1:] > 0) & (targets[:-1] > 0)
    assert steps(points)[seen].max(initial=0) <= most * (1 + 1e-9)
    # No target jumps: from 0 it rises by the first step of a cosine.
    assert np.abs(np.diff(targets, axis=0)).max() < 0.1


def test_a_change_of_points_fades() -> None:
    one, three = ring(speed=0.5, frequency=None), ring(points=3, frequency=20, start_angle=1)
    joined = one.then(three, fade=0.02)
    assert joined.points == 4
    assert joined.duration == pytest.approx(one.duration + 0.02 + three.duration)
    assert not joined.closed
    points, targets = joined.frames(10e3)
    there(points, targets, three.speed([0])[0, 0] / 10e3)
    fading = one.duration + np.array([0, 0.005, 0.01, 0.015])
    share = (1 + np.cos(np.pi * np.array([0, 0.25, 0.5, 0.75]))) / 2
    wanted = np.stack([share, 1 - share, 1 - share, 1 - share], axis=1)
    assert joined.targets(fading) == pytest.approx(wanted, abs=1e-9)
    assert joined.at(fading)[:, :1] == pytest.approx(np.tile(one.at([0]), (4, 1, 1)))
    assert joined.at(fading)[:, 1:] == pytest.approx(np.tile(three.at([0]), (4, 1, 1)))
    assert (joined.speed(fading) == 0).all()
    assert joined.at([1.0])[:, 1:] == pytest.approx(three.at([0.0]))


def test_points_that_stay_keep_their_slot_and_silent_slots_are_used_again() -> None:
    a, b, c = still(0.0, 0.01), still(0.01, 0.03, 0.05), still(0.05, 0.07)
    joined = a.then(b, fade=0.05).then(c, fade=0.05)
    assert joined.points == 4
    middles = joined.targets([0.05, 0.2, 0.35])
    assert middles.tolist() == [[1, 1, 0, 0], [0, 1, 1, 1], [1, 0, 0, 1]]
    assert (joined.targets([0.125])[0, 1], joined.targets([0.275])[0, 3]) == (1, 1)
    assert joined.at([0.35])[0, [0, 3], 0] == pytest.approx([0.07, 0.05])
    there(*joined.frames(1e3), 0)


def test_silent_slots_wait_where_they_were_or_will_be() -> None:
    a, b, c, d, e = (still(0.01 * k) for k in range(5))
    turns = b.then(c, fade=0.05).then(d, fade=0.05).then(e, fade=0.05)
    for joined, slots, reused in ((turns, 2, 2), (a.then(turns, fade=0.05), 3, 2)):
        points, targets = joined.frames(1e3)
        assert joined.points == slots
        assert (points[:, :, 2] == Z).all()
        # A slot is one of the places for points in a frame. A silent slot moves once to its next point, just
        # before this point's target begins to rise.
        moved = steps(points) > 0
        assert moved.sum() == reused
        assert (targets[:-1][moved] == 0).all()
        assert (targets[2:][moved[:-1]] > 0).all()


def test_a_target_that_jumps_fades_where_it_is() -> None:
    joined = still(0.0, pressures=1000).then(still(0.0, pressures=2000), fade=0.1)
    assert joined.points == 1
    assert joined.targets([0.1, 0.15, 0.2])[:, 0] == pytest.approx([1000, 1500, 2000])


@pytest.mark.slow
def test_a_long_chain_is_as_good_as_a_short_one() -> None:
    chain = still(0.0, seconds=0.01)
    for k in range(1, 600):
        chain = chain.then(still(0.001 * (k % 40), seconds=0.01), fade=0.01)
    assert chain.points == 2
    _, targets = chain.frames(1e3)
    assert targets.sum(axis=1) == pytest.approx(np.ones(len(targets)))


places = st.lists(st.integers(0, 8), min_size=1, max_size=5, unique=True)


@pytest.mark.slow
@steady
@given(st.lists(places, min_size=2, max_size=5), st.floats(0.01, 0.2))
def test_whatever_is_joined_is_there_at_its_time(sets: list[list[int]], fade: float) -> None:
    parts = [still(*(0.01 * k for k in chosen)) for chosen in sets]
    joined = parts[0]
    for part in parts[1:]:
        joined = joined.then(part, fade=fade)
    begin = 0.0
    for before, chosen in pairwise([sets[0], *sets]):
        begin += fade if set(before) != set(chosen) else 0.0
        points, targets = joined.at([begin + 0.05])[0], joined.targets([begin + 0.05])[0]
        assert sorted(points[targets > 0, 0]) == pytest.approx(sorted(0.01 * k for k in chosen))
        assert set(targets) <= {0.0, 1.0}
        begin += 0.1
    assert joined.duration == pytest.approx(begin)
    assert joined.closed == (set(sets[0]) == set(sets[-1]) and _slots_return(joined))
    rate = 50 / fade
    points, targets = joined.frames(rate)
    there(points, targets, 0)


def _slots_return(joined: path.Path) -> bool:
    ends = [0.0, joined.duration - 1e-9]
    points, targets = joined.at(ends), joined.targets(ends)
    return bool((targets[0] == targets[1]).all() and (points[0] == points[1])[targets[0] > 0].all())
