"""Arguments of paths that are rejected, each with a message of one line."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import midair
from midair import path
from paths import HEAD, ring, still

NAN = np.full((3, 2, 3), 0.1)
NAN[2, 1, 1] = math.nan
RAGGED = [[[0, 0, 1]] * 3] * 17 + [[[0, 0, 1]] * 4]
POINT = [[0, 0, 1]]
AM = still(0.0).with_am(100)

REFUSED: dict[str, Callable[[], Any]] = {
    "speed and frequency": lambda: ring(speed=1),
    "neither": lambda: ring(frequency=None),
    "a speed of 0": lambda: ring(frequency=None, speed=0),
    "a tiny speed": lambda: ring(frequency=None, speed=1e-320),
    "a frequency of NaN": lambda: ring(frequency=math.nan),
    "no turns": lambda: ring(turns=0),
    "half a point": lambda: ring(points=1.5),
    "a million points": lambda: ring(points=10**6),
    "a word for an angle": lambda: ring(start_angle="x"),
    "no normal": lambda: ring(normal=(0, 0, 0)),
    "no radius": lambda: path.circle([0, 0, 1], 0, speed=1),
    "a huge radius": lambda: path.circle([0, 0, 1], 1e308, speed=1),
    "a center of two": lambda: path.circle([0, 1], 1, speed=1),
    "too few pressures": lambda: ring(points=3, pressures=[1, 2]),
    "a negative pressure": lambda: ring(pressures=-1),
    "a pressure of NaN": lambda: ring(pressures=[math.nan]),
    "words for pressures": lambda: ring(pressures="full"),
    "no line": lambda: path.line([0, 0, 1], [0, 0, 1], speed=1),
    "one corner": lambda: path.polyline(POINT, speed=1),
    "one place": lambda: path.polyline(POINT * 3, speed=1),
    "NaN in a corner": lambda: path.polyline([*POINT, [0, 0, math.nan]], speed=1),
    "no size": lambda: path.lissajous([0, 0, 1], (0, 0), (1, 2), speed=1),
    "half a lobe": lambda: path.lissajous([0, 0, 1], (1, 1), (1, 0.5), speed=1),  # type: ignore[arg-type]
    "NaN lobes": lambda: path.lissajous([0, 0, 1], (1, 1), (1, math.nan), speed=1),  # type: ignore[arg-type]
    "corners at the end of numbers": lambda: path.polyline([[1e308, 0, 0], [-1e308, 0, 0]], speed=1),
    "frames at the end of numbers": lambda: path.from_array([[[1e308, 0, 0]], [[-1e308, 0, 0]]], rate=1),
    "a list of waves": lambda: ring().with_am(50, ["sqrt"]),  # type: ignore[arg-type]
    "a million lobes": lambda: path.lissajous([0, 0, 1], (1, 1), (1, 10**6), speed=1),
    "no drawing": lambda: path.svg("none.svg", size=1, z=1, speed=1),
    "an empty drawing": lambda: path.svg("<svg/>", size=1, z=1, speed=1),
    "damaged text": lambda: path.svg("<svg", size=1, z=1, speed=1),
    "two outlines": lambda: path.svg(HEAD + '<path d="M0 0 h9 M50 0 v9"/></svg>', size=1, z=1, speed=1),
    "a morph of no time": lambda: path.morph(POINT, POINT, duration=0),
    "a morph in no time": lambda: path.morph(POINT, POINT, duration=1e-320),
    "a morph of both": lambda: path.morph(POINT, POINT, duration=1, speed=1),
    "a morph of neither": lambda: path.morph(POINT, POINT),
    "a morph to nowhere": lambda: path.morph(POINT, POINT, speed=1),
    "a morph to more": lambda: path.morph(POINT, POINT * 2, speed=1),
    "a morph of NaN": lambda: path.morph(POINT, [[0, 0, math.nan]], speed=1),
    "NaN": lambda: path.from_array(NAN, rate=1),
    "another M": lambda: path.from_array(RAGGED, rate=1),
    "a flat array": lambda: path.from_array(np.zeros((9, 3)), rate=1),
    "a flat list": lambda: path.from_array([[0, 0, 1]] * 2, rate=1),
    "one frame": lambda: path.from_array([POINT], rate=1),
    "no frames": lambda: path.from_array([], rate=1),
    "frames of nothing": lambda: path.from_array(None, rate=1),  # type: ignore[arg-type]
    "complex frames": lambda: path.from_array(np.zeros((2, 1, 3), complex), rate=1),
    "a tiny rate": lambda: path.from_array([POINT] * 2, rate=1e-310),
    "pressures of others": lambda: path.from_array([POINT] * 4, rate=1, pressures=np.ones((3, 1))),
    "frames at 0": lambda: ring().frames(0),
    "frames at NaN": lambda: ring().frames(math.nan),
    "too few frames": lambda: ring().frames(60),
    "too many frames": lambda: path.still(POINT, duration=1e6).frames(1e7),
    "too many frames a second": lambda: ring().frames(1e300),
    "slow frames": lambda: AM.frames(150),
    "slow frames beside": lambda: (AM & still(0.1)).frames(150),
    "slow frames after": lambda: AM.then(still(0.0)).frames(150),
    "slow frames twice": lambda: AM.with_am(10).frames(150),
    "a number for times": lambda: ring().at(0.5),
    "an endless time": lambda: ring().targets([0, math.inf]),
    "words for times": lambda: ring().speed(["now"]),
    "beside no path": lambda: ring() & 3,
    "beside a longer one": lambda: still(0.0) & ring(),
    "beside an odd one": lambda: ring() & ring(frequency=50.123),
    "beside a tiny one": lambda: ring(frequency=1e-200) & ring(frequency=1e200),
    "Pa beside none": lambda: ring(pressures=5) & ring(),
    "Pa after none": lambda: still(0.0).then(still(0.0, pressures=1)),
    "then no path": lambda: ring().then([1]),  # type: ignore[arg-type]
    "a fade of 0": lambda: ring().then(ring(), fade=0),
    "a jump": lambda: still(0.0).then(still(0.0123)),
    "a jump of one": lambda: still(0.0, 0.01).then(still(0.0, 0.03)),
    "another M without fade": lambda: still(0.0).then(still(0.0, 0.1)),
    "two points in one": lambda: still(0.0).then(still(0.0, 0.0)),
    "two points of one": lambda: still(0.0, 0.01).then(still(0.0, 0.0)),
    "a louder point": lambda: still(0.0, pressures=1).then(still(0.0, pressures=2)),
    "modulation of 0": lambda: ring().with_am(0),
    "modulation too deep": lambda: ring().with_am(50, depth=2),
    "another wave": lambda: ring().with_am(50, "saw"),  # type: ignore[arg-type]
    "a wave that jumps": lambda: ring().with_am(180),
    "pressures twice": lambda: path.read(ring(pressures=5), 1e3, 5),
    "reading another M": lambda: path.read(RAGGED, 1e3),
    "reading NaN": lambda: path.read(NAN, 1e3),
    "reading at 0": lambda: path.read(ring(), 0),
    "reading a word": lambda: path.read("ring", 1e3),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_walked_is_refused_in_one_line(what: str, kept: Callable[..., None]) -> None:
    with pytest.raises(midair.SceneError) as error:
        REFUSED[what]()
    kept(error.value)
