"""Flights of beads, compared with a plain integration in double precision."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
import traps
from oracle import Complex, Real

K = 2 * np.pi / traps.WAVELENGTH
RADIUS, BEAD = 1e-3, 29.0
VOLUME = 4 / 3 * np.pi * RADIUS**3
MASS = VOLUME * (BEAD + traps.DENSITY / 2)
WEIGHT = np.array([0, 0, -9.81]) * VOLUME * (BEAD - traps.DENSITY)
KELVIN = 273.15 * (traps.SOUND_SPEED / 331.3) ** 2
VISCOSITY = 1.458e-6 * KELVIN**1.5 / (KELVIN + 110.4)
POSITIONS, NORMALS = traps.tinylev()
LEVITATOR = midair.Array(POSITIONS, NORMALS, directivity="point", source_pressure=3.0)


def force(drive: Complex, place: Real) -> Real:
    """Returns the force (3,) of the point sources."""
    return traps.force(3.0 * drive, place - POSITIONS)


def integrated(sequence: midair.Sequence, times: Real, place: Real, speed: Real, tau: float, steps: int) -> Real:
    """Returns a bead's places (T, 3) at `times`, by a Runge-Kutta integration that begins at 0 s with `place`
    and `speed`, in `steps` steps from one time to the next. The field approaches the field of each new drive
    with the time constant tau.
    """
    drives = sequence.drives.astype(complex)
    count, rate = len(drives), sequence.rate
    kept = np.exp(-1 / (rate * tau))
    y = drives[0].copy()
    starts = []
    for _ in range(2):
        starts = []
        for frame in range(count):
            starts.append(y)
            y = drives[frame] + (y - drives[frame]) * kept

    def pull(time: float, place: Real, speed: Real, part: float) -> Real:
        frame = int(time * rate + 1e-9)
        own = drives[frame % count]
        sound = own + (starts[frame % count] - own) * np.exp(-(time - frame / rate) / tau)
        return air.acceleration(force(sound, place) + WEIGHT, speed, MASS, part)

    # The time of a flight is that of the middle of the first frame's first part.
    h = (times[1] - times[0]) / steps
    first = round(times[0] / h)
    assert abs(times[0] - first * h) < 1e-9
    air = traps.Drag(RADIUS, VISCOSITY, speed, h, first + steps * len(times))
    found = []
    for k in range(first + steps * (len(times) - 1) + 1):
        if k >= first and (k - first) % steps == 0:
            found.append(place)
        t = k * h
        # The fourth stage is just before the end of the step, so that all stages use the same frame.
        a = pull(t, place, speed, 0)
        b = pull(t + h / 2, place + h / 2 * speed, speed + h / 2 * a, 0.5)
        c = pull(t + h / 2, place + h / 2 * speed + h * h / 4 * a, speed + h / 2 * b, 0.5)
        d = pull(t + h * (1 - 1e-6), place + h * speed + h * h / 2 * b, speed + h * c, 1)
        place, before = place + h * speed + h * h / 6 * (a + b + c), speed
        speed = speed + h / 6 * (a + 2 * b + 2 * c + d)
        air.passed(before, speed)
    return np.array(found)


def ring(radius: float, speed: float, rate: float) -> midair.Sequence:
    """Returns a trap that goes around a circle: a focus with the upper board's phases turned by pi."""
    count = round(2 * np.pi * radius / speed * rate)
    angle = 2 * np.pi * np.arange(count) / count
    points = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    gains = midair.Scene(LEVITATOR, points).propagation()
    drives = (gains / abs(gains)).conj() * np.where(POSITIONS[:, 2] > 0, -1, 1)
    return midair.Sequence(LEVITATOR, points[:, None], 1.0, drives, rate=rate, closed=True, signature="trap")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rate", "lasts"), [(1000.0, 0.15), (8000.0, 0.15), pytest.param(1000.0, 1.0, marks=pytest.mark.long)]
)
def test_a_flight_is_what_plain_integration_gives(rate: float, lasts: float) -> None:
    sequence = ring(5e-3, 0.15, rate)
    start, speed, tau = np.array([5.1e-3, 0.1e-3, -0.05e-3]), np.array([0.05, 0.15, 0.0]), 0.3e-3
    flight = midair.fly(sequence, [start], speeds=[speed], duration=lasts, tau=tau)
    assert flight.held.all()
    # Steps of which a whole number also leads from 0 s to the first time.
    steps = 2 * max(round((flight.times[1] - flight.times[0]) / 0.125e-3), 1)
    plain = integrated(sequence, flight.times, start, speed, tau, steps)
    assert np.linalg.norm(flight.places[:, 0] - plain, axis=1).max() < 5e-6


@pytest.mark.slow
def test_a_bead_falls_out_of_a_trap_that_is_too_weak_and_is_drawn_and_reported(tmp_path: Path) -> None:
    sequence = ring(5e-3, 0.1, 500.0)
    weak = midair.Sequence(
        LEVITATOR, sequence.points, 1.0, 0.1 * sequence.drives, rate=500.0, closed=True, signature="trap"
    )
    flight = midair.fly(weak, duration=0.05)
    assert not flight.held.any()
    assert 0 < flight.lost[0] < 0.05
    assert np.isnan(flight.places[-1]).all()
    assert flight.farthest[0] < traps.WAVELENGTH / 2
    assert "0 of 1 held" in repr(flight)
    assert "after" in flight._repr_html_()
    assert len(flight.plot().axes) == 2
    flight.animate(tmp_path / "fall.gif", frames=3)
    assert (tmp_path / "fall.gif").stat().st_size > 1000


def test_a_bead_that_begins_as_its_trap_moves_stays_with_it() -> None:
    flight = midair.fly(ring(5e-3, 0.1, 500.0), duration=0.1)
    assert flight.held.all()
    assert flight.farthest[0] < 0.2e-3
    # Nine beads are computed in two groups; each result is that of a bead alone.
    nine = midair.fly(ring(5e-3, 0.1, 500.0), np.tile([[5e-3, 0, 0]], (9, 1)), duration=0.02)
    one = midair.fly(ring(5e-3, 0.1, 500.0), [[5e-3, 0, 0]], duration=0.02)
    assert np.array_equal(nine.places[:, [8]], one.places)
    np.testing.assert_allclose(nine.places[:, [0]], one.places, rtol=0, atol=1e-9)


def test_the_bead_is_that_of_the_sequence() -> None:
    boards = midair.Array.preset("openmpd_pair", quantization={})
    bead = midair.Bead(radius=0.8e-3, density=400)
    path = midair.path.circle([0, 0, 0], 5e-3, speed=0.1)
    own = midair.sequence(boards, path, rate=500, signature="trap", bead=bead)
    flight = midair.fly(own, duration=0.05)
    np.testing.assert_array_equal(flight.places, midair.fly(own, duration=0.05, bead=bead).places)
    assert not np.array_equal(flight.places, midair.fly(own, duration=0.05, bead={}).places)


@pytest.mark.parametrize(
    ("keywords", "refusal"),
    [
        ({"beads": [[0, 0]]}, "beads"),
        ({"beads": np.zeros((0, 3))}, "beads is of shape"),
        ({"speeds": [[0, 0]]}, "speeds is of shape"),
        ({"duration": 0.0}, "duration is 0.0"),
        ({"bead": {"radius": -1.0}}, "bead.radius is -1"),
        ({"bead": {"radius": 1e-9}}, "bead.radius is 1e-09: air stops such a bead within"),
        ({"beads": [[5e-3, 0, 0], [0, np.nan, 0]]}, r"beads\[1, 1\] is nan: give finite"),
        ({"speeds": [1e3, 0, 0]}, 'speeds is "1000 m/s": faster than sound'),
        ({"tau": -1.0}, "tau is -1"),
    ],
)
def test_what_is_not_in_order_is_refused(keywords: dict[str, Any], refusal: str) -> None:
    with pytest.raises(midair.SceneError, match=refusal):
        midair.fly(ring(5e-3, 0.1, 500.0), **keywords)


def test_a_bead_out_of_reach_of_its_trap_is_reported() -> None:
    with pytest.warns(midair.SceneWarning, match=r"beads\[1\] is 10 mm from point 1 \(and 1 more\): it"):
        flight = midair.fly(ring(0.01, 0.1, 500.0), [[0.01, 0, 0], [0, 0, 0], [0, 0, 9]], duration=0.01)
    assert flight.held.tolist() == [True, False, False]
    with pytest.raises(MemoryError, match=r"duration is 1e\+09 s: the tracks of the beads need \d+"):
        midair.fly(ring(0.01, 0.1, 500.0), duration=1e9)


def line(speed: float) -> midair.Sequence:
    """Returns an open motion along x that begins and ends at full speed."""
    boards = midair.Array.preset("openmpd_pair", quantization={})
    places = np.arange(-0.01, 0.01, speed / 1e3)[:, None] * [1, 0, 0]
    path = midair.path.from_array(places[:, None], rate=1e3)
    return midair.sequence(boards, path, rate=1e3, signature="trap")


def test_a_bead_of_an_open_motion_starts_at_its_point() -> None:
    flight = midair.fly(line(0.2), duration=0.01)
    assert flight.distances[0, 0] < 0.05e-3


def test_a_motion_that_begins_faster_than_its_trap_can_catch_is_reported() -> None:
    launched = "point 1 begins at 4 m/s in frame 0, faster than its trap can catch"
    with (
        pytest.warns(midair.SceneWarning, match="4 m/s needs 1.6 rad a frame"),
        pytest.warns(midair.SceneWarning, match=launched),
    ):
        line(4.0)


def test_a_motion_that_ends_faster_than_its_trap_can_catch_is_reported() -> None:
    boards, times = midair.Array.preset("openmpd_pair", quantization={}), np.arange(0, 0.0101, 1e-3)
    path = midair.path.from_array((200 * times**2)[:, None, None] * [1, 0, 0], rate=1e3)
    with (
        pytest.warns(midair.SceneWarning, match="m/s needs .* rad a frame"),
        pytest.warns(midair.SceneWarning, match=r"point 1 ends at 3\.8 m/s in frame 10, faster than its trap"),
    ):
        midair.sequence(boards, path, rate=1e3, signature="trap")


@pytest.mark.parametrize(("radius", "density"), [(0.1e-3, 29.0), (0.2e-3, 29.0), (1e-3, 2.0), (0.5e-3, 5.0)])
def test_a_light_bead_rests_in_a_weak_trap(radius: float, density: float) -> None:
    # The drag of such a bead takes more of its velocity in a millisecond than a bead of polystyrene loses.
    full = midair.Array.preset("openmpd_pair")
    boards = midair.Array.preset("openmpd_pair", quantization={}, source_pressure=0.15 * full.source_pressure)
    still = midair.path.from_array(np.zeros((10, 1, 3)), rate=1000, closed=True)
    sequence = midair.sequence(boards, still, rate=1000, signature="trap", temperature=25)
    bead = {"radius": radius, "density": density}
    flight = midair.fly(sequence, [[20e-6, 0, 0]], bead=bead, duration=0.5)
    assert flight.held.all()
    assert np.abs(flight.places[-100:] - flight.places[-1]).max() < 1e-7


@pytest.mark.parametrize(("radius", "density"), [(1e-3, 29.0), (0.6e-3, 20.0)])
def test_a_bead_is_weighed_by_how_it_rings(radius: float, density: float) -> None:
    boards, bead = midair.Array.preset("openmpd_pair"), midair.Bead(radius=radius, density=density)
    scene = midair.Scene(boards, [[0, 0, 0]], signature="trap", temperature=25, bead=bead)
    still = midair.path.from_array(np.zeros((10, 1, 3)), rate=1000, closed=True)
    sequence = midair.sequence(boards, still, rate=1000, signature="trap", temperature=25, bead=bead)
    place = midair.fly(sequence, duration=0.01).places[0, 0]
    flight = midair.fly(sequence, place + np.array([[0, 0, 1e-5]]), speeds=[[0, 0, 0]], duration=0.1)
    swing = flight.places[:, 0, 2] - place[2]
    # The number whose powers are the oscillation e^(-t/T) cos(2 pi f t), by linear prediction.
    sums, last = np.stack([swing[1:-1], swing[:-2]], axis=1), swing[2:]
    whole = np.roots([1, *-np.linalg.lstsq(sums, last, rcond=None)[0]])[0]
    apart = flight.times[1] - flight.times[0]
    frequency, ring_down = abs(np.angle(whole)) / (2 * np.pi * apart), -apart / np.log(abs(whole))
    solution = midair.solve(scene.replace(bead=None))
    found = midair.weigh(solution, frequency, ring_down)
    assert found.radius == pytest.approx(radius, rel=0.05)
    assert found.density == pytest.approx(density, rel=0.05)
    with pytest.raises(midair.SceneError, match=r"frequency is 5\.0: no bead"):
        midair.weigh(solution, 5, 0.01)
