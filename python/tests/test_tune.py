"""Tuning with readings: their number, options, and the best drive, which is kept however the tuning ends."""

import os
import runpy
import signal
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from microphones import Rig


class Reader:
    """A simulated microphone at each point of a scene, with noise."""

    def __init__(self, rig: Rig, decibels: float | None = None) -> None:
        self.matrix = rig.matrix(rig.new)
        self.sd = 0.0 if decibels is None else rig.level() * 10 ** (-decibels / 20)
        self.rng = np.random.default_rng(rig.seed)
        self.count = 0

    def __call__(self, drive: Any) -> Any:
        self.count += 1
        return np.abs(np.abs(self.matrix @ drive) + self.sd * self.rng.normal(size=len(self.matrix)))

    def level(self, drive: Any) -> tuple[float, float]:
        """Returns two ratios: a drive's mean pressure to the mean of the best drive for the true model,
        and the lowest to the highest pressure.
        """
        best = np.abs(self.matrix @ midair.solve(midair.Propagation(self.matrix), "uniform").drive).mean()
        p = np.abs(self.matrix @ drive)
        return float(p.mean() / best), float(p.min() / p.max())


def scene(rig: Rig) -> midair.Scene:
    return midair.Scene(rig.array, rig.new)


@pytest.mark.parametrize("phases", [4, 16])
def test_three_readings_choose_as_all_tries_do(phases: int) -> None:
    rig = Rig(31)
    three, tries = Reader(rig), Reader(rig)
    found = midair.tune(three, scene(rig), "greedy", phases=phases)
    every = midair.tune(tries, scene(rig), "greedy", phases=phases, tries=True)
    assert (three.count, found.readings) == (3 * 256, 3 * 256)
    assert tries.count == phases * 256
    assert np.array_equal(found.drive, every.drive)
    assert found.status == "done"
    assert np.allclose(found.pressures, np.abs(three.matrix @ found.drive), rtol=1e-4)
    assert found.value == found.trace.min()


def test_greedy_is_the_double_precision_search() -> None:
    rig = Rig(32)
    reader, targets = Reader(rig), np.full(4, 6000.0)
    found = midair.tune(reader, rig.array, "greedy", targets=targets, seed=5)
    drive = np.zeros(256, complex)
    candidates = np.exp(2j * np.pi * np.arange(16) / 16)
    for index in np.random.default_rng(5).permutation(256):
        p = reader.matrix @ drive + reader.matrix[:, index] * candidates[:, None]
        energy = np.sum((targets - np.abs(p)) ** 2, axis=1) / np.sum(targets**2)
        drive[index] = candidates[np.flatnonzero(energy <= energy.min() + 1e-7)[0]]
    assert np.abs(found.drive - drive).max() < 1e-5


def test_from_the_models_answer() -> None:
    kept = []
    for seed in (33, 34):
        rig = Rig(seed)
        reader = Reader(rig, 60)
        kept.append(reader.level(midair.tune(reader, scene(rig), start="model").drive)[0])
    assert np.mean(kept) > 0.96


def test_feedback_evens_out_in_ten_drives() -> None:
    before, after = [], []
    for seed in (35, 36, 37):
        rig = Rig(seed)
        reader = Reader(rig, 40)
        before.append(reader.level(midair.solve(scene(rig), "uniform").drive)[1])
        found = midair.tune(reader, scene(rig), "feedback")
        assert found.readings == 10
        after.append(reader.level(found.drive)[1])
    assert np.mean(before) < 0.95
    assert np.mean(after) > 0.97


def test_feedback_stays_at_one_even_field_of_foci_near_each_other() -> None:
    simulated = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "microphone.py"))["simulated"]
    foci = [[x, y, 0.15] for x in (-0.02, 0.02) for y in (-0.02, 0.02)]
    near = midair.Scene(midair.Array.grid(16, 16, 10e-3), foci)
    for seed in range(6):
        found = midair.tune(simulated(near, seed), near, "feedback")
        assert found.pressures.min() > 0.99 * found.pressures.max()


def test_spsa_gains_level() -> None:
    rig = Rig(38)
    reader = Reader(rig, 60)
    model = reader.level(midair.solve(scene(rig), "uniform").drive)[0]
    assert reader.level(midair.tune(reader, scene(rig), "spsa").drive)[0] > model + 0.02


def test_powers_and_boards() -> None:
    array = midair.Array.preset("sonicsurface")
    places = [[-0.02, 0, 0.15], [0.02, 0, 0.15]]
    matrix = midair.Scene(array, places).propagation()
    found = midair.tune(lambda drive: np.abs(matrix @ drive) ** 2, midair.Scene(array, places), power=True)
    codes = np.angle(found.drive) * 32 / (2 * np.pi)
    assert np.abs(codes - codes.round()).max() < 1e-4
    assert found.value < 0.05
    with pytest.raises(midair.SceneError, match="phases is 12: the board has 32"):
        midair.tune(lambda drive: np.abs(matrix @ drive), midair.Scene(array, places), phases=12)


def test_a_budget_and_progress_keep_the_best() -> None:
    rig = Rig(39)
    reader = Reader(rig)
    found = midair.tune(reader, scene(rig), budget=100)
    assert (found.status, found.readings, reader.count) == ("out_of_readings", 100, 100)
    assert 0 < np.count_nonzero(found.drive) <= 34
    found = midair.tune(reader, scene(rig), progress=lambda done, of: done < 50)
    assert (found.status, found.readings) == ("stopped", 50)


def test_a_reader_that_raises_keeps_the_best() -> None:
    rig = Rig(40)
    reader = Reader(rig)

    def read(drive: Any) -> Any:
        if reader.count == 60:
            raise OSError("unplugged\nnow")
        return reader(drive)

    with pytest.warns(midair.SceneWarning, match="read failed at reading 61: OSError: unplugged now; the best"):
        found = midair.tune(read, scene(rig))
    assert found.status == "failed"
    assert isinstance(found.error, OSError)
    assert np.count_nonzero(found.drive)


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        (np.full(4, np.nan), r"read\(drive\)\[0\] is nan"),
        (np.zeros(3), r"read\(drive\) is of shape \(3,\): give \|p\| at 4 places"),
        (np.full(4, -1.0), r"read\(drive\)\[0\] is -1.0"),
        (np.zeros(4, complex), r"read\(drive\) is of dtype complex128: give"),
    ],
)
def test_what_is_no_reading_is_refused(given: Any, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.tune(lambda drive: given, scene(Rig(41)))


@pytest.mark.parametrize("received", [0.0, 7.5])
@pytest.mark.parametrize("method", ["greedy", "feedback", "spsa"])
def test_a_dead_microphone_is_reported_once(method: Any, received: float) -> None:
    rig = Rig(44)
    reader = Reader(rig, 60)

    def read(drive: Any) -> Any:
        found = reader(drive)
        found[[2, 3]] = received, max(found[3], 1.0)
        return found

    with pytest.warns(midair.SceneWarning) as reported:
        found = midair.tune(read, scene(rig), method, budget=50)
    assert [str(one.message) for one in reported] == [
        f"read gave |p| = {received:g} at place 2 in all {found.readings} readings: "
        "a dead microphone, mend it or leave its point out"
    ]


def test_one_drive_says_nothing_of_a_microphone() -> None:
    # With a right model, "feedback" plays the same drive ten times: equal readings are then no fault.
    rig = Rig(45)
    model = scene(rig)
    received = model.propagation()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        midair.tune(lambda drive: np.round(np.abs(received @ drive)), model, "feedback")
    with pytest.warns(midair.SceneWarning, match=r"\|p\| = 0 at place 0 and 3 more in all 1 readings"):
        midair.tune(lambda drive: np.zeros(4), model, "feedback")


@pytest.mark.slow
def test_ctrl_c_keeps_the_best_within_half_a_second() -> None:
    rig = Rig(42)
    reader = Reader(rig)

    def read(drive: Any) -> Any:
        if reader.count == 30:
            time.sleep(20)
        return reader(drive)

    requested: list[float] = []

    def ask() -> None:
        requested.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.5, ask).start()
    found = midair.tune(read, scene(rig))
    assert time.monotonic() - requested[0] < 0.5
    assert (found.status, found.readings) == ("stopped", 30)


@pytest.mark.parametrize(
    ("keywords", "reported"),
    [
        ({"method": "guess"}, 'method is "guess": give one of greedy, feedback, spsa'),
        ({"targets": [1, 2]}, "targets is"),
        ({"start": "noise"}, 'start is "noise"'),
        ({"start": np.ones(3)}, "start is"),
        ({"budget": 0}, "budget is 0"),
        ({"method": "spsa", "start": "silence"}, "spsa turns phases"),
        ({"phases": 1}, "phases is 1"),
    ],
)
def test_arguments_are_refused(keywords: dict[str, Any], reported: str) -> None:
    rig = Rig(43)
    with pytest.raises(midair.SceneError, match=reported):
        midair.tune(Reader(rig), scene(rig), **keywords)
    with pytest.raises(midair.SceneError, match="targets are left out"):
        midair.tune(Reader(rig), rig.array)
