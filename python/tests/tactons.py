"""Tactons (patterns for the skin) in the format of Adaptics Designer, and the curve expected from each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = Mapping[str, float]
Curve = NDArray[np.float64]

#: A function that returns the expected curve (4, T): x, y, z in mm, and the intensity. Its arguments are the
#: time within the pattern and the time since the start, both in ms, and the parameters.
Expected = Callable[[Curve, Curve, Values], Curve]


def value(given: Any) -> dict[str, Any]:
    """Returns the JSON of a value: a constant, a parameter's name, or a formula ("add", a, b)."""
    if isinstance(given, tuple):
        return {"type": "formula", "value": formula(given)}
    return {"type": "param" if isinstance(given, str) else "f64", "value": given}


def formula(given: Any) -> dict[str, Any]:
    if isinstance(given, tuple):
        kind, *inner = given
        read = [formula(each) for each in inner]
        return {"type": kind, "value": read[0] if kind == "negate" else read}
    return {"type": "parameter" if isinstance(given, str) else "constant", "value": given}


def stage(key: str, what: Any, transition: str) -> dict[str, Any]:
    return {key: what, "transition": {"name": transition, "params": {}}}


def keyframe(
    time: float,
    place: tuple[float, float, float] | None = None,
    brush: tuple[str, dict[str, Any]] | None = None,
    intensity: Any = None,
    *,
    then: str = "linear",
    jumps: tuple[tuple[str, str, float, float], ...] = (),
) -> dict[str, Any]:
    made: dict[str, Any] = {"time": time, "type": "pause" if place is None else "standard"}
    made["cjumps"] = [
        {
            "condition": {"parameter": name, "operator": {"name": holds, "params": {}}, "value": limit},
            "jump_to": to,
        }
        for name, holds, limit, to in jumps
    ]
    if place is not None:
        made["coords"] = stage("coords", dict(zip("xyz", place, strict=True)), then)
    if brush is not None:
        name, params = brush
        given = {"name": name, "params": {key: value(each) for key, each in params.items()}}
        made["brush"] = stage("brush", given, then)
    if intensity is not None:
        made["intensity"] = stage("intensity", {"name": "constant", "params": {"value": value(intensity)}}, then)
    return made


def pattern(
    keyframes: list[dict[str, Any]],
    parameters: Mapping[str, tuple[float, float | None, float | None]] | None = None,
    *,
    shift: tuple[Any, ...] = (0, 0, 100),
    turn: Any = 0,
    scale: tuple[Any, ...] = (1, 1, 1),
    factor: Any = 1,
    speed: Any = 1,
) -> dict[str, Any]:
    axes = {"translate": shift, "scale": scale}
    return {
        "$DATA_FORMAT": "MidAirHapticsAnimationFileFormat",
        "$REVISION": "0.1.0-alpha.3",
        "name": "ours",
        "keyframes": keyframes,
        "pattern_transform": {
            "geometric_transforms": {
                **{
                    key: {axis: value(one) for axis, one in zip("xyz", given, strict=True)}
                    for key, given in axes.items()
                },
                "rotation": value(turn),
            },
            "intensity_factor": value(factor),
            "playback_speed": value(speed),
        },
        "user_parameter_definitions": {
            name: {"default": default, "min": least, "max": most, "step": 0.1}
            for name, (default, least, most) in (parameters or {}).items()
        },
    }


@dataclass(frozen=True)
class Case:
    """A pattern, the values of its parameters, and the curve that it should give.

    loop : time in ms after which the pattern begins again; None for no loop
    end : time in ms at which the pattern stops; None if it does not stop
    """

    name: str
    pattern: dict[str, Any]
    expected: Expected
    values: dict[str, float] = field(default_factory=dict)
    speed: float = 1.0
    loop: float | None = None
    end: float | None = None


def lap(frequency: float, time: Curve) -> Curve:
    return 2 * np.pi * frequency * time / 1e3


def modulated(frequency: Any, time: Curve) -> Curve:
    return (1 + np.cos(2 * np.pi * frequency * time / 1e3)) / 2


def rows(x: Any, y: Any, z: Any, intensity: Any, time: Curve) -> Curve:
    return np.array([np.broadcast_to(each, time.shape) for each in (x, y, z, intensity)], float)


def _pulse() -> Case:
    """A circle that grows and shrinks in a loop."""
    radii = {0: 4.0, 120: 14.0, 300: 6.0, 900: 4.0}
    circle = [
        keyframe(
            time,
            (0, 0, 0) if time == 0 else None,
            ("circle", {"radius": radius, "am_freq": 0, "stm_freq": 30}),
            0.4 if time == 300 else 1,
            jumps=(("alive", "gt", 0, 0),) if time == 900 else (),
        )
        for time, radius in radii.items()
    ]

    def expected(own: Curve, time: Curve, values: Values) -> Curve:
        radius = np.interp(own, list(radii), list(radii.values()))
        strength = np.interp(own, [0, 120, 300, 900], [1, 1, 0.4, 1])
        turn = lap(30, time)
        return rows(radius * np.cos(turn), radius * np.sin(turn), 100, strength, time)

    return Case("pulse", pattern(circle, {"alive": (1, 0, 1)}), expected, loop=900)


def _drops() -> Case:
    """Small circles that hit one place after another and fade."""
    places = [(15, -20), (-30, 10), (25, 15), (-5, -30)]
    frames = []
    for k, (x, y) in enumerate(places):
        begin = {"radius": 2, "am_freq": 0, "stm_freq": 50}
        frames.append(keyframe(250 * k, (x, y, 0), ("circle", begin), 1))
        frames.append(keyframe(250 * k + 150, None, ("circle", {**begin, "radius": 12}), 0, then="step"))
    frames.append({"time": 1000, "type": "stop"})

    def expected(own: Curve, time: Curve, values: Values) -> Curve:
        k = np.minimum(own // 250, 3).astype(int)
        share = np.clip((own - 250 * k) / 150, 0, 1)
        turn, radius = lap(50, time), 2 + 10 * share
        # The place moves to the next one only after the pause.
        then = np.clip((own - 250 * k - 150) / 100, 0, 1) * (k < 3)
        at = np.array(places, float)
        here = at[k] + then[:, None] * (at[np.minimum(k + 1, 3)] - at[k])
        x, y = here.T + radius * np.array([np.cos(turn), np.sin(turn)])
        return rows(x, y, 100, np.where(share < 1, 1 - share, 0), time)

    return Case("drops", pattern(frames), expected, end=1000)


def _gust() -> Case:
    """A line that sweeps over the hand across the wind. The wind's direction and speed are parameters."""
    across, shiver = ("add", "direction", 90), ("multiply", "turbulence", 20)

    def line(length: float) -> tuple[str, dict[str, Any]]:
        return "line", {"length": length, "rotation": across, "am_freq": shiver, "thickness": 1}

    frames = [
        keyframe(0, (-40, 0, 0), line(30), 0),
        keyframe(125, None, line(30), 1),
        keyframe(875, (40, 10, 0), line(20), 1),
        keyframe(1000, None, line(20), 0),
    ]
    parameters = {"direction": (0, -360, 360), "speed": (1, 0, None), "turbulence": (0, 0, 1)}

    def expected(own: Curve, time: Curve, values: Values) -> Curve:
        wind = np.deg2rad(values["direction"])
        # During a pause the position stays.
        share = np.interp(own, [125, 875], [0, 1])
        x, y = -40 + 80 * share, 10 * share
        length = np.interp(own, [125, 875], [30, 20]) * np.cos(lap(100, time))
        strength = np.interp(own, [0, 125, 875, 1000], [0, 1, 1, 0])
        return rows(
            x * np.cos(wind) - y * np.sin(wind) + length * np.cos(wind + np.pi / 2),
            x * np.sin(wind) + y * np.cos(wind) + length * np.sin(wind + np.pi / 2),
            100,
            strength * modulated(20 * values["turbulence"], time),
            time,
        )

    return Case(
        "gust",
        pattern(frames, parameters, turn="direction", speed="speed"),
        expected,
        {"direction": 35, "speed": 0.8, "turbulence": 1},
        speed=0.8,
    )


def _key() -> Case:
    """A button: steps of intensity as the hand comes near, then a rough ring while it is pressed."""
    ring = {"radius": ("add", ("multiply", "pressed", 10), 8), "am_freq": 75}
    frames = [
        keyframe(0, (0, 5, 2), ("circle", {"radius": 5, "am_freq": 0}), "near", then="step"),
        keyframe(200, None, ("circle", ring), 0.8, then="step"),
        keyframe(500, None, ("circle", ring), 0.8, then="step", jumps=(("pressed", "gt_eq", 1, 200),)),
        {"time": 700, "type": "stop"},
    ]

    def expected(own: Curve, time: Curve, values: Values) -> Curve:
        turn, pressed = lap(100, time), own >= 200
        radius = np.where(pressed, 10 * min(values["pressed"], 1) + 8, 5)
        strength = np.where(pressed, 0.8 * modulated(75, time), values["near"])
        return rows(radius * np.cos(turn), 5 + radius * np.sin(turn), 102, strength, time)

    return Case(
        "key",
        pattern(frames, {"near": (0, 0, 1), "pressed": (0, 0, 1)}),
        expected,
        {"near": 0.6, "pressed": 0.5},
        end=700,
    )


def _bolt() -> Case:
    """A Lissajous curve that jumps down the hand, wider and slower with the parameter `voltage`."""
    brush = (
        "lissajous",
        {"a": 2, "b": 3, "d": 0.5, "x_scale": 6, "y_scale": 4, "rotation": 0, "am_freq": 40},
    )
    places = {0: (0, 30), 150: (-12, 20), 300: (14, 5), 450: (-8, -10), 600: (0, -35)}
    frames = [
        keyframe(time, (*place, 0), brush if time == 0 else None, 1 if time == 0 else None)
        for time, place in places.items()
    ]
    frames.append({"time": 650, "type": "stop"})
    wide = ("add", 1, ("multiply", "voltage", 0.5))
    slow = ("subtract", 2, ("divide", "voltage", 2))

    def expected(own: Curve, time: Curve, values: Values) -> Curve:
        x, y = (np.interp(own, list(places), [place[k] for place in places.values()]) for k in (0, 1))
        # The curve is first scaled, then rotated by 90 degrees.
        x, y = -y, x * (1 + 0.5 * values["voltage"])
        turn = lap(100, time) % (2 * np.pi)
        x, y = x + 3 + 6 * np.sin(2 * turn + 0.5), y - 2 + 4 * np.sin(3 * turn)
        return rows(x, y, 110, 0.7 * modulated(40, time), time)

    made = pattern(
        frames,
        {"voltage": (0, 0, 1)},
        shift=(3, -2, 110),
        turn=90,
        scale=(wide, 1, 1),
        factor=0.7,
        speed=slow,
    )
    return Case("bolt", made, expected, {"voltage": 0.4}, speed=1.8, end=650)


CASES = [_pulse(), _drops(), _gust(), _key(), _bolt()]
