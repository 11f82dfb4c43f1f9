"""Lines, circles, polylines and text as points; contours in space, along which the core places points."""

import unicodedata
from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import STEP, along, shape_points
from .._support.arguments import number, refused, word

#: Coordinates (M, 3) in m, or (K, 2) in a plane.
Points: TypeAlias = NDArray[np.float64]

#: Vertices of a polyline, and whether the last one is joined to the first.
Contour: TypeAlias = tuple[Points, bool]

#: Scripts, by the first word of their letters' Unicode names, whose letters are joined, reordered or stacked,
#: beside those from right to left. Placing them needs a shaper, which matplotlib does not have.
SHAPED = """BALINESE BENGALI DEVANAGARI GUJARATI GURMUKHI JAVANESE KANNADA KHMER MALAYALAM MONGOLIAN MYANMAR
    ORIYA SINHALA TAMIL TELUGU TIBETAN"""

#: Straight pieces per curve: a full circle has an error of 3e-4 of its radius.
PIECES = 128


def line(start: ArrayLike, end: ArrayLike, *, step: float = STEP) -> Points:
    """Return points from start to end, both included.

    Parameters
    ----------
    start, end : (3,) array_like
        Places in m.
    step : float, optional
        Distance between neighbours in m.

    Returns
    -------
    (M, 3) ndarray
        Points in m.

    Raises
    ------
    SceneError
        For an end that is the start, for wrong numbers, and for more than 100000 points.

    Examples
    --------
    >>> import midair
    >>> midair.shape.line([0, 0, 0.1], [0, 0, 0.13], step=0.01)[:, 2].round(3).tolist()
    [0.1, 0.11, 0.12, 0.13]
    """
    return shape_points({"kind": "line", **locals()})


def circle(
    center: ArrayLike,
    radius: float,
    *,
    step: float | None = None,
    count: int | None = None,
    normal: ArrayLike = (0.0, 0.0, 1.0),
) -> Points:
    """Return points on a circle. The first lies along x, as far as the plane allows (else along y).

    Parameters
    ----------
    center : (3,) array_like
        Center in m.
    radius : float
        Radius in m.
    step : float, optional
        Distance between neighbours in m, by default 2.125 mm; or give `count`.
    count : int, optional
        Number of points.
    normal : (3,) array_like, optional
        Normal of the plane, of any length. The points run counterclockwise if it points to the viewer.

    Returns
    -------
    (M, 3) ndarray
        Points in m.

    Raises
    ------
    SceneError
        For a radius or step not above 0, a normal of no length, a step and a count, and for more than 100000
        points.

    Examples
    --------
    >>> import midair
    >>> circle = midair.shape.circle
    >>> len(circle([0, 0, 0.15], 0.02, step=0.01)), len(circle([0, 0, 0.15], 0.02, count=5))
    (13, 5)
    """
    return shape_points({"kind": "circle", **locals()})


def polyline(points: ArrayLike, *, step: float = STEP, closed: bool = False) -> Points:
    """Return points along straight lines; a step may lead around a corner.

    Parameters
    ----------
    points : (K, 3) array_like
        Corners in m; the first is among the points, and the last if they do not close.
    step : float, optional
        Distance between neighbours in m.
    closed : bool, optional
        Whether a line leads from the last corner back to the first.

    Returns
    -------
    (M, 3) ndarray
        Points in m.

    Raises
    ------
    SceneError
        For points that are all in one place, for wrong numbers, and for more than 100000 points.

    Examples
    --------
    >>> import midair
    >>> corners = [[0, 0, 0.15], [0.03, 0, 0.15], [0.03, 0.03, 0.15], [0, 0.03, 0.15]]
    >>> len(midair.shape.polyline(corners, step=0.01, closed=True))
    12
    """
    return shape_points({"kind": "polyline", **locals()})


def text(string: str, *, height: float, z: float, step: float = STEP, font: str | None = None) -> Points:
    """Return points on the outlines of a line of text, in the plane at z, its middle at x = y = 0.

    Parameters
    ----------
    string : str
        One line of text.
    height : float
        Height of a capital H in m.
    z : float
        Height of the plane in m.
    step : float, optional
        Distance between neighbours in m.
    font : str, optional
        Name of a font that matplotlib finds; by default DejaVu Sans, which comes with it.

    Returns
    -------
    (M, 3) ndarray
        Points in m.

    Raises
    ------
    SceneError
        For text without outlines, joined scripts such as Arabic, an unknown font, sizes not above 0, and for
        more than 100000 points.

    Examples
    --------
    >>> import midair
    >>> points = midair.shape.text("A", height=0.03, z=0.15)
    >>> round(float(points[:, 1].max() - points[:, 1].min()), 2)
    0.03
    """
    return points_along(letters(string, height, z, font), number("step", step))


def letters(string: str, height: float, z: float, font: str | None) -> list[Contour]:
    """Return the outlines of a text in the plane at z, the arguments as for `text`."""
    height, z = number("height", height, above=0), number("z", z)
    if not word("string", string).strip():
        raise refused("string", string, "give at least a letter")
    for letter in string:
        script = unicodedata.name(letter, "").partition(" ")[0]
        if script in SHAPED.split() or unicodedata.bidirectional(letter) in ("R", "AL", "AN"):
            cure = f"{script.title()} letters need a shaper, convert them to paths in an editor and give an svg"
            raise refused("string", string, cure)
    outlines, capital = _outlines(string, font), _outlines("H", font)
    if not outlines:
        raise refused("string", string, "its letters have no outlines, give others")
    (_, low), (_, high) = box(capital)
    scale = height / (high - low)
    return placed(outlines, (scale, scale), z)


def _outlines(string: str, font: str | None) -> list[Contour]:
    """Return the contours of a text, with curves as polygons. All are closed; their scale is arbitrary."""
    from matplotlib.font_manager import FontProperties, findfont, get_font
    from matplotlib.path import Path
    from matplotlib.textpath import text_to_path

    properties = FontProperties(family="DejaVu Sans" if font is None else word("font", font))
    try:
        letters = get_font(findfont(properties, fallback_to_default=False))
    except ValueError:
        cure = "matplotlib finds none of that name, give another or leave it out"
        raise refused("font", font, cure) from None
    for letter in string:
        if letters.get_char_index(ord(letter)) == 0:
            raise refused("string", string, f"the font has no {letter!r}, give one line of other letters")
    vertices, codes = text_to_path.get_text_path(properties, string)
    contours: list[list[Points]] = []
    outline: Any = Path(vertices, codes)
    for segment, code in outline.iter_bezier() if len(vertices) else ():
        if code == Path.MOVETO:
            contours.append([segment.control_points])
        else:
            contours[-1].append(segment(ways(code in (Path.LINETO, Path.CLOSEPOLY)))[1:])
    return [(np.concatenate(contour), True) for contour in contours]


def points_along(contours: Iterable[Contour], step: float) -> Points:
    """Return points (M, 3) along contours with vertices (K, 3)."""
    return along([np.concatenate([way, way[:1]]) if closed else way for way, closed in contours], step)


def placed(contours: Iterable[Contour], scale: tuple[float, float], z: float) -> list[Contour]:
    """Return contours (K, 2) scaled and moved to the plane at z, with their common centre at x = y = 0."""
    contours = list(contours)
    least, most = box(contours)
    flat = [((vertices - (least + most) / 2) * scale, closed) for vertices, closed in contours]
    return [(np.column_stack([vertices, np.full(len(vertices), z)]), closed) for vertices, closed in flat]


def box(contours: Iterable[Contour]) -> tuple[Points, Points]:
    """Return the least and the largest coordinates of contours."""
    every = np.concatenate([vertices for vertices, _ in contours])
    return every.min(axis=0), every.max(axis=0)


def ways(straight: bool) -> Points:
    """Return the parameters, from 0 to 1, at which a straight or curved segment is sampled."""
    return np.linspace(0.0, 1.0, 2 if straight else PIECES + 1)
