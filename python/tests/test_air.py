"""Air from temperature, humidity and pressure:
a published table, the standard's formula, and all ways to give it.
"""

import math
import warnings
from typing import Any

import numpy as np
import pytest

import midair
import oracle

ARRAY = midair.Array.grid(8, 8, 0.01)
POINT = [[0, 0, 0.15]]
#: Decibels of one neper.
NEPER = 20 / math.log(10)

#: ISO 9613-2, table 2: absorption in dB/km at 1, 2, 4 and 8 kHz, by temperature in degrees C and humidity in
#: percent.
TABLE = {
    (10, 70): (3.7, 9.7, 32.8, 117),
    (20, 70): (5.0, 9.0, 22.9, 76.6),
    (30, 70): (7.4, 12.7, 23.1, 59.3),
    (15, 20): (8.2, 28.2, 88.8, 202),
    (15, 50): (4.2, 10.8, 36.2, 129),
    (15, 80): (4.1, 8.3, 23.7, 82.8),
}


def scene(**air: Any) -> midair.Scene:
    """Returns a scene in this air, without the warning that its frequency is audible."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", midair.SceneWarning)
        return midair.Scene(ARRAY, POINT, **air)


@pytest.mark.parametrize(("celsius", "percent"), TABLE)
def test_absorption_is_that_of_the_published_table(celsius: float, percent: float) -> None:
    for octave, loss in zip((0.3, 0.6, 0.9), TABLE[celsius, percent][1:], strict=True):
        air = scene(frequency=1e3 * 10**octave, temperature=celsius, humidity=percent)
        # The tolerance is for the rounding of the table.
        assert air.absorption * NEPER * 1e3 == pytest.approx(loss, rel=0.006)


def test_air_is_the_standards_formula() -> None:
    random = np.random.default_rng(1)
    for _ in range(200):
        f, celsius = random.uniform(5e3, 1e6), random.uniform(-30, 50)
        percent, pascals = random.uniform(1, 100), random.uniform(5e4, 1.5e5)
        air = scene(frequency=f, temperature=celsius, humidity=percent, air_pressure=pascals)
        speed, loss, density = oracle.air(f, celsius, percent, pascals)
        assert air.sound_speed == pytest.approx(speed, rel=1e-12)
        assert air.absorption * 8.686 == pytest.approx(loss, rel=1e-9)
        assert air.density == pytest.approx(density, rel=2e-4)
    assert oracle.air(40e3, 20, 50, 101325)[1] == pytest.approx(1.32, abs=0.01)


def test_what_is_left_out_is_usual_and_what_is_given_stays() -> None:
    usual = scene(temperature=25, humidity=50, air_pressure=101325)
    assert scene(temperature=25).medium == usual.medium
    given = scene(temperature=25, absorption=0, density=1.2)
    assert (given.sound_speed, given.absorption, given.density) == (usual.sound_speed, 0, 1.2)
    # Without a temperature, midair derives it from the sound speed, and keeps the sound speed to the bit.
    damp = scene(sound_speed=usual.sound_speed, humidity=50)
    assert damp.sound_speed == usual.sound_speed
    assert damp.absorption == pytest.approx(usual.absorption, rel=1e-12)
    assert scene(humidity=50).sound_speed == 340
    assert scene().medium == {"frequency": 40e3, "sound_speed": 340, "absorption": 0, "density": 1.223}


def test_every_way_in_has_the_same_air() -> None:
    air = {"temperature": 30.0, "humidity": 80.0, "air_pressure": 9e4}
    wanted = scene(**air)
    lines = "\n".join(f"{name} = {value}" for name, value in air.items())
    grid = "grid = { nx = 8, ny = 8, pitch = 0.01 }"
    text = f"[medium]\n{lines}\n[array]\n{grid}\n[[points]]\nposition = [0, 0, 0.15]"
    assert midair.Scene.parse(text) == wanted
    assert scene().replace(**air) == wanted
    drive = midair.solve(wanted, "fast").drive
    assert (midair.Solver(ARRAY, "fast", **air)(POINT).drive == drive).all()
    assert (midair.solve_batch(ARRAY, [POINT], solver="fast", **air).drives[0] == drive).all()
    moving = midair.Sequence(ARRAY, [POINT], [[9.0]], drive[None], rate=1e3, **air)
    assert moving == midair.Sequence(ARRAY, [POINT], [[9.0]], drive[None], rate=1e3, **wanted.medium)


@pytest.mark.parametrize(
    ("air", "text"),
    [
        ({"humidity": 0.5}, "medium.humidity is 0.5: give percent: 0, or 1 to 100 (50 is usual)"),
        ({"humidity": 101}, "medium.humidity is 101: give percent: 0, or 1 to 100 (50 is usual)"),
        ({"humidity": -1}, "medium.humidity is -1.0: give a number of at least 0"),
        (
            {"air_pressure": 101.325},
            "medium.air_pressure is 101.325: give Pa, 10000 to 200000 (101.325 kPa are 101325)",
        ),
        ({"air_pressure": math.nan}, "medium.air_pressure is NaN"),
        ({"temperature": -300, "humidity": 20}, "medium.temperature is -300.0: give a number above -273.15"),
        ({"temperature": 20, "sound_speed": 343}, "medium.temperature is 20: sound_speed is given too"),
    ],
)
def test_air_that_cannot_be_is_refused(air: dict[str, float], text: str) -> None:
    with pytest.raises(midair.SceneError) as refusal:
        scene(**air)
    assert str(refusal.value).startswith(text)
