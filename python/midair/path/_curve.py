"""Walks: points that go along a curve of the core at constant speed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .._midair import Curve, SceneError
from .._support.arguments import number, refused
from ._path import Path
from ._piece import Numbers, Piece, constant_pressures


@dataclass(frozen=True, eq=False, kw_only=True)
class Walk(Piece):
    """Points on one curve, each `way` further at the end."""

    curve: Curve
    #: Where each of the M points begins, in m along the curve.
    starts: Numbers
    #: In m.
    way: float
    #: Targets (M,).
    targets: Numbers

    def place(self, times: Numbers) -> Numbers:
        """Places by arc length."""
        return self.curve.after(self.starts + self.way * (times / self.duration)[:, None])

    def pace(self, times: Numbers) -> Numbers:
        """The one speed."""
        return np.full((len(times), self.points), self.way / self.duration)

    def level(self, times: Numbers) -> Numbers:
        """The targets, which do not change."""
        return np.tile(self.targets, (len(times), 1))


def walk(
    curve: Curve,
    *,
    speed: float | None,
    frequency: float | None,
    laps: float = 1.0,
    points: int = 1,
    pressures: ArrayLike | None = None,
) -> Path:
    """Points, evenly spaced on a curve, that walk it `laps` times."""
    targets = constant_pressures(pressures, points)
    way = laps * curve.length
    return Path(
        Walk(
            points=points,
            duration=lasting(way, laps, speed=speed, frequency=frequency),
            closed=curve.closed and laps == round(laps),
            pascals=pressures is not None,
            curve=curve,
            starts=curve.length * np.arange(points) / points,
            way=way,
            targets=targets,
        )
    )


def lasting(way: float, laps: float, *, speed: float | None, frequency: float | None) -> float:
    """The duration in s of `laps` that are a way in m, by speed in m/s or by frequency in laps a second."""
    if not 0 < way < math.inf:
        raise SceneError(f"the way is {way:g} m long: give a path of a finite length above 0")
    if speed is not None and frequency is not None:
        raise SceneError(
            f"speed is {speed} and frequency is {frequency}: give one of them, leave out the other"
        )
    if speed is not None:
        item, value, duration = "speed", speed, way / number("speed", speed, above=0)
    elif frequency is not None:
        item, value, duration = "frequency", frequency, laps / number("frequency", frequency, above=0)
    else:
        raise SceneError("speed and frequency are left out: give speed in m/s, or frequency in Hz")
    if not 0 < duration < math.inf:
        raise refused(item, value, f"the path would last {duration:g} s, give another")
    return duration
