"""Calibration from few readings, noisy ones, or misplaced microphones: the stated errors are right."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import midair

PITCH = 10.16e-3


def board() -> NDArray[np.float64]:
    """Returns the positions (249, 3) of an AUTD3 board's transducers in m."""
    x, y = np.meshgrid(np.arange(18), np.arange(14))
    kept = ~((y == 1) & np.isin(x, [1, 2, 16]))
    return np.c_[PITCH * x[kept], PITCH * y[kept], np.zeros(kept.sum())]


def rig(seed: int, decibels: float, dead: int, off: float) -> dict[str, Any]:
    """Returns a board with gain errors of 10 % and phase errors of 20 degrees, and readings of four
    microphones.

    The microphones are misplaced by `off`. The readings are |sum of 4.386/r e^{jkr} x q|, with x the response
    and q the drive of a transducer. The noise is `decibels` below the level of four foci.
    """
    random = np.random.default_rng(seed)
    places, speed = board(), random.uniform(335, 351)
    n = len(places)
    response = (1 + 0.1 * random.normal(size=n)) * np.exp(0.35j * random.normal(size=n))
    silent = np.sort(random.permutation(n)[:dead])
    response[silent] = 0
    corners = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]]) * 0.03 + random.uniform(-0.015, 0.015, (4, 2))
    microphones = places.mean(axis=0) + np.c_[corners, random.uniform(0.14, 0.18, 4)]
    r = np.linalg.norm(microphones[:, None] - places, axis=2)
    waves = 4.386 / r * np.exp(2j * np.pi * 40e3 / speed * r) * response
    drives = np.exp(2j * np.pi * random.integers(0, 256, (n, n)) / 256)
    p = np.abs(drives @ waves.T)
    noise = np.abs(waves).sum(axis=1).mean() / 2 * 10 ** (-decibels / 20)
    readings = np.abs(p + noise * random.normal(size=p.shape))
    believed = microphones + off * random.normal(size=microphones.shape)
    found = midair.calibrate(midair.Array(places), drives, readings, microphones=believed)
    aligned = response * np.exp(-1j * np.angle(response.sum()))
    return {"found": found, "dead": silent, "speed": speed, "response": aligned, "microphones": microphones}


def within(values: Any, errors: Any) -> float:
    """Returns the part of the values that are within two of their standard errors."""
    return float(np.mean(np.abs(values) <= 2 * errors))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_dead_transducers_are_named_in_noise(seed: int) -> None:
    made = rig(seed, decibels=30, dead=37, off=0)
    found = made["found"]
    assert len(np.setdiff1d(found.dead, made["dead"])) == 0
    assert len(found.dead) >= 15


@pytest.mark.slow
@pytest.mark.parametrize("off", [0.0, 0.5e-3, 1e-3, 2e-3])
def test_stated_errors_hold_wherever_the_microphones_are(off: float) -> None:
    speeds, places, responses = [], [], []
    for seed in range(4):
        made = rig(10 + seed, decibels=40, dead=8, off=off)
        found = made["found"]
        speeds.append(abs(found.sound_speed - made["speed"]) / found.sound_speed_error)
        places.append(within(found.microphones - made["microphones"], found.microphones_error))
        apart = found.response - made["response"]
        responses.append(within(np.r_[apart.real, apart.imag], np.tile(found.response_error, 2)))
        assert found.dead.tolist() == made["dead"].tolist()
    assert max(speeds) < 3
    assert np.mean(places) >= 0.85
    assert np.mean(responses) >= 0.9


@pytest.mark.slow
def test_noise_as_loud_as_the_readings_lets_nothing_be_dead_or_reversed() -> None:
    with pytest.warns(midair.SceneWarning, match="readings are off the model by"):
        found = rig(20, decibels=20, dead=0, off=0)["found"]
    assert len(found.dead) == 0
    assert 0.6 < found.gain.mean() < 1.5


@pytest.mark.slow
def test_microphones_whose_error_is_0_are_kept() -> None:
    made = rig(21, decibels=40, dead=0, off=0)
    array = midair.Array(board())
    drives = midair.calibration_drives(array, 2)
    readings = np.abs(drives @ midair.Scene(array, made["microphones"]).propagation().T)
    found = midair.calibrate(array, drives, readings, microphones=made["microphones"], microphones_error=0)
    assert np.array_equal(found.microphones, made["microphones"])
    assert not found.microphones_error.any()
