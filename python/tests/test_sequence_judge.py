"""Metrics of sequences: pressures, changes, envelopes, forces and noise, against plain loops and formulas."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import midair
import oracle
from midair._sequence import drives
from midair._sequence.felt import a_weighting, threshold
from scenes import GAIN, same_bits

RATE, TAU, FRAMES = 10e3, 0.2e-3, 12
ARRAY = midair.Array.grid(6, 6, pitch=0.01)
SPOT = np.array([0.004, -0.003, 0.12])


def circles(frames: int = FRAMES) -> np.ndarray[Any, Any]:
    """Returns three points (T, 3, 3) on circles of different radii, at a height of 0.15 m."""
    angle = 2 * np.pi * (np.arange(frames)[:, None] / frames + np.arange(3) / 3)
    radius = np.array([0.01, 0.015, 0.02])
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(angle.shape, 0.15)], axis=-1)


def wild(frames: int = FRAMES, seed: int = 3) -> np.ndarray[Any, Any]:
    """Returns drives of random phases, with the amplitudes 0, 0.5 and 1."""
    rng = np.random.default_rng(seed)
    phases = rng.uniform(-np.pi, np.pi, (frames, len(ARRAY)))
    return rng.choice([0, 0.5, 1, 1], phases.shape) * np.exp(1j * phases)


def made(drives: Any = None, **given: Any) -> midair.Sequence:
    """Returns a sequence of points on circles, with the drives of `wild` unless others are given."""
    drives = wild() if drives is None else drives
    setting = {"array": ARRAY, "points": circles(len(drives)), "targets": 500.0, "rate": RATE} | given
    return midair.Sequence(drives=drives, **setting)


def single(drives: Any, **given: Any) -> midair.Sequence:
    """Returns a sequence of one transducer and one point at rest.
    |p| is 4.386 / 0.1 times |y|, where y is the transducer's output.
    """
    points = np.broadcast_to([0.0, 0.0, 0.1], (len(drives), 1, 3))
    setting = {"targets": 1.0, "rate": RATE} | given
    return midair.Sequence(midair.Array([[0, 0, 0]]), points, drives=np.reshape(drives, (-1, 1)), **setting)


def gains(places: Any, **medium: Any) -> np.ndarray[Any, Any]:
    return oracle.propagation(ARRAY.positions, np.reshape(places, (-1, 3)), **medium)


def turned(new: complex, old: complex) -> float:
    return 0.0 if 0 in (new, old) else abs(np.angle(complex(new) * complex(old).conjugate()))


@pytest.mark.parametrize("closed", [False, True])
def test_pressures_and_changes_are_those_of_plain_loops(closed: bool) -> None:
    sequence, drives, points = made(closed=closed, sound_speed=343.0, absorption=0.2), wild(), circles()
    expected = [abs(gains(points[t], sound_speed=343.0, absorption=0.2) @ drives[t]) for t in range(FRAMES)]
    assert sequence.pressures == pytest.approx(np.array(expected), abs=GAIN * np.max(expected))
    pairs = [(t, t - 1 if t or closed else t) for t in range(FRAMES)]
    changes = [max(turned(q, p) for q, p in zip(drives[new], drives[old], strict=True)) for new, old in pairs]
    assert sequence.changes == pytest.approx(changes, abs=1e-6)
    assert sequence.times == pytest.approx(np.arange(FRAMES) / RATE)
    assert sequence.radiation == pytest.approx(sequence.pressures**2 / (1.223 * 343.0**2))
    assert (sequence.metrics.seam is None) != closed


def test_codes_are_phases_and_their_changes_whole_steps() -> None:
    codes = np.random.default_rng(1).integers(0, 256, (FRAMES, 36))
    array = midair.Array.grid(6, 6, pitch=0.01, mask=np.arange(36) != 7, quantization={"phases": 256})
    sequence = made(codes, array=array, closed=True)
    assert sequence.codes is not None
    assert sequence.codes.dtype == np.uint8
    assert np.array_equal(sequence.codes, codes)
    drives = np.exp(2j * np.pi * codes / 256) * (np.arange(36) != 7)
    assert sequence.drives == pytest.approx(drives, abs=1e-6)
    same = made(drives, array=array, closed=True)
    assert same.codes is None
    # A transducer that is masked off plays nothing, whatever its drive.
    assert made(drives + (np.arange(36) == 7), array=array, closed=True) == same
    assert sequence.pressures == pytest.approx(same.pressures, rel=1e-5)
    assert sequence.changes == pytest.approx(same.changes, abs=1e-6)
    steps = sequence.each_change(0, FRAMES) * 256 / (2 * np.pi)
    assert steps == pytest.approx(np.round(steps), abs=1e-4)
    assert (steps[:, 7] == 0).all()
    assert made(codes * 7, quantization={"phases": 2000}).codes.dtype == np.uint16


def test_blocks_leave_no_trace(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, closed = made(), made(closed=True)
    before = [one.judge(TAU, hold=hold) for one in (whole, closed) for hold in ("hold", "linear")]
    inside = whole.between(TAU, substeps=5).pressures
    monkeypatch.setattr(drives, "BLOCK", 100)
    monkeypatch.setattr("midair._sequence.drives.BLOCK", 100)
    parts, others = made(), made(closed=True)
    assert same_bits(parts.changes, whole.changes)
    assert parts.pressures == pytest.approx(whole.pressures, rel=1e-5)
    assert parts.between(TAU, substeps=5).pressures == pytest.approx(inside, rel=1e-4)
    after = [one.judge(TAU, hold=hold) for one in (parts, others) for hold in ("hold", "linear")]
    for one, other in zip(before, after, strict=True):
        numbers = [{k: v for k, v in m.asdict().items() if v is not None} for m in (one, other)]
        assert numbers[0] == pytest.approx(numbers[1], rel=1e-4)


def test_metrics_are_those_of_plain_loops_over_the_points_that_are_there() -> None:
    targets = np.full((FRAMES, 3), 400.0)
    targets[3:6, 1], targets[8], targets[:, 2] = 0, 0, 250
    targets[8] = 0
    sequence = made(targets=targets, closed=True)
    ratio = [
        [p / t for p, t in zip(ps, ts, strict=True) if t > 0]
        for ps, ts in zip(sequence.pressures, targets, strict=True)
    ]
    received = [x for x in ratio if x]
    assert len(received) == FRAMES - 1
    metrics = sequence.metrics
    assert metrics.level == pytest.approx(np.mean([np.mean(x) for x in received]))
    assert metrics.uniformity == pytest.approx(min(min(x) / max(x) for x in received))
    assert metrics.uniformity_median == pytest.approx(np.median([min(x) / max(x) for x in received]))
    own = [[sequence.pressures[t, j] / targets[t, j] for t in range(FRAMES) if targets[t, j]] for j in range(3)]
    assert metrics.dip == pytest.approx(min(min(x) / np.mean(x) for x in own))
    assert metrics.largest_change == pytest.approx(max(sequence.changes[1:]))
    assert metrics.seam == pytest.approx(sequence.changes[0])
    assert list(metrics.asdict()) == [line.split()[0] for line in repr(metrics).splitlines()]
    assert repr(metrics) in sequence.summary


def euler(drives: Any, hold: str, closed: bool, tau: float, fine: int = 4000) -> np.ndarray[Any, Any]:
    """Integrates y' = (q - y)/tau with `fine` steps per frame; returns y (4 T, N), four times per frame."""
    count, step = len(drives), 1 / (RATE * fine)
    following = [(t + 1) % count if closed else min(t + 1, count - 1) for t in range(count)]
    laps, y, taken = 3 if closed else 1, np.array(drives[0], complex), []
    for _ in range(laps):
        taken = []
        for t in range(count):
            now, then = drives[t], drives[following[t]]
            angle = np.angle(then * now.conj())
            for k in range(fine):
                if k % (fine // 4) == 0:
                    taken.append(y)
                share = (k + 0.5) / fine if hold == "linear" else 0.0
                size = abs(now) + share * (abs(then) - abs(now))
                phase = np.angle(np.where(now == 0, then, now)) + share * angle
                y = y + step / tau * (size * np.exp(1j * phase) - y)
    return np.array(taken)


@pytest.mark.slow
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("hold", ["hold", "linear"])
def test_pressures_inside_the_frames_solve_the_equation_of_the_transducers(hold: Any, closed: bool) -> None:
    drives, points, tau = wild(4), circles(4), 0.04e-3
    y = euler(drives, hold, closed, tau)
    expected = []
    for s in range(16):
        t, share = divmod(s, 4)
        then = points[(t + 1) % 4] if closed else points[min(t + 1, 3)]
        expected.append(abs(gains(points[t] + share / 4 * (then - points[t])) @ y[s]))
    times, got = made(drives, closed=closed).between(tau, hold, 4)
    assert times == pytest.approx(np.arange(16) / (4 * RATE))
    assert got == pytest.approx(np.array(expected), abs=1e-3 * np.max(expected))


def test_a_closed_sequence_slower_than_its_transducers_is_steady_from_its_start() -> None:
    drives = np.exp(2j * np.pi * np.arange(16) / 16)
    # A lap lasts three time constants, so the state at the end of the last lap has an effect.
    tau = 16 / RATE / 3
    _, once = single(drives, closed=True).between(tau, substeps=1)
    _, thrice = single(np.tile(drives, 3), closed=True).between(tau, substeps=1)
    assert thrice[32:] == pytest.approx(once, rel=1e-5)


@pytest.mark.parametrize("angle", [np.pi, np.pi / 2, np.pi / 4, np.pi / 16])
def test_one_phase_step_goes_through_the_cosine_of_its_half(angle: float) -> None:
    # Two sub-steps per frame, the first of them tau ln 2 long.
    sequence = single([1, np.exp(1j * angle)], rate=1 / (2 * TAU * np.log(2)))
    _, inside = sequence.between(TAU, substeps=2)
    assert inside[:, 0] * 0.1 / 4.386 == pytest.approx([1, 1, 1, np.cos(angle / 2)], abs=2e-6)


@pytest.mark.parametrize(("steps", "reported"), [(32, 0.931), (64, 0.981)])
def test_a_steady_rate_costs_pressure(steps: int, reported: float) -> None:
    sequence = single(np.exp(2j * np.pi * np.arange(steps) / steps), closed=True)
    _, linear = sequence.between(TAU, "linear", 3)
    rate = 2 * np.pi / steps * RATE
    assert linear * 0.1 / 4.386 == pytest.approx(1 / np.sqrt(1 + (rate * TAU) ** 2), rel=1e-5)
    assert sequence.between(TAU, substeps=8).pressures.mean() * 0.1 / 4.386 == pytest.approx(reported, abs=2e-3)


def test_without_an_envelope_drives_are_what_is_radiated() -> None:
    sequence = made()
    assert same_bits(sequence.between(0, substeps=1).pressures, sequence.pressures)
    assert sequence.between(0, "linear", 3).pressures[::3] == pytest.approx(sequence.pressures, rel=1e-4)
    _, turning = single([1, 1j, 1j]).between(0, "linear", 4)
    assert turning * 0.1 / 4.386 == pytest.approx(1, abs=1e-6)
    _, fading = single([0, 1j, 0]).between(0, "linear", 4)
    assert fading[:, 0] * 0.1 / 4.386 == pytest.approx([0, 0.25, 0.5, 0.75, 1, 0.75, 0.5, 0.25, 0, 0, 0, 0])


def test_cold_frames_jump_and_motion_tells() -> None:
    array, points = midair.Array.grid(12, 12, pitch=0.01), circles(60)
    solver = midair.Solver(array, "uniform")
    drives = [solver(frame, 500.0).drive for frame in points]
    sequence = midair.Sequence(array, points, 500.0, drives, rate=RATE, closed=True, solver="uniform")
    still, moving = sequence.metrics, sequence.judge(TAU)
    assert still.uniformity > 0.99
    assert still.largest_change > 2
    assert moving.uniformity < still.uniformity
    assert moving.dip < still.dip
    assert moving.noise == still.noise > sequence.judge(TAU, hold="linear").noise


def modulated(
    shape: Callable[[Any], Any], frequency: float = 200, rate: float = RATE, closed: bool = True
) -> midair.Sequence:
    """Returns a focus at a point for 0.1 s; the amplitude of all transducers is a function of the cosine."""
    frames = round(rate / 10)
    focus = np.conj(gains(SPOT)[0] / abs(gains(SPOT)[0]))
    amplitudes = shape(np.cos(2 * np.pi * frequency * np.arange(frames) / rate))
    points = np.broadcast_to(SPOT, (frames, 1, 3))
    return made(amplitudes[:, None] * focus, points=points, rate=rate, closed=closed)


def test_amplitude_modulation_has_three_eighths_or_half_of_the_force() -> None:
    full = np.abs(gains(SPOT)).sum() ** 2 / (1.223 * 340**2)
    plain, root = (
        modulated(shape).felt(SPOT, bands=[(5, 50), (50, 250), (50, 500)])
        for shape in (lambda c: (1 + c) / 2, lambda c: np.sqrt((1 + c) / 2))
    )
    assert plain.static == pytest.approx(3 / 8 * full, rel=GAIN)
    assert root.static == pytest.approx(full / 2, rel=GAIN)
    # (1 + c)^2/4 = 3/8 + c/2 + cos(2wt)/8 has two lines, and (1 + c)/2 has one.
    assert plain.rms == pytest.approx(full * np.array([0, 0.5, np.hypot(0.5, 0.125)]) / np.sqrt(2), abs=1e-3)
    assert root.rms == pytest.approx(full * np.array([0, 0.5, 0.5]) / np.sqrt(2), abs=1e-3)
    assert root.frequencies[np.argmax(root.spectrum[1:]) + 1] == 200
    assert root.unit == "Pa"


@pytest.mark.parametrize("speed", [1, 3.7, 12])
@pytest.mark.parametrize("radius", [0.002, 0.01, 0.05])
def test_laps_of_any_rate_have_their_lines_in_the_bands(radius: float, speed: float) -> None:
    ring = midair.path.circle(SPOT, radius, speed=speed)
    points, _ = ring.frames(RATE)
    drives = np.conj(gains(points.reshape(-1, 3)))
    sequence = midair.Sequence(ARRAY, points, 1.0, drives / abs(drives), rate=RATE, closed=True)
    felt = sequence.felt(SPOT + np.array([radius, 0, 0]))
    lap = RATE / len(points)
    for (low, high), rms in zip(felt.bands, felt.rms, strict=True):
        inside = [f for f in felt.frequencies if low <= f < high]
        assert (rms > 0) == bool(inside)
        assert not inside or inside[0] / lap == pytest.approx(round(inside[0] / lap))
    # A band above half the frame rate has no line.
    assert sequence.felt(SPOT, bands=[(RATE, 2 * RATE)]).rms == [0]


def test_thresholds_are_those_of_verrillo() -> None:
    assert threshold([250, 125, 62.5]) == pytest.approx(1e-6 * 10 ** (np.array([-20, -8, 4]) / 20), rel=1e-3)
    assert np.isinf(threshold([0, 0.5, 1500])).all()
    found = modulated(lambda c: (1 + c) / 2).felt(SPOT)
    assert found.frequencies[np.argmin(found.thresholds)] == 250


def test_a_patch_feels_the_mean_of_its_places_and_its_area() -> None:
    patch, sequence = circles()[0], made()
    expected = [np.mean(abs(gains(patch) @ q) ** 2) / (1.223 * 340**2) for q in wild()]
    pressure, force = (sequence.felt(patch, area=area, bands=[(500, 5000)]) for area in (None, 2e-4))
    assert pressure.values == pytest.approx(np.array(expected), rel=1e-3)
    assert force.values == pytest.approx(1e3 * 2e-4 * np.array(expected), rel=1e-3)
    assert (force.unit, force.static) == ("mN", pytest.approx(0.2 * np.mean(expected), rel=1e-3))
    # The sum of the squared lines is the signal's power (Parseval).
    assert np.sqrt(np.sum(force.spectrum[1:] ** 2) / 2) == pytest.approx(np.std(force.values), rel=1e-9)
    # Transducers with a time constant of ten frames hardly follow the modulation.
    slow = sequence.felt(patch, bands=[(500, 5000)], tau=1e-3)
    assert np.std(slow.values) < 0.6 * np.std(pressure.values)


def test_a_weighting_is_that_of_the_standards_table() -> None:
    table = {20: -50.5, 100: -19.1, 200: -10.9, 400: -4.8, 1000: 0.0, 2000: 1.2, 4000: 1.0, 10000: -2.5}
    assert 20 * np.log10(a_weighting(np.array(list(table)))) == pytest.approx(list(table.values()), abs=0.15)


def test_noise_is_reported_beside_amplitude_modulation_at_200_hertz() -> None:
    def plain(c: Any) -> Any:
        return (1 + c) / 2

    # At this frame rate, the corners of the amplitude curve at the frames are inaudible.
    rate = 40e3
    assert modulated(plain, rate=rate).judge(TAU, hold="linear").noise == pytest.approx(0, abs=0.01)
    # At 400 Hz instead of 200 Hz, the second derivative is four times as large. The A-weighting of the first
    # line is 6.1 dB higher, of the second line 4.0 dB.
    left = [1 / np.hypot(1, 2 * np.pi * f * TAU) for f in (200, 400)]
    lines = [np.array([g / 2, g**2 / 2]) for g in left]
    received = [
        lines[0] * 10 ** (np.array([-10.85, -4.77]) / 20),
        4 * lines[1] * 10 ** (np.array([-4.77, -0.79]) / 20),
    ]
    louder = 20 * np.log10(np.linalg.norm(received[1]) / np.linalg.norm(received[0]))
    assert modulated(plain, 400, rate).judge(TAU, hold="linear").noise == pytest.approx(louder, abs=0.03)
    opened = modulated(plain, rate=rate, closed=False)
    assert opened.judge(TAU, hold="linear").noise == pytest.approx(0, abs=0.1)
    # Steps between frames at 10 kHz are audible, too.
    assert modulated(plain).judge(TAU).noise > 3
    assert single(np.ones(50)).metrics.noise == -200
    # A jump from the last frame to the first is heard if the sequence repeats.
    ramp, repeated = (single(np.linspace(0.5, 1, 50), closed=closed) for closed in (False, True))
    assert repeated.metrics.noise > ramp.metrics.noise + 20


NAN = np.full((FRAMES, 3, 3), np.nan)


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ({"points": NAN}, r"points\[0, 0, 0\] is nan: give finite"),
        ({"points": circles()[0]}, r"points is of shape \(3, 3\): give \(T, M, 3\)"),
        ({"points": circles(5)}, r"drives.shape\[0\] is 12: points have 5 frames"),
        ({"targets": [1.0, 2.0]}, r"targets is of shape \(2,\): give \(12, 3\)"),
        ({"targets": -1.0}, r"targets is -1.0: give numbers of at least 0"),
        ({"targets": 1j}, r"targets is 1j: give"),
        ({"targets": 0}, "targets are 0 everywhere"),
        ({"drives": 2 * wild()}, r"drives\[0, \d+\] is .*: give \|q\| of at most 1"),
        ({"drives": np.nan * wild()}, r"drives\[0, 0\] is .*: give \|q\| of at most 1"),
        ({"drives": wild()[:, :5]}, r"drives is of shape \(12, 5\): give \(T, 36\)"),
        ({"drives": np.ones((12, 36), int)}, "quantization is None: drives of whole numbers are phase codes"),
        (
            {"drives": np.full((12, 36), 9), "quantization": {"phases": 8}},
            "drives is 9: give codes from 0 to 7",
        ),
        ({"quantization": {"phases": 1}}, "quantization.phases is 1: give 2 to 65536"),
        ({"drives": np.ma.masked_less(wild().real, 0)}, "drives is masked in .*: fill"),
        ({"rate": 0}, "rate is 0: give a number above 0"),
        ({"rate": np.nan}, "rate is nan: give a finite number"),
        ({"change": -1.0}, "change is -1.0: give a number of at least 0"),
        ({"closed": 1}, "closed is 1: give true or false"),
        ({"density": -1.0}, "density"),
    ],
)
def test_what_is_no_sequence_is_refused_in_one_line(given: Any, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported) as error:
        made(**given)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("ask", "reported"),
    [
        (lambda s: s.between(-1.0), "tau is -1.0: give a number of at least 0"),
        (lambda s: s.between(TAU, "ramp"), 'hold is "ramp": give "hold" or "linear"'),
        (lambda s: s.between(TAU, substeps=0), "substeps is 0: give a whole number of at least 1"),
        (lambda s: s.judge(np.nan), "tau is nan"),
        (lambda s: s.felt([0, 0]), r"place is of shape \(2,\)"),
        (lambda s: s.felt([0, 0, np.inf]), r"place\[2\] is inf"),
        (lambda s: s.felt(ARRAY.positions[3], bands=[]), r"place\[0\] is 0.000e0 m from transducer 3"),
        (lambda s: s.felt(SPOT, bands=[(50, 20)]), r"bands\[0\] is \(50.0, 20.0\): give low < high"),
        (lambda s: s.felt(SPOT, bands=[5]), "bands is .*: give pairs"),
        (lambda s: s.felt(SPOT, area=0, bands=[]), "area is 0: give a number above 0"),
    ],
)
def test_what_cannot_be_requested_is_refused_in_one_line(ask: Callable[[Any], Any], reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported) as error:
        ask(made())
    assert "\n" not in str(error.value)


def test_a_point_on_a_transducer_is_named_by_frame_and_index() -> None:
    points = circles()
    points[7, 2] = ARRAY.positions[5]
    with pytest.raises(midair.SceneError, match=r"points\[7, 2\] is 0.000e0 m from transducer 5"):
        _ = made(points=points).pressures
    with pytest.raises(TypeError, match="no argument 'wind'"):
        made(wind=0.5)


def test_a_sequence_of_hours_is_refused_before_its_noise_takes_all_memory() -> None:
    with pytest.raises(MemoryError, match=r"noise needs .* MB of .* allowed: take a shorter part") as refused:
        made(wild(200), rate=0.01).judge()
    assert len(str(refused.value).splitlines()) == 1
