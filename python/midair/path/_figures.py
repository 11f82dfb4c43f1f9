"""Circles, lines, polylines and Lissajous figures: points that move along a curve from the core."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from .._midair import MOST_POINTS, Curve, numbers, stated
from .._support.arguments import flag, number, refused, vector, vectors, whole
from ._path import Path
from ._piece import Numbers, Piece, constant_pressures

#: Straight pieces per period of a sine: a Lissajous figure of 0.1 m has an error of 1e-9 m.
PIECES = 16384

#: Largest number in `ratio`; larger ones are probably a mistake.
MOST_LOBES = 100


def circle(
    center: ArrayLike,
    radius: float,
    *,
    speed: float | None = None,
    frequency: float | None = None,
    turns: float = 1.0,
    start_angle: float = 0.0,
    normal: ArrayLike = (0.0, 0.0, 1.0),
    points: int = 1,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move points, evenly spaced, around a circle, counterclockwise about its normal.

    Parameters
    ----------
    center : (3,) array_like
        Center in m.
    radius : float
        Radius in m.
    speed : float, optional
        Speed in m/s; alternatively give `frequency`.
    frequency : float, optional
        Turns per second.
    turns : float, optional
        Number of turns; a path of whole turns is closed.
    start_angle : float, optional
        Angle of the first point in rad, from x (if the plane allows it, else from y).
    normal : (3,) array_like, optional
        Normal of the plane, of any length.
    points : int, optional
        Number M of points.
    pressures : float or (M,) array_like, optional
        Peak pressures in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    SceneError
        For wrong numbers, and unless either a speed or a frequency above 0 is given.

    Examples
    --------
    >>> import midair
    >>> midair.path.circle([0, 0, 0.15], 0.02, frequency=50, points=2)
    Path(points=2, duration=0.02, closed=True)
    """
    radius, turns = number("radius", radius), number("turns", turns, above=0)
    angle, count = number("start_angle", start_angle), whole("points", points, least=1)
    if count > MOST_POINTS:
        raise refused("points", count, f"give at most {MOST_POINTS}")
    curve = Curve.circle(vector("center", center), radius, vector("normal", normal), angle)
    return walk(curve, speed=speed, frequency=frequency, laps=turns, points=count, pressures=pressures)


def line(
    start: ArrayLike,
    end: ArrayLike,
    *,
    speed: float | None = None,
    frequency: float | None = None,
    there_and_back: bool = False,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point from start to end, and back with there_and_back, which is a closed path.

    Parameters
    ----------
    start, end : (3,) array_like
        Places in m.
    speed : float, optional
        Speed in m/s; alternatively give `frequency`.
    frequency : float, optional
        Runs per second; there and back are one run.
    there_and_back : bool, optional
        Whether the point returns.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    SceneError
        For an end that is the start, for wrong numbers, and unless either a speed or a frequency above 0 is
        given.

    Examples
    --------
    >>> import midair
    >>> midair.path.line([-0.02, 0, 0.15], [0.02, 0, 0.15], speed=0.1)
    Path(points=1, duration=0.4, closed=False)
    """
    curve = Curve.line(vector("start", start), vector("end", end), flag("there_and_back", there_and_back))
    return walk(curve, speed=speed, frequency=frequency, pressures=pressures)


def polyline(
    corners: ArrayLike,
    *,
    speed: float | None = None,
    frequency: float | None = None,
    closed: bool = False,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point along straight lines between corners.

    Parameters
    ----------
    corners : (K, 3) array_like
        Corners in m.
    speed : float, optional
        Speed in m/s; alternatively give `frequency`.
    frequency : float, optional
        Runs per second along the whole polyline.
    closed : bool, optional
        Whether a line leads from the last corner to the first.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    SceneError
        For corners in one place, for wrong numbers, and unless either a speed or a frequency above 0 is
        given.

    Examples
    --------
    >>> import midair
    >>> corners = [[0, 0, 0.15], [0.02, 0, 0.15], [0.02, 0.02, 0.15]]
    >>> midair.path.polyline(corners, speed=0.1)
    Path(points=1, duration=0.4, closed=False)
    """
    curve = Curve.lines("corners", vectors("corners", corners), flag("closed", closed))
    return walk(curve, speed=speed, frequency=frequency, pressures=pressures)


def lissajous(
    center: ArrayLike,
    size: tuple[float, float],
    ratio: tuple[int, int],
    *,
    phase: float = math.pi / 2,
    speed: float | None = None,
    frequency: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point along x = width / 2 sin(a u + phase), y = height / 2 sin(b u) around a center.

    Parameters
    ----------
    center : (3,) array_like
        Center in m.
    size : (float, float)
        Width and height of the figure in m.
    ratio : (int, int)
        a and b, two whole numbers; 1, 1 is an ellipse, 1, 2 with phase 0 an eight.
    phase : float, optional
        Phase of the x component in rad.
    speed : float, optional
        Speed in m/s, constant along the figure (a sine in time has none); or give `frequency`.
    frequency : float, optional
        Figures per second.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The closed path.

    Raises
    ------
    SceneError
        For a wrong size or ratio, and unless either a speed or a frequency above 0 is given.

    Examples
    --------
    >>> import midair
    >>> midair.path.lissajous([0, 0, 0.15], (0.04, 0.02), (1, 2), phase=0, frequency=5)
    Path(points=1, duration=0.2, closed=True)
    """
    middle, phase = vector("center", center), number("phase", phase)
    cure = "give (width, height) in m, not both 0"
    sizes = numbers("size", size, [(2,)], cure, least=0)
    if not sizes.any():
        raise refused("size", size, cure)
    cure = f"give two whole numbers from 1 to {MOST_LOBES}"
    lobes = numbers("ratio", ratio, [(2,)], cure, least=1, most=MOST_LOBES)
    if (lobes != np.rint(lobes)).any():
        raise refused("ratio", ratio, cure)
    # In lowest terms, one period traverses the figure once.
    a, b = Fraction(int(lobes[0]), int(lobes[1])).as_integer_ratio()
    u = 2 * math.pi * np.arange(PIECES * max(a, b)) / (PIECES * max(a, b))
    shifts = sizes / 2 * np.stack([np.sin(a * u + phase), np.sin(b * u)], axis=1)
    vertices = middle + np.column_stack([shifts, np.zeros(len(u))])
    return walk(Curve.lines("figure", vertices, True), speed=speed, frequency=frequency, pressures=pressures)


@dataclass(frozen=True, eq=False, kw_only=True)
class Walk(Piece):
    """Points on one curve; each moves by `way` m during the piece."""

    curve: Curve
    #: Start of each of the M points, in m along the curve.
    starts: Numbers
    #: Distance in m that each point moves.
    way: float
    #: Targets (M,).
    targets: Numbers

    def place(self, times: Numbers) -> Numbers:
        """Return the places at these times."""
        return self.curve.after(self.starts + self.way * (times / self.duration)[:, None])

    def pace(self, times: Numbers) -> Numbers:
        """Return the speed, which is constant."""
        return np.full((len(times), self.points), self.way / self.duration)

    def level(self, times: Numbers) -> Numbers:
        """Return the targets, which are constant."""
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
    """Return the path of points, evenly spaced on a curve, that move along it `laps` times."""
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
    """Return the duration in s of `way` m, from a speed in m/s or a frequency in laps per second."""
    if not 0 < way < math.inf:
        raise stated("the way", f"is {way:g} m long", "give a path of a finite length above 0")
    if speed is not None and frequency is not None:
        raise stated(
            "speed", f"is {speed} and frequency is {frequency}", "give one of them, leave out the other"
        )
    if speed is not None:
        item, value, duration = "speed", speed, way / number("speed", speed, above=0)
    elif frequency is not None:
        item, value, duration = "frequency", frequency, laps / number("frequency", frequency, above=0)
    else:
        raise stated(
            "speed and frequency", "are left out", "give speed in m/s, or frequency in Hz", code="missing"
        )
    if not 0 < duration < math.inf:
        raise refused(item, value, f"the path would last {duration:g} s, give another")
    return duration
