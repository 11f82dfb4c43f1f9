"""The fastest motion along a curve, compared with closed forms and simulated flights."""

from __future__ import annotations

import csv
import runpy
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import beads
import midair
import traps
from oracle import Real

BENCH = Path(__file__).parents[2] / "bench"
shapes = SimpleNamespace(**runpy.run_path(str(BENCH / "flight.py")))

BOARDS = midair.Array.preset("openmpd_pair", quantization={})
SCENE = midair.Scene(BOARDS, [[0, 0, 0]], signature="trap")


def ring(radius: float) -> Real:
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    return radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)


def limit() -> float:
    """Returns the smallest lateral restoring force of a trap in the middle."""
    return float(midair.rest(midair.solve(SCENE)).restoring[0, :2].min())


def test_on_a_circle_the_speed_is_where_the_pull_inwards_and_the_drag_are_all_that_the_trap_gives() -> None:
    most = limit()
    radius, margin = 5e-3, 0.3
    path = midair.path.fastest(ring(radius), SCENE, margin=margin)
    speeds = np.linspace(0.1, 5, 20000)
    drag = SCENE._needed(np.outer(speeds, [1, 0, 0]), np.zeros((len(speeds), 3)))[:, 0]
    taken = np.hypot(SCENE._mass() * speeds**2 / radius, drag)
    speed = speeds[np.searchsorted(taken, margin * most)]
    assert path.closed
    assert abs(2 * np.pi * radius / speed / path.duration - 1) < 0.03
    # The path is the motion of the bead, not of the trap: `sequence` adds the force for its acceleration.
    apart = np.linalg.norm(path.at(np.linspace(0, 1, 50))[:, 0], axis=1) - radius
    assert abs(apart).max() < 0.02 * radius


def test_from_rest_to_rest_half_of_the_way_is_gaining_and_half_losing_speed() -> None:
    most = limit()
    way, margin = 0.01, 0.05
    line = np.linspace(-0.5, 0.5, 5)[:, None] * [way, 0, 0]
    path = midair.path.fastest(line, BOARDS, closed=False, margin=margin)
    without_drag = 2 * np.sqrt(way * SCENE._mass() / (margin * most))
    # The drag makes the motion slower. The force must change slowly, which takes some steps at both ends.
    assert not path.closed
    assert 1.0 < path.duration / without_drag < 1.25
    ends = path.at([0.0, path.duration])[:, 0]
    assert np.allclose(ends, line[[0, -1]], atol=1e-5)


@pytest.mark.slow
def test_a_bead_on_the_fastest_run_stays_on_its_curve() -> None:
    path = midair.path.fastest(clover(), BOARDS, margin=0.3)
    sequence = midair.sequence(BOARDS, path, rate=10e3, signature="trap", change=np.pi / 4)
    flight = midair.fly(sequence, duration=0.5)
    assert flight.held.all()
    # The bead is on the curve, wherever its trap is.
    apart = np.linalg.norm(flight.places[::5, 0, None] - dense(clover()), axis=2).min(axis=1)
    assert apart.max() < 0.3e-3
    assert path.duration < midair.path.fastest(clover(), BOARDS, margin=0.2).duration


@pytest.mark.slow
def test_a_bead_in_a_flight_of_our_own_stays_on_the_curve_too() -> None:
    positions, normals = traps.openmpd()
    boards = midair.Array(positions, normals, source_pressure=2.3)
    path = midair.path.fastest(clover(), boards, margin=0.3)
    sequence = midair.sequence(boards, path, rate=10e3, signature="trap", change=np.pi / 4)
    # The bead makes three laps, and starts with the speed of the path.
    points = np.concatenate([sequence.points] * 3)
    drives = np.concatenate([sequence.drives] * 3)
    speed = (points[1] - points[-1]) * 10e3 / 2
    air = beads.Air(positions, 2.3)
    # A frame's point is the trap's place in the middle of the frame; at its end the trap is halfway to the
    # next.
    halfway = (points + np.roll(points, 1, axis=0)) / 2
    begin = (points[0] + points[-1]) / 2
    assert air.stray(drives, halfway, begin, 10e3, speed)[:-1].max() < 0.3e-3


def clover() -> Real:
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)[:, None]
    ring = np.concatenate([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    found: Real = (0.012 + 0.004 * np.cos(3 * angle)) * ring
    return found


def dense(points: Real) -> Real:
    """Returns many points on the curve through the given points, by its Fourier series."""
    count, more = len(points), 2000
    series = np.fft.fftshift(np.fft.fft(points, axis=0), axes=0)
    orders = np.arange(-(count // 2), count - count // 2)
    waves = np.exp(2j * np.pi * np.outer(np.arange(more) / more, orders))
    return (waves @ series).real / count


def closed_curves() -> dict[str, Real]:
    """Returns points (K, 3) on upright closed curves: round ones, ones with corners, and random ones."""
    t = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    cardioid, square = 0.008 * (1 - np.cos(t)), 0.009 * (np.cos(t) ** 4 + np.sin(t) ** 4) ** -0.25
    flat = {
        "circle": 0.01 * np.exp(1j * t),
        "ellipse": 0.016 * np.cos(t) + 0.008j * np.sin(t),
        "eight": 0.012 * np.sin(t) + 0.008j * np.sin(2 * t),
        "square": square * np.exp(1j * t),
        "fish": 0.012 * (np.cos(t) - np.sin(t) ** 2 / np.sqrt(2) + 1j * np.cos(t) * np.sin(t)),
        "cardioid": cardioid * np.exp(1j * t) + 0.008,
    }
    for seed in range(10):
        parts = np.random.default_rng(seed).normal(size=(6, 2)) @ [1, 1j]
        orders = np.array([1, -1, 2, -2, 3, -3])
        curve = np.exp(1j * np.outer(t, orders)) @ (parts / orders**2)
        flat[f"random {seed}"] = 0.01 * curve / abs(curve).max()
    return {name: np.stack([curve.real, 0 * t, curve.imag], axis=1) for name, curve in flat.items()}


def stepped(points: Real, count: int) -> Real:
    """Returns places (K, 3) at equal steps along the closed curve through points."""
    curve = dense(points)
    curve = np.concatenate([curve, curve[:1]])
    ways = np.linalg.norm(np.diff(curve, axis=0), axis=1).cumsum()
    at = np.arange(count) / count * ways[-1]
    return np.stack([np.interp(at, [0, *ways], axis) for axis in curve.T], axis=1)


@pytest.mark.long
@pytest.mark.parametrize("name", closed_curves())
def test_no_constant_speed_of_the_same_top_speed_and_force_is_faster(name: str) -> None:
    curve = stepped(closed_curves()[name], 400)
    step = np.linalg.norm(np.diff(curve, axis=0, append=curve[:1]), axis=1)
    ahead, behind = np.roll(curve, -1, axis=0) - curve, curve - np.roll(curve, 1, axis=0)
    both = (step + np.roll(step, 1))[:, None]
    bends = 2 * (ahead / step[:, None] - behind / np.roll(step, 1)[:, None]) / both
    tangents = (ahead + behind) / both
    looked = np.arange(0, len(curve), 8)
    held = [midair.rest(midair.solve(SCENE.replace(points=curve[k : k + 1]))) for k in looked]

    def force(speed: float) -> float:
        """Returns the largest part of a trap's force along the curve, by the same ellipsoid."""
        needed = SCENE._needed(speed * tangents, speed**2 * bends)
        parts = [
            np.linalg.norm(needed[k : k + 8] @ (trap.axes[0] / trap.restoring[0].min(axis=1)[:, None]).T, axis=1)
            for k, trap in zip(looked, held, strict=True)
        ]
        return float(np.concatenate(parts).max())

    speed = max(v for v in np.geomspace(0.02, 3, 50) if force(v) < 0.6)
    path = midair.path.fastest(curve, SCENE, margin=1.1 * force(speed), speed=speed)
    assert path.duration < 1.02 * step.sum() / speed
    apart = np.linalg.norm(np.diff(path.at(np.arange(0, path.duration, 1e-3))[:, 0], axis=0), axis=1)
    assert apart.max() < 1.01 * 1e-3 * speed


@pytest.mark.long
@pytest.mark.parametrize("name", ["circle", "square", "ellipse"])
def test_a_bead_is_as_near_its_point_as_at_a_constant_speed(name: str) -> None:
    """On round curves the bead is behind its point because transducers follow late, not for lack of force."""
    points, boards = closed_curves()[name], midair.Array.preset("openmpd_pair")
    path = midair.path.fastest(points, boards, margin=0.5, speed=2.0)
    far = []
    even = stepped(points, round(1e4 * path.duration))[:, None]
    for run in (path, midair.path.from_array(even, rate=1e4, closed=True)):
        sequence = midair.sequence(boards, run, rate=10e3, signature="trap", change=np.pi / 4)
        far.append(midair.fly(sequence, duration=0.2).farthest[0])
    assert far[0] < min(1.05 * far[1], 0.8e-3)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("name", closed_curves())
@pytest.mark.parametrize("level", [False, True])
def test_no_constant_speed_whose_bead_is_as_near_is_faster_than_the_default(name: str, level: bool) -> None:
    points, boards = closed_curves()[name], midair.Array.preset("openmpd_pair")
    points = points[:, [0, 2, 1]] if level else points
    path = midair.path.fastest(points, boards)

    def far(run: midair.Path) -> float:
        sequence = midair.sequence(boards, run, rate=10e3, signature="trap", change=np.pi / 4)
        return float(midair.fly(sequence, duration=0.2).farthest[0])

    own = far(path)
    assert own < 2e-3
    for faster in (1.005, 1.05):
        even = stepped(points, round(1e4 * path.duration / faster))[:, None]
        assert far(midair.path.from_array(even, rate=1e4, closed=True)) > 0.99 * own
    # The lap is at most that of a margin of .3. It takes at most .5 of the force, or has a constant speed.
    assert path.duration < 1.01 * midair.path.fastest(points, boards, margin=0.3).duration
    places = path.at(np.arange(0, path.duration, 1e-4))[:, 0]
    speeds = (np.roll(places, -1, axis=0) - np.roll(places, 1, axis=0)) / 2e-4
    gains = (np.roll(places, -1, axis=0) - 2 * places + np.roll(places, 1, axis=0)) / 1e-8
    rates = np.linalg.norm(speeds[1:-1], axis=1)
    taken = []
    for k in range(1, len(places) - 1, len(places) // 12):
        trap = midair.rest(midair.solve(SCENE.replace(points=places[k : k + 1])))
        needed = SCENE._needed(speeds[k : k + 1], gains[k : k + 1])[0]
        taken.append(np.linalg.norm(trap.axes[0] @ needed / trap.restoring[0].min(axis=1)))
    # A run is smoothed in time, and takes more at a cusp.
    assert sorted(taken)[-2] < 0.53 or rates.min() > 0.98 * rates.max()


@pytest.mark.parametrize(
    ("points", "keywords", "refusal"),
    [
        (ring(0.01)[:3], {}, r"points is of shape .*: give at least 4 points"),
        (ring(0.01)[:1], {}, r"points is of shape .*: give at least 4 points"),
        (
            ring(0.01)[[0, 1, 2, 0]],
            {},
            r"points\[3\] is .*: the curve closes by itself, give at",
        ),
        (np.diag([np.nan, 0, 0, 0])[:, :3], {}, r"points\[0, 0\] is nan: give finite"),
        (ring(0.01), {"margin": 1.0}, "margin is 1.0: give a number below 1"),
        (ring(0.01), {"margin": 1e-90}, "margin is 1e-90: give a number of at least 0.0001"),
        (ring(0.01), {"speed": 0}, "speed is 0: give a number above 0"),
        (ring(0.01)[[0, 0, 1, 2, 3]], {}, "where the one before is"),
        (ring(0.01) + np.array([0, 0, 0.5]), {}, "no trap holds the bead"),
    ],
)
def test_what_is_not_in_order_is_refused(points: Any, keywords: dict[str, Any], refusal: str) -> None:
    with pytest.raises(midair.SceneError, match=refusal):
        midair.path.fastest(points, BOARDS, **keywords)


def test_a_sequence_warns_of_what_its_traps_cannot_give() -> None:
    path = midair.path.circle([0, 0, 0], 0.02, speed=8.0)
    with pytest.warns(midair.SceneWarning) as warned:
        midair.sequence(BOARDS, path, rate=10e3, signature="trap", change=np.pi)
    assert any("more than its trap can give" in str(one.message) for one in warned)


def test_the_record_has_each_shape_of_the_paper_at_its_rate() -> None:
    with (BENCH / "records" / "flight.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    for name, (_, size, rate) in shapes.SHAPES.items():
        own = [row for row in rows if row["shape"] == name and row["held"] == "True"]
        assert max(float(row["rate_Hz"]) for row in own) > rate
        assert np.ptp(shapes.outline(name), axis=0).max() == pytest.approx(size)


# A margin is a part of the trap's force. For a bead of 1 mm this is .75 of Gor'kov's, by which the margins of
# the same rates were .115 and .394.
@pytest.mark.long
@pytest.mark.parametrize(("name", "margin"), [("heart", 0.147), ("flower", 0.5)])
def test_shapes_of_the_paper_fly_at_its_rate(name: str, margin: float) -> None:
    found = shapes.flown(name, midair.Array.preset("openmpd_pair"), margin)
    assert found["held"]
    assert float(str(found["rate_Hz"])) >= shapes.SHAPES[name][2]
