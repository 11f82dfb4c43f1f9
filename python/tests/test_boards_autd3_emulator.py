"""In the makers' emulator, AUTD3 boards play a drive's phases and pulses; their field is midair's."""

import math

import autd3
import numpy as np
import pytest
from autd3.commands import FixedUpdateRate, SetSilencer
from autd3_emulator import Emulator, Grid, Record, Recorder, RmsRecordOption

import midair
from autd3_boards import codes, frame, played, some_boards, some_poses, widths
from autd3_makers import OLDER, do, geometry
from midair._boards import autd3_commands as commands

#: The emulator's boards are put together by hand, in its air of 340 m/s.
pytestmark = pytest.mark.filterwarnings("ignore:array.positions are those of boards")

#: One sample of a record is a period of the ultrasound.
PERIOD = autd3.Duration.from_micros(25)
#: Solutions for each number of boards; a hundred in all.
SOLUTIONS = 25


def solutions(array: midair.Array, count: int, seed: int) -> list[midair.Solution]:
    """Returns solutions for random points, half of them with the board's phases and amplitudes;
    some transducers are dead.
    """
    rng = np.random.default_rng(seed)
    points = rng.uniform([-60, -60, 120], [60, 60, 220], (count, 3, 3)) * 1e-3
    board = {"phases": 256, "amplitudes": np.arange(256) / 255}
    grids = [None, board]
    scenes = [midair.Scene(array, at) for at in points]
    mask = np.arange(len(array)) % 50 > 0
    return [midair.solve(scene, "naive", quantization=grids[i % 2], mask=mask) for i, scene in enumerate(scenes)]


def at_once(recorder: Recorder) -> None:
    """Lets phases and intensities change at once: the default silencer takes 1 ms and 250 us."""
    recorder.send(SetSilencer(FixedUpdateRate(65535, 65535)))


def columns(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Returns phases and pulse widths, each (samples, transducers)."""
    return record.phase().to_numpy().T, record.pulse_width().to_numpy().T


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_boards_play_the_codes_of_solutions(count: int) -> None:
    array = some_boards(count)
    drives = [solution.drive for solution in solutions(array, SOLUTIONS, count)]
    board = midair.Board("autd3", array)

    def play(recorder: Recorder) -> None:
        at_once(recorder)
        for drive in drives:
            do(recorder, commands.pattern(board.encode(drive), count, OLDER))
            recorder.tick(PERIOD)

    phases, pulses = columns(Emulator(geometry(some_poses(count))).record(play))
    wanted = [codes(drive) for drive in drives]
    assert np.array_equal(phases, [phase.ravel() for phase, _ in wanted])
    assert np.array_equal(pulses, [widths(intensity).ravel() for _, intensity in wanted])
    # Every phase occurs, and so do zero, low and full amplitudes.
    assert len(np.unique(phases)) == 256
    assert {0, 20, 256} <= set(pulses.ravel().tolist())


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_their_field_is_that_of_the_drive(count: int) -> None:
    array = some_boards(count)
    (drive,) = (solution.drive for solution in solutions(array, 2, 20 + count)[1:])

    def play(recorder: Recorder) -> None:
        at_once(recorder)
        do(recorder, commands.pattern(frame(drive), count, OLDER))
        recorder.tick(autd3.Duration.from_millis(1))

    record = Emulator(geometry(some_poses(count))).record(play)
    option = RmsRecordOption(340.0 * autd3.units.m / autd3.units.s)
    rms = record.sound_field(Grid((-80, 80), (-80, 80), 160.0, 5.0, "xyz"), option)
    points = 1e-3 * rms.observe_points().to_numpy().astype(float)
    received = rms.next(autd3.Duration.from_millis(1)).to_numpy()[:, -1].astype(float)
    assert len(received) == 33 * 33
    assert received.max() > 200

    scene = midair.Scene(array, [[0, 0, 0.16]])

    def apart(pulses: bool) -> float:
        """Returns the relative L2 difference between the emulator's field and midair's."""
        ours = np.abs(midair.field(scene, played(drive, pulses=pulses), points).pressure) / math.sqrt(2)
        return float(np.linalg.norm(received - ours) / np.linalg.norm(ours))

    assert apart(pulses=False) < 2.5e-3
    assert apart(pulses=True) < 1e-4


@pytest.mark.slow
def test_a_sequence_plays_over_and_over() -> None:
    array = some_boards(2)
    drives = [solution.drive for solution in solutions(array, 7, 31)]
    frames = b"".join(frame(drive) for drive in drives)

    def play(recorder: Recorder) -> None:
        at_once(recorder)
        do(recorder, *commands.sequence(frames, len(drives), 2, 3, 1, OLDER))
        recorder.tick(autd3.Duration.from_micros(25 * 3 * 7 * 3))

    phases, pulses = columns(Emulator(geometry(some_poses(2))).record(play))
    wanted = [(phase.tobytes(), widths(intensity).tobytes()) for phase, intensity in map(codes, drives)]
    seen = [
        wanted.index((phase.tobytes(), pulse.astype(np.int64).tobytes()))
        for phase, pulse in zip(phases, pulses, strict=True)
    ]
    changes = [i for i in range(1, len(seen)) if seen[i] != seen[i - 1]]
    assert all((seen[i] - seen[i - 1]) % 7 == 1 for i in changes)
    assert set(np.diff(changes)) == {3}
    assert set(seen) == set(range(7))


@pytest.mark.parametrize("divider", [1, 3, 20, 40, 400])
def test_the_silencer_lets_a_sequence_reach_every_frame(divider: int) -> None:
    rng = np.random.default_rng(41)
    # The emulator's silencer fails for phases that pass the end of the cycle; these phases do not.
    turns = rng.integers(64, 192, (4, 249)) / 256
    drives = list(rng.uniform(0, 1, (4, 249)) * np.exp(2j * math.pi * turns))

    def play(recorder: Recorder) -> None:
        do(recorder, commands.silencer(divider))
        do(recorder, *commands.sequence(b"".join(map(frame, drives)), 4, 1, divider, 1, OLDER))
        recorder.tick(autd3.Duration.from_micros(25 * divider * 4 * 3))

    phases, pulses = columns(Emulator(geometry(some_poses(1))).record(play))
    for phase, intensity in map(codes, drives):
        reached = (phases == phase).all(axis=1) & (pulses == widths(intensity)).all(axis=1)
        assert reached.sum() == 3 * max(1, divider - 39)


def test_the_silencer_of_single_frames_is_the_default_one() -> None:
    """Checks that a phase takes 1 ms to change and an intensity 250 us, both without a jump."""
    array = some_boards(1)
    before, after = (solution.drive for solution in solutions(array, 2, 51))

    def play(recorder: Recorder) -> None:
        do(recorder, commands.silencer(40))
        for drive in (before, after):
            do(recorder, commands.pattern(frame(drive), 1, OLDER))
            recorder.tick(autd3.Duration.from_millis(2))

    phases, pulses = columns(Emulator(geometry(some_poses(1))).record(play))
    phase, intensity = codes(after)
    assert np.array_equal(phases[80 + 40], phase.ravel())
    assert np.array_equal(pulses[80 + 10], widths(intensity).ravel())
    steps = np.diff(phases[80:].astype(int), axis=0)
    assert np.abs((steps + 128) % 256 - 128).max() <= 5


@pytest.mark.parametrize("hz", [137.5, 200.0])
def test_modulation_multiplies_the_pressure(hz: float) -> None:
    samples = round(40000 / hz * 4)

    def play(recorder: Recorder) -> None:
        at_once(recorder)
        do(recorder, *commands.modulation(hz))
        do(recorder, commands.pattern(frame(np.ones(249)), 1, OLDER))
        recorder.tick(autd3.Duration.from_micros(25 * samples))
        do(recorder, *commands.modulation(None))
        recorder.tick(autd3.Duration.from_millis(1))

    _, pulses = columns(Emulator(geometry(some_poses(1))).record(play))
    assert (pulses[-1] == 256).all()
    amplitude = np.sin(math.pi * pulses[:samples, 0] / 512)
    spectrum = np.fft.rfft(amplitude) / samples
    # The record has four periods of 0.5 (1 + sin); each value has 8 bits and lasts ten samples.
    assert abs(spectrum[0]) == pytest.approx(0.5, abs=5e-3)
    assert 2 * abs(spectrum[4]) == pytest.approx(0.5, abs=5e-3)
    assert np.abs(np.delete(spectrum[1:8], 3)).max() < 5e-3
