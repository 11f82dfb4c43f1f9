"""Outlying readings of a calibration: they are found, named and left out, and no other readings are."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import midair

ARRAY = midair.Array.grid(6, 6, 10e-3)
PLACES = np.array([[0, 0, 0.15], [0.05, 0.01, 0.2], [-0.03, -0.05, 0.18]])


def rig(seed: int, phased: bool) -> tuple[Any, Any, Any]:
    """Returns true responses (36,), drives (200, 36) and readings (200, 3) with 0.5 % of noise."""
    random = np.random.default_rng(seed)
    response = (1 + 0.1 * random.normal(size=36)) * np.exp(0.3j * random.normal(size=36))
    drives = np.exp(2j * np.pi * random.random((200, 36)))
    p = (drives * response) @ midair.Scene(ARRAY, PLACES, sound_speed=344).propagation().T
    scatter = 0.005 * np.sqrt(np.mean(np.abs(p) ** 2) / 2)
    p = p + scatter * (random.normal(size=p.shape) + 1j * random.normal(size=p.shape))
    return response, drives, p if phased else np.abs(p)


def off(found: midair.Calibration, response: NDArray[np.complex128]) -> float:
    """Returns the root mean square error of the responses, apart from a common phase."""
    turned = found.response * np.exp(-1j * np.angle(np.vdot(response, found.response)))
    return float(np.sqrt(np.mean(np.abs(turned - response) ** 2)))


SPOILT: dict[str, tuple[float, Callable[[Any], Any]]] = {
    "one ten times too large": (0, lambda values: 10 * values),
    "one a thousand times": (0, lambda values: 1000 * values),
    "one that is zero": (0, lambda values: 0 * values),
    "a tenth ten times too large": (0.1, lambda values: 10 * values),
    "a twentieth zero": (0.05, lambda values: 0 * values),
}


@pytest.mark.slow
@pytest.mark.parametrize("phased", [False, True])
@pytest.mark.parametrize("kind", SPOILT)
def test_outlying_readings_are_named_and_left_out(kind: str, phased: bool) -> None:
    part, spoil = SPOILT[kind]
    response, drives, readings = rig(4, phased)
    clean = midair.calibrate(ARRAY, drives, readings, microphones=PLACES)
    assert clean.outlying.shape == (0, 2)
    assert "left out" not in repr(clean)
    count = max(1, round(part * readings.size))
    places = np.sort(np.random.default_rng(1).choice(readings.size, count, replace=False))
    readings.flat[places] = spoil(readings.flat[places])
    with pytest.warns(midair.SceneWarning, match=rf"{count} of 600 readings lie far off .* left out: drive"):
        found = midair.calibrate(ARRAY, drives, readings, microphones=PLACES)
    assert np.array_equal(found.outlying, np.argwhere(np.isin(np.arange(600), places).reshape(200, 3)))
    assert off(found, response) < 0.004
    assert found.noise == pytest.approx(clean.noise, rel=0.1)
    assert f"{count} reading{'s' if count > 1 else ''} left out" in repr(found)
    assert np.abs(found.residuals[tuple(found.outlying.T)]).min() > 6 * found.noise


@pytest.mark.slow
def test_a_model_that_is_wrong_has_no_outlying_readings() -> None:
    _, drives, readings = rig(5, phased=False)
    mixed = np.random.default_rng(0).permutation(readings)
    with pytest.warns(midair.SceneWarning, match="are off the model by"):
        found = midair.calibrate(ARRAY, drives, mixed, microphones=PLACES, sound_speed_error=0)
    assert len(found.outlying) < 0.2 * readings.size


@pytest.mark.slow
def test_what_was_left_out_is_kept_in_the_file(tmp_path: Path) -> None:
    _, drives, readings = rig(6, phased=False)
    readings[7, 2] *= 10
    with pytest.warns(midair.SceneWarning, match="drive 7 at microphone 2"):
        found = midair.calibrate(ARRAY, drives, readings, microphones=PLACES)
    found.save(tmp_path / "found.npz")
    assert midair.Calibration.load(tmp_path / "found.npz").outlying.tolist() == [[7, 2]]


@pytest.mark.slow
def test_a_program_that_makes_every_fault_of_a_number_an_error_calibrates() -> None:
    array, places = midair.Array.preset("ultraino_flat8x8"), [[0, 0, 0.15], [0.03, 0, 0.15]]
    drives = midair.calibration_drives(array)
    readings = np.abs(drives @ midair.Scene(array, places).propagation().T)
    with np.errstate(all="raise"):
        found = midair.calibrate(array, drives, readings, microphones=places)
    assert np.abs(found.response).min() > 0.99
