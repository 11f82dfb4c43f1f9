"""Paths that are refused, each in one line."""

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

REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "speed and frequency": (lambda: ring(speed=1), "speed is 1 and frequency is 50: give one of them"),
    "neither": (lambda: ring(frequency=None), "speed and frequency are left out: give speed in m/s, or"),
    "a speed of 0": (lambda: ring(frequency=None, speed=0), "speed is 0: give a number above 0"),
    "a speed of nobody": (
        lambda: ring(frequency=None, speed=1e-320),
        "speed is 1e-320: the path would last inf s",
    ),
    "a frequency of NaN": (lambda: ring(frequency=math.nan), "frequency is nan: give a finite number"),
    "no turns": (lambda: ring(turns=0), "turns is 0: give a number above 0"),
    "half a point": (lambda: ring(points=1.5), "points is 1.5: give a whole number of at least 1"),
    "a million points": (lambda: ring(points=10**6), "points is 1000000: give at most 100000"),
    "a word for an angle": (lambda: ring(start_angle="x"), 'start_angle is "x": give a number'),
    "no normal": (lambda: ring(normal=(0, 0, 0)), "normal is [0.0, 0.0, 0.0]: give a direction"),
    "no radius": (lambda: path.circle([0, 0, 1], 0, speed=1), "radius is 0.0: give a number above 0"),
    "a huge radius": (
        lambda: path.circle([0, 0, 1], 1e308, speed=1),
        "the way is inf m long: give a path of",
    ),
    "a center of two": (lambda: path.circle([0, 1], 1, speed=1), "center is [0, 1]: give three finite"),
    "too few pressures": (
        lambda: ring(points=3, pressures=[1, 2]),
        "pressures has shape (2,): give numbers of at least 0 in Pa: one number or 3",
    ),
    "a negative pressure": (lambda: ring(pressures=-1), "pressures is -1: -1 is among them"),
    "a pressure of NaN": (lambda: ring(pressures=[math.nan]), "pressures is [nan]: nan is among them"),
    "words for pressures": (
        lambda: ring(pressures="full"),
        'pressures is "full": give numbers of at least 0',
    ),
    "no line": (lambda: path.line([0, 0, 1], [0, 0, 1], speed=1), "end is [0.0, 0.0, 1.0]: it is where"),
    "one corner": (lambda: path.polyline(POINT, speed=1), "corners is [[0.0, 0.0, 1.0]]: give at least two"),
    "one place": (lambda: path.polyline(POINT * 3, speed=1), "they are all in one place"),
    "NaN in a corner": (
        lambda: path.polyline([*POINT, [0, 0, math.nan]], speed=1),
        "corners is [[0, 0, 1], [0, 0, nan]]",
    ),
    "no size": (
        lambda: path.lissajous([0, 0, 1], (0, 0), (1, 2), speed=1),
        "size is (0, 0): give (width, height)",
    ),
    "half a lobe": (
        lambda: path.lissajous([0, 0, 1], (1, 1), (1, 0.5), speed=1),
        "ratio is (1, 0.5): give two whole",
    ),  # type: ignore[arg-type]
    "NaN lobes": (
        lambda: path.lissajous([0, 0, 1], (1, 1), (1, math.nan), speed=1),
        "ratio is (1, nan): give two",
    ),  # type: ignore[arg-type]
    "corners at the end of numbers": (
        lambda: path.polyline([[1e308, 0, 0], [-1e308, 0, 0]], speed=1),
        "the way is inf m long: give a path of a finite length",
    ),
    "frames at the end of numbers": (
        lambda: path.from_array([[[1e308, 0, 0]], [[-1e308, 0, 0]]], rate=1),
        "point 0 of frame 0 is [1e+308, 0.0, 0.0]: give three finite numbers, at most 1e+06",
    ),
    "a list of waves": (lambda: ring().with_am(50, ["sqrt"]), "shape is ['sqrt']: give text"),  # type: ignore[arg-type]
    "a million lobes": (lambda: path.lissajous([0, 0, 1], (1, 1), (1, 10**6), speed=1), "from 1 to 100"),
    "no drawing": (
        lambda: path.svg("none.svg", size=1, z=1, speed=1),
        'path is "none.svg": there is no such',
    ),
    "an empty drawing": (
        lambda: path.svg("<svg/>", size=1, z=1, speed=1),
        'path is "SVG text": nothing is drawn',
    ),
    "damaged text": (lambda: path.svg("<svg", size=1, z=1, speed=1), 'path is "SVG text": it cannot be read'),
    "two outlines": (
        lambda: path.svg(HEAD + '<path d="M0 0 h9 M50 0 v9"/></svg>', size=1, z=1, speed=1),
        "the drawing has 2 outlines, of which a point walks one: leave one",
    ),
    "a morph of no time": (
        lambda: path.morph(POINT, POINT, duration=0),
        "duration is 0: give a number above 0",
    ),
    "a morph in no time": (lambda: path.morph(POINT, POINT, duration=1e-320), "give a longer one"),
    "a morph of both": (
        lambda: path.morph(POINT, POINT, duration=1, speed=1),
        "duration is 1 and speed is 1: give one",
    ),
    "a morph of neither": (lambda: path.morph(POINT, POINT), "duration and speed are left out"),
    "a morph to nowhere": (lambda: path.morph(POINT, POINT, speed=1), "the way is 0 m long"),
    "a morph to more": (
        lambda: path.morph(POINT, POINT * 2, speed=1),
        "M changes from 1 to 2 between from_points",
    ),
    "a morph of NaN": (
        lambda: path.morph(POINT, [[0, 0, math.nan]], speed=1),
        "to_points is [[0, 0, nan]]: give",
    ),
    "NaN": (lambda: path.from_array(NAN, rate=1), "point 1 of frame 2 is [0.1, nan, 0.1]: give three finite"),
    "another M": (
        lambda: path.from_array(RAGGED, rate=1),
        "M changes from 3 to 4 at frame 17: join paths with a fade",
    ),
    "a flat array": (
        lambda: path.from_array(np.zeros((9, 3)), rate=1),
        "points has shape (9, 3): give frames x",
    ),
    "a flat list": (
        lambda: path.from_array([[0, 0, 1]] * 2, rate=1),
        "frame 0 of points is [0, 0, 1]: give points x 3",
    ),
    "one frame": (
        lambda: path.from_array([POINT], rate=1),
        "points has shape (1, 1, 3): give frames x points x 3",
    ),
    "no frames": (lambda: path.from_array([], rate=1), "points has shape (0,): give frames x points"),
    "frames of nothing": (lambda: path.from_array(None, rate=1), "points is None: give frames x points"),  # type: ignore[arg-type]
    "complex frames": (
        lambda: path.from_array(np.zeros((2, 1, 3), complex), rate=1),
        "give frames x points x 3",
    ),
    "a rate of nobody": (lambda: path.from_array([POINT] * 2, rate=1e-310), "the path would last inf s"),
    "pressures of others": (
        lambda: path.from_array([POINT] * 4, rate=1, pressures=np.ones((3, 1))),
        "pressures has shape (3, 1): give numbers of at least 0 in Pa: one number or 1 or 4 x 1",
    ),
    "frames at 0": (lambda: ring().frames(0), "rate is 0: give a number above 0"),
    "frames at NaN": (lambda: ring().frames(math.nan), "rate is nan: give a finite number"),
    "too few frames": (
        lambda: ring().frames(60),
        "rate is 60.0: that is 1 frames in 0.02 s, give a larger one",
    ),
    "too many frames": (
        lambda: ring().frames(1e300),
        "rate is 1e+300: 2e+298 frames of 1 points are too many",
    ),
    "slow frames": (
        lambda: AM.frames(150),
        "rate is 150.0: the modulation needs 200 frames a second at least",
    ),
    "slow frames beside": (lambda: (AM & still(0.1)).frames(150), "the modulation needs 200 frames"),
    "slow frames after": (lambda: AM.then(still(0.0)).frames(150), "the modulation needs 200 frames"),
    "slow frames twice": (lambda: AM.with_am(10).frames(150), "the modulation needs 200 frames"),
    "a number for times": (lambda: ring().at(0.5), "times is 0.5: give a list of finite times in s"),
    "an endless time": (lambda: ring().targets([0, math.inf]), "times is [0, inf]: give a list of finite"),
    "words for times": (lambda: ring().speed(["now"]), "times is ['now']: give a list of finite times"),
    "beside no path": (lambda: ring() & 3, "other is 3: give a path, such as midair.path.circle"),
    "beside a longer one": (
        lambda: still(0.0) & ring(),
        "the paths last 0.1 and 0.02 s: give them one duration",
    ),
    "beside an odd one": (lambda: ring() & ring(frequency=50.123), "the paths last 0.02 and 0.0199509 s"),
    "beside a tiny one": (lambda: ring(frequency=1e-200) & ring(frequency=1e200), "give them one duration"),
    "Pa beside none": (lambda: ring(pressures=5) & ring(), "pressures are given for the first path only"),
    "Pa after none": (
        lambda: still(0.0).then(still(0.0, pressures=1)),
        "pressures are given for the second path only",
    ),
    "then no path": (lambda: ring().then([1]), "other is [1]: give a path"),  # type: ignore[arg-type]
    "a fade of 0": (lambda: ring().then(ring(), fade=0), "fade is 0: give a number above 0"),
    "a jump": (
        lambda: still(0.0).then(still(0.0123)),
        "point 0 of the second path starts 12.3 mm from where the first ends: give a fade in s",
    ),
    "a jump of one": (
        lambda: still(0.0, 0.01).then(still(0.0, 0.03)),
        "point 1 of the second path starts 20 mm from where",
    ),
    "another M without fade": (
        lambda: still(0.0).then(still(0.0, 0.1)),
        "M changes from 1 to 2 at the joint: give a fade",
    ),
    "two points in one": (lambda: still(0.0).then(still(0.0, 0.0)), "M changes from 1 to 2 at the joint"),
    "two points of one": (
        lambda: still(0.0, 0.01).then(still(0.0, 0.0)),
        "point 1 of the second path starts 10 mm",
    ),
    "a louder point": (
        lambda: still(0.0, pressures=1).then(still(0.0, pressures=2)),
        "targets jump from [1.0] to [2.0] at the joint: give a fade",
    ),
    "modulation of 0": (lambda: ring().with_am(0), "frequency is 0: give a number above 0"),
    "modulation too deep": (lambda: ring().with_am(50, depth=2), "depth is 2"),
    "another wave": (lambda: ring().with_am(50, "saw"), 'shape is "saw": give one of sqrt, cosine, square'),  # type: ignore[arg-type]
    "a wave that jumps": (
        lambda: ring().with_am(180),
        "frequency is 180.0: the closed path of 0.02 s would hold 3.6 periods and jump at its seam, "
        "give 150 or 200 Hz",
    ),
    "pressures twice": (
        lambda: path.read(ring(pressures=5), 1e3, 5),
        "pressures are given with the path, too",
    ),
    "reading another M": (lambda: path.read(RAGGED, 1e3), "M changes from 3 to 4 at frame 17"),
    "reading NaN": (lambda: path.read(NAN, 1e3), "point 1 of frame 2 is [0.1, nan, 0.1]"),
    "reading at 0": (lambda: path.read(ring(), 0), "rate is 0: give a number above 0"),
    "reading a word": (lambda: path.read("ring", 1e3), "give"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_walked_is_refused_in_one_line(what: str) -> None:
    make, told = REFUSED[what]
    with pytest.raises(midair.SceneError) as error:
        make()
    assert told in str(error.value)
    assert "\n" not in str(error.value)
