"""The kinds of paths; their arguments are the keys of `[[motion.path]]` in a scene file."""

import functools
import math
from os import PathLike

from numpy.typing import ArrayLike

from .._midair import Path
from .._support.arguments import number
from ..shape._figures import letters
from ..shape._vector_graphics import one_outline


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
    return Path._of({"kind": "circle", **locals()})


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
    return Path._of({"kind": "line", **locals()})


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
    return Path._of({"kind": "polyline", **locals()})


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
    return Path._of({"kind": "lissajous", **locals()})


def svg(
    path: str | PathLike[str],
    *,
    size: float,
    z: float,
    speed: float | None = None,
    frequency: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point along the outline of an SVG drawing, its middle at (0, 0, z), y up.

    Parameters
    ----------
    path : str or path
        An SVG file, or SVG text. A drawing of several outlines is rejected.
    size : float
        Longer side of the drawing, in m.
    z : float
        Height of its plane in m.
    speed : float, optional
        Speed in m/s; alternatively give `frequency`.
    frequency : float, optional
        Runs per second along the outline.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path, closed if the outline is.

    Raises
    ------
    SceneError
        For a missing file or one that draws more than one outline, and unless either a speed or a frequency
        above 0 is given.

    Examples
    --------
    >>> import midair
    >>> drawing = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 H10 V10 H0 Z"/></svg>'
    >>> midair.path.svg(drawing, size=0.02, z=0.15, frequency=5)
    Path(points=1, duration=0.2, closed=True)
    """
    corners, closed = one_outline(path, size, z)
    return polyline(corners, speed=speed, frequency=frequency, closed=closed, pressures=pressures)


def text(
    string: str,
    *,
    height: float,
    z: float,
    speed: float,
    fade: float = 0.005,
    font: str | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point along the outlines of a line of text, its middle at (0, 0, z), and back to the start.

    Between two outlines it fades out at one while another point fades in at the next.

    Parameters
    ----------
    string : str
        One line of text.
    height : float
        Height of a capital H in m.
    z : float
        Height of the plane in m.
    speed : float
        Speed in m/s.
    fade : float, optional
        Time in s between two outlines.
    font : str, optional
        Name of a font, as for `midair.shape.text`.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path, closed if the outlines are one or an even number.

    Raises
    ------
    SceneError
        As for `midair.shape.text`, and for a speed or a fade not above 0.

    Examples
    --------
    >>> import midair
    >>> midair.path.text("i", height=0.02, z=0.15, speed=1).closed
    True
    """
    contours = letters(string, height, z, font)
    ways = [polyline(corners, speed=speed, closed=True, pressures=pressures) for corners, _ in contours]
    if len(ways) > 1:
        ways.append(still(ways[0].at([0])[0], duration=number("fade", fade, above=0), pressures=pressures))
    return functools.reduce(lambda path, way: path.then(way, fade), ways)


def morph(
    from_points: ArrayLike,
    to_points: ArrayLike,
    *,
    duration: float | None = None,
    speed: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move points to as many others, each straight and at constant speed.

    Parameters
    ----------
    from_points, to_points : (M, 3) array_like
        Places in m at the start and at the end.
    duration : float, optional
        Duration in s; alternatively give `speed`.
    speed : float, optional
        Speed in m/s of the point with the longest way.
    pressures : float or (M,) array_like, optional
        Peak pressures in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    SceneError
        For sets of different numbers of points, and unless either a duration or a speed above 0 is given.

    Examples
    --------
    >>> import midair
    >>> midair.path.morph([[0, 0, 0.15]], [[0, 0, 0.2]], duration=1).at([0.5]).tolist()
    [[[0.0, 0.0, 0.175]]]
    """
    return Path._of({"kind": "morph", **locals()})


def still(places: ArrayLike, *, duration: float, pressures: ArrayLike | None = None) -> Path:
    """Keep points at rest, for a modulated or joined focus.

    Parameters
    ----------
    places : (3,) or (M, 3) array_like
        Places in m.
    duration : float
        Duration in s of a period: the path is closed and repeats.
    pressures : float or (M,) array_like, optional
        Peak pressures in Pa; by default the balanced level.

    Returns
    -------
    Path
        The closed path.

    Raises
    ------
    SceneError
        For wrong places, duration or pressures.

    Examples
    --------
    >>> import midair
    >>> midair.path.still([0, 0, 0.15], duration=0.1).with_am(200)
    Path(points=1, duration=0.1, closed=True)
    """
    return Path._of({"kind": "still", **locals()})
