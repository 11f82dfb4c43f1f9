"""Text as points: the outlines of its letters, by matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._support.arguments import number, refused, word
from ._contour import STEP, Contour, Points, box, placed, points_along, ways


def text(string: str, *, height: float, z: float, step: float = STEP, font: str | None = None) -> Points:
    """Points (M, 3) in m on the outlines of a line of text in the plane at z, its middle at x = y = 0.

    string : one line
    height : of a capital H, in m
    z : where the plane is, in m
    step : between neighbours, in m
    font : the name of a font that matplotlib finds; left out, DejaVu Sans, which it brings along

    Raises SceneError for text without outlines, an unknown font, sizes not above 0, and for more points than
    100000.
    """
    step, height, z = number("step", step, above=0), number("height", height, above=0), number("z", z)
    if not word("string", string).strip():
        raise refused("string", string, "give at least a letter")
    outlines, capital = _outlines(string, font), _outlines("H", font)
    if not outlines:
        raise refused("string", string, "its letters have no outlines, give others")
    (_, low), (_, high) = box(capital)
    scale = height / (high - low)
    return points_along(placed(outlines, (scale, scale), z), step)


def _outlines(string: str, font: str | None) -> list[Contour]:
    """The contours of a text, curves as polygons, at any one size; all close."""
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
