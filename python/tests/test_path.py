"""Paths: positions of points, their speed, their targets, and the frames made of them."""

import math
import pickle
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import midair
from midair import path
from paths import HEAD, SQUARE, Z, ring, steps, still
from sane import sane

# The same examples in every run, so that a failure can be repeated.
steady = settings(max_examples=100, derandomize=True, deadline=None)

# Curves


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0, 0), (0.3, -0.2, 0.9)])
@pytest.mark.parametrize("count", [1, 3])
def test_a_circle_is_where_its_formula_is(normal: tuple[float, ...], count: int) -> None:
    center, radius, rate = np.array([0.01, -0.02, Z]), 0.02, 10e3
    circle = ring(normal=normal, points=count, start_angle=0.4)
    points, targets = circle.frames(rate)
    assert points.shape == (200, count, 3)
    assert (targets == 1).all()
    assert targets.shape == (200, count)
    assert (circle.points, circle.duration, circle.closed, circle.pascals) == (count, 0.02, True, False)
    away = points - center
    assert np.linalg.norm(away, axis=2) == pytest.approx(np.full((200, count), radius))
    assert away @ normal == pytest.approx(np.zeros((200, count)), abs=1e-12)
    # Every step is the chord of the angle 2 pi / 200, up to rounding, also the step from the last frame to
    # the first.
    chord = 2 * radius * math.sin(math.pi / 200)
    assert np.abs(steps(points, closed=True) / chord - 1).max() < 1e-11
    assert np.cross(away[0, 0], away[1, 0]) @ normal > 0
    if normal == (0, 0, 1):
        angles = 0.4 + 2 * math.pi * (50 * np.arange(200)[:, None] / rate + np.arange(count) / count)
        wanted = center + radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=2)
        assert np.abs(points - wanted).max() < 1e-15


def test_speed_and_frequency_say_the_same() -> None:
    length = 2 * math.pi * 0.02
    slow = ring(frequency=None, speed=0.5)
    assert slow.duration == pytest.approx(length / 0.5)
    assert slow.speed([0, 0.1]) == pytest.approx(np.full((2, 1), 0.5))
    assert ring(frequency=0.5 / length).duration == pytest.approx(slow.duration)
    assert ring(turns=3).duration == pytest.approx(0.06)
    assert ring(turns=3).speed([0]) == pytest.approx(length * 50)


@pytest.mark.parametrize(("turns", "closed"), [(1, True), (2, True), (0.5, False), (2.25, False)])
def test_a_circle_of_whole_turns_closes(turns: float, closed: bool) -> None:
    circle = ring(turns=turns)
    assert circle.closed == closed
    points, _ = circle.frames(10e3)
    assert len(points) == round(200 * turns) + (not closed)
    if not closed:
        angle = 2 * math.pi * turns
        assert points[-1, 0] == pytest.approx([0.01 + 0.02 * math.cos(angle), -0.02 + 0.02 * math.sin(angle), Z])


def test_a_line_ends_where_it_is_reported_or_comes_back() -> None:
    start, end = np.array([-0.02, 0, Z]), np.array([0.02, 0.03, Z])
    way = path.line(start, end, speed=0.5)
    assert not way.closed
    assert way.duration == pytest.approx(0.1)
    points, _ = way.frames(1000)
    assert points[:, 0] == pytest.approx(np.linspace(start, end, 101))
    back = path.line(start, end, speed=0.5, there_and_back=True)
    assert back.closed
    points, _ = back.frames(1000)
    assert points[:, 0] == pytest.approx(
        np.concatenate([np.linspace(start, end, 101), np.linspace(end, start, 101)[1:-1]])
    )
    assert steps(points, closed=True) == pytest.approx(np.full((200, 1), 0.0005))


def test_a_polyline_keeps_its_speed_around_corners() -> None:
    square = path.polyline([*SQUARE, SQUARE[-1]], frequency=10, closed=True)
    assert square.speed([0.0]) == pytest.approx(1.2)
    points, _ = square.frames(1200)
    # 30 steps of 1 mm on each side; the corners are among the frames.
    assert steps(points, closed=True) == pytest.approx(np.full((120, 1), 0.001))
    assert points[::30, 0] == pytest.approx(np.array(SQUARE))
    # Between two frames on both sides of a corner, the length along the path is the same as on a straight
    # line.
    ways = square.at([0.1 * 0.24, 0.1 * 0.26])
    assert np.abs(ways[1] - ways[0]).sum() == pytest.approx(0.02 * 0.12)
    opened = path.polyline(SQUARE, frequency=10)
    assert opened.at([0.0, 0.1])[:, 0] == pytest.approx(np.array([SQUARE[0], SQUARE[-1]]))


@pytest.mark.parametrize(
    ("size", "ratio", "phase"),
    [
        ((0.04, 0.04), (1, 1), math.pi / 2),
        ((0.06, 0.03), (1, 2), 0.0),
        ((0.05, 0.05), (3, 2), 0.3),
        ((0.05, 0.01), (2, 4), 1.0),
    ],
)
def test_a_lissajous_figure_is_walked_at_one_speed(
    size: tuple[float, float], ratio: tuple[int, int], phase: float
) -> None:
    figure = path.lissajous([0.01, 0, Z], size, ratio, phase=phase, frequency=20)
    points, _ = figure.frames(200e3)
    wanted = figure.speed([0.0])[0, 0] / 200e3
    # Chords of 1e-4 laps are shorter than their arcs by (step / radius)^2 / 24.
    assert np.abs(steps(points, closed=True) / wanted - 1).max() < 1e-3
    # The points lie on the figure: each is a point of the formula for some parameter u.
    a, b = ratio
    shift = (points[:, 0] - [0.01, 0, Z]) * [2 / size[0], 2 / size[1], 1]
    assert np.abs(shift[:, 2]).max() < 1e-15
    u = np.linspace(0, 2 * math.pi, 400_001)
    lap = np.stack([np.sin(a * u + phase), np.sin(b * u)], axis=1)
    for x, y, _ in shift[::997]:
        assert np.hypot(lap[:, 0] - x, lap[:, 1] - y).min() < 1e-4
    # The speed agrees with the length of the formula's curve, once around.
    once = np.linalg.norm(np.diff(lap * np.array(size) / 2, axis=0), axis=1).sum() / math.gcd(*ratio)
    assert figure.speed([0.0])[0, 0] / 20 == pytest.approx(once, rel=1e-7)


def test_a_lissajous_line_turns_around() -> None:
    line = path.lissajous([0, 0, Z], (0.04, 0.0), (1, 1), phase=0, speed=0.8)
    assert line.duration == pytest.approx(0.1)
    points, _ = line.frames(1000)
    assert np.abs(points[:, 0, 0]).max() == pytest.approx(0.02)
    assert steps(points, closed=True) == pytest.approx(np.full((100, 1), 0.0008), rel=1e-6)


def test_an_svg_outline_is_walked_from_text_and_file(tmp_path: File) -> None:
    text = HEAD + '<circle cx="31" cy="7" r="20"/></svg>'
    circle = path.svg(text, size=0.04, z=Z, frequency=50)
    assert circle.closed
    points, _ = circle.frames(10e3)
    assert np.linalg.norm(points - [0, 0, Z], axis=2) == pytest.approx(np.full((200, 1), 0.02), rel=4e-4)
    assert np.abs(steps(points, closed=True) / steps(points).mean() - 1).max() < 1e-3
    file = tmp_path / "circle.svg"
    file.write_text(text, "utf-8")
    assert (midair.shape.svg(text, size=0.04, z=Z) == midair.shape.svg(file, size=0.04, z=Z)).all()
    assert (path.svg(file, size=0.04, z=Z, frequency=50).frames(10e3)[0] == points).all()
    opened = path.svg(HEAD + '<path d="M0 0 h20 v10"/></svg>', size=0.04, z=Z, speed=0.6, pressures=900)
    assert (opened.closed, opened.duration) == (False, pytest.approx(0.1))
    assert opened.at([0.0, 0.1])[:, 0] == pytest.approx(np.array([[-0.02, 0.01, Z], [0.02, -0.01, Z]]))
    assert (opened.targets([0.05]) == 900).all()


corner = st.tuples(*[st.floats(-0.05, 0.05)] * 2, st.just(Z)).map(lambda xyz: [round(x, 4) for x in xyz])


@pytest.mark.slow
@steady
@given(st.lists(corner, min_size=2, max_size=8, unique_by=tuple), st.booleans(), st.floats(0.1, 5))
def test_no_step_is_longer_than_speed_allows(corners: list[list[float]], closed: bool, speed: float) -> None:
    walked = path.polyline(corners, speed=speed, closed=closed)
    ends = [*corners, corners[0]] if closed else corners
    length = sum(math.dist(a, b) for a, b in pairwise(ends))
    assert walked.duration == pytest.approx(length / speed)
    rate = 500 / walked.duration
    points, _ = walked.frames(rate)
    assert len(points) == 500 + (not closed)
    apart = steps(points, closed=closed)
    assert apart.max() <= length / 500 * (1 + 1e-9)
    # All chords except those around corners have the full length.
    assert (apart > length / 500 * (1 - 1e-9)).sum() >= 500 - len(ends)
    again = walked.at(np.array([0.3, 1.3]) * walked.duration)
    assert (np.abs(again[0] - again[1]).max() < 1e-12) == closed or len(corners) == 2


# Arrays


def test_an_array_is_met_at_its_frames_and_straight_between() -> None:
    random = np.random.default_rng(3)
    frames, pressures = random.uniform(-0.03, 0.03, (7, 4, 3)), random.uniform(0, 2000, (7, 4))
    for closed in (False, True):
        given = path.from_array(frames, rate=1e3 / 3, pressures=pressures, closed=closed)
        assert given.duration == pytest.approx((7 - (not closed)) * 3e-3)
        points, targets = given.frames(1e3 / 3)
        assert (points == frames).all()
        assert (targets == pressures).all()
        between = given.at([0.003 * 2.25])[0]
        assert between == pytest.approx(0.75 * frames[2] + 0.25 * frames[3])
        assert given.targets([0.003 * 2.25])[0] == pytest.approx(0.75 * pressures[2] + 0.25 * pressures[3])
        assert given.speed([0.003 * 2.25])[0] == pytest.approx(np.linalg.norm(frames[3] - frames[2], axis=1) / 3e-3)
        last = given.at([0.003 * 6.5])[0]
        assert last == pytest.approx((frames[6] + frames[0]) / 2 if closed else frames[6])


def test_an_array_is_copied() -> None:
    frames = np.zeros((3, 1, 3))
    given = path.from_array(frames, rate=10)
    frames[:] = 1
    assert (given.at([0.1]) == 0).all()


def test_a_morph_goes_straight_from_set_to_set() -> None:
    a, b = np.array([[0, 0, Z], [0.01, 0, Z]]), np.array([[0.03, 0, Z], [0.01, 0.04, Z]])
    morph = path.morph(a, b, speed=0.5)
    # The second point moves 40 mm, the longest distance.
    assert morph.duration == pytest.approx(0.08)
    assert morph.speed([0.0, 0.04])[1] == pytest.approx([0.375, 0.5])
    points, _ = morph.frames(1e3)
    assert points == pytest.approx(np.linspace(a, b, 81))
    assert path.morph(a, b, duration=0.08).at([0.03]) == pytest.approx(morph.at([0.03]))


# Targets


@pytest.mark.parametrize("pressures", [1500, [1500, 1500, 1500], np.full(3, 1500.0)])
def test_pressures_are_in_pascals(pressures: Any) -> None:
    requested = ring(points=3, pressures=pressures)
    assert requested.pascals
    assert (requested.frames(1e3)[1] == 1500).all()


WAVES: dict[str, Callable[[float], float]] = {
    "sqrt": lambda t: math.sqrt((1 + math.cos(2 * math.pi * 200 * t)) / 2),
    "cosine": lambda t: (1 + math.cos(2 * math.pi * 200 * t)) / 2,
    "square": lambda t: 1.0 if round(200 * t % 1, 9) % 1 < 0.5 else 0.0,
}


@pytest.mark.parametrize("shape", WAVES)
@pytest.mark.parametrize("depth", [1.0, 0.4])
def test_amplitude_modulation_is_its_formula(shape: Any, depth: float) -> None:
    tapped = ring(points=2, pressures=[1000, 500]).with_am(200, shape, depth)
    points, targets = tapped.frames(8e3)
    assert (points == ring(points=2).frames(8e3)[0]).all()
    wanted = [1 - depth + depth * WAVES[shape](i / 8e3) for i in range(len(targets))]
    assert targets == pytest.approx(np.outer(wanted, [1000, 500]), abs=1e-9)
    assert tapped.closed
    assert tapped.speed([0]) == pytest.approx(ring(points=2).speed([0]))


@pytest.mark.parametrize(("shape", "mean"), [("sqrt", 1 / 2), ("cosine", 3 / 8), ("square", 1 / 2)])
def test_the_mean_force_of_modulation(shape: Any, mean: float) -> None:
    _, targets = ring().with_am(200, shape).frames(8e3)
    assert (targets**2).mean() == pytest.approx(mean)
    # A square wave has equally many frames in each half, whatever the rounding of times.
    long = still(0.0, seconds=100).with_am(200, shape)
    _, targets = long.frames(8e3)
    assert (targets[:-1] ** 2).mean() == pytest.approx(mean, rel=1e-12)


# Inputs of a sequence


def test_read_gives_frames_of_paths_and_arrays() -> None:
    points, targets, closed = path.read(ring(points=2), 1e3)
    assert (points.shape, targets, closed) == ((20, 2, 3), None, True)
    _, targets, _ = path.read(ring(points=2).with_am(50), 1e3)
    assert targets is not None
    assert targets[5] == pytest.approx([math.sqrt(0.5)] * 2)
    _, targets, _ = path.read(ring(points=2).with_am(50), 1e3, [100, 300])
    assert targets is not None
    assert targets[5] == pytest.approx(np.array([100, 300]) * math.sqrt(0.5))
    _, targets, _ = path.read(ring(pressures=70), 1e3)
    assert (targets == np.full((20, 1), 70)).all()
    frames = np.random.default_rng(1).uniform(0, 0.1, (5, 2, 3))
    for written in (frames, list(frames), frames.tolist(), frames.astype(np.float32)):
        points, targets, closed = path.read(written, 1e3)
        assert points == pytest.approx(frames, rel=1e-6)
        assert (targets, closed) == (None, False)
    _, targets, _ = path.read(frames, 1e3, 80)
    assert (targets == np.full((5, 2), 80)).all()


def test_a_path_survives_pickling_and_is_not_changed() -> None:
    whole = (ring(points=2) & ring()).then(still(0.0, 0.01), fade=0.01).with_am(100)
    again = pickle.loads(pickle.dumps(whole))
    assert (again.frames(1e3)[1] == whole.frames(1e3)[1]).all()
    assert repr(whole) == "Path(points=5, duration=0.13, closed=False)"
    with pytest.raises(AttributeError):
        whole.points = 3  # type: ignore[misc]


def test_frames_are_solved() -> None:
    array = midair.Array.preset("autd3")
    points, _ = path.circle([0, 0, 0.12], 0.02, frequency=40, points=2).frames(1000)
    assert sane(midair.solve_batch(array, points, solver="uniform"), "frames of a circle")


def test_a_still_path_stays_and_is_modulated_by_a_shape_or_by_samples() -> None:
    still = midair.path.still([[0, 0, 0.1], [0.01, 0, 0.1]], duration=0.1, pressures=500)
    assert (still.points, still.duration, still.closed) == (2, 0.1, True)
    points, targets = still.modulated([1, 0.5, 0, 0.5], samples_rate=80).frames(400)
    assert (points == [[0, 0, 0.1], [0.01, 0, 0.1]]).all()
    assert targets[:, 0].tolist() == np.tile(np.repeat([500, 250, 0, 250], 5), 2).tolist()
    assert np.array_equal(still.with_am(20).targets([0.01]), still.modulated(20).targets([0.01]))
    half = still.modulated([1, 0], depth=0.5, samples_rate=20).frames(40)[1]
    assert half[:, 0].tolist() == [500, 500, 250, 250]
    with pytest.raises(midair.SceneError, match=r"samples\[0\] is 2.0: give numbers from 0 to 1"):
        still.modulated([2.0, 1.0], samples_rate=20)
    with pytest.raises(midair.SceneError, match="places is"):
        midair.path.still([0, 0], duration=1)


def test_a_chain_needs_the_frames_of_each_of_its_modulations() -> None:
    plain = midair.path.line([0, 0, 0.1], [0.01, 0, 0.1], speed=0.1)
    other = midair.path.line([0.01, 0, 0.1], [0, 0, 0.1], speed=0.1)
    for chain in (
        plain.then(other.modulated(200.0), fade=0.01),
        plain.modulated(200.0).then(other, fade=0.01),
    ):
        with pytest.raises(midair.SceneError, match=r"rate is 300\.0: the modulation needs 400 frames"):
            chain.frames(300.0)
        assert len(chain.frames(400.0)[0]) >= 80


@pytest.mark.slow
def test_a_text_is_drawn_outline_after_outline_and_closes() -> None:
    drawn = path.text("i", height=0.02, z=Z, speed=0.5)
    places, targets = drawn.frames(2e3)
    # During a fade there are two points, one at each outline.
    assert (drawn.points, drawn.closed) == (2, True)
    outline = midair.shape.text("i", height=0.02, z=Z, step=1e-4)
    for place, target in zip(places.transpose(1, 0, 2), targets.T, strict=True):
        # While a point sounds it is no faster than asked, and lies on an outline of the text.
        apart = np.linalg.norm(np.diff(place, axis=0), axis=1)
        assert apart[(target[1:] > 0.999) & (target[:-1] > 0.999)].max() <= 0.5 / 2e3 * 1.001
        near = np.linalg.norm(place[target > 0.999][:, None] - outline, axis=2).min(axis=1)
        assert near.max() < 2e-4
    with pytest.raises(midair.SceneError, match=r"fade is 0: give a number above 0"):
        path.text("i", height=0.02, z=Z, speed=0.5, fade=0)
