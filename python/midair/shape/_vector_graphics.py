"""SVG drawings as points (svgelements)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, iterparse

import numpy as np

from .._midair import MOST_POINTS, STEP, SceneError, stated
from .._support.arguments import existing, needs, number, refused, shown
from .._support.text import content
from ._figures import Contour, Points, box, placed, points_along, ways

#: Limits with which svgelements reads a drawing within seconds. Its time grows with the square of the length
#: of a transform or a style sheet. References count as copies of the elements that they name.
MOST_DEPTH = 100
MOST_LETTERS = 4 << 20
MOST_TRANSFORM = 2000
MOST_STYLE = 16_000

#: Attributes that may be long; attributes that are ignored, such as embedded pictures.
LONG, PASSED = ("d", "points"), ("href", "{http://www.w3.org/1999/xlink}href")


def svg(path: str | PathLike[str], *, size: float, z: float, step: float = STEP) -> Points:
    """Return points on the paths and basic shapes of an SVG drawing, its middle at (0, 0, z), y up.

    Parameters
    ----------
    path : str or path
        A file, or text that begins with "<".
    size : float
        Longer side of the drawing, in m.
    z : float
        Height of its plane in m.
    step : float, optional
        Distance between neighbours in m.

    Returns
    -------
    (M, 3) ndarray
        Points in m.

    Raises
    ------
    SceneError
        For a missing file or one that draws nothing, sizes not above 0, and for more than 100000 points.

    Notes
    -----
    Colours, widths and fillings have no effect. Text is left out unless it was turned into paths.

    Examples
    --------
    >>> import midair
    >>> drawing = '<svg xmlns="http://www.w3.org/2000/svg"><circle r="5"/></svg>'
    >>> midair.shape.svg(drawing, size=0.04, z=0.15).shape
    (59, 3)
    """
    return points_along(outlines("shape.svg", path, size, z), number("step", step))


def outlines(caller: str, path: str | PathLike[str], size: float, z: float) -> list[Contour]:
    """Return the contours in m of an SVG file or text; errors name the function `caller`."""
    size, z = number("size", size, above=0), number("z", z)
    written = isinstance(path, str) and path.lstrip().startswith("<")
    name = Path("SVG text") if written else existing("path", path, "give an SVG file")
    with needs(f"{caller} needs svgelements", "shapes"):
        import svgelements
    try:
        source = str(path).encode() if written else content(name, empty=True)
        _check(name, source)
        drawing = svgelements.SVG.parse(BytesIO(source))
        found = [
            contour for part in _parts(svgelements, name, drawing) for contour in _contours(svgelements, part)
        ]
    except SceneError:
        raise
    # The parser raises errors of many kinds for a damaged file.
    except Exception as error:
        raise refused("path", name, "it cannot be read as SVG, give another file") from error
    if not found:
        raise refused("path", name, "nothing is drawn in it, give one with paths or basic shapes")
    least, most = box(found)
    longer = float((most - least).max())
    if not 0 < longer < np.inf:
        raise refused("path", name, f"what it draws is {shown(longer)} large, give another file")
    scale = size / longer
    return placed(found, (scale, -scale), z)


def one_outline(path: str | PathLike[str], size: float, z: float) -> Contour:
    """Return the contour in m of an SVG file or text, which a point walks; rejects several contours."""
    contours = outlines("path.svg", path, size, z)
    if len(contours) > 1:
        cure = "leave one in each drawing, and put paths together by & or .then(..., fade=)"
        raise stated("the drawing", f"has {len(contours)} outlines, of which a point walks one", cure)
    return contours[0]


def _check(file: Path, source: bytes) -> None:
    """Raise SceneError for a drawing that is too large or too deeply nested, with its references expanded."""

    def wrong(what: str) -> SceneError:
        return refused("path", file, f"{what}, simplify it")

    named: dict[str, Element] = {}
    style = depth = 0
    root = Element("svg")
    for event, element in iterparse(BytesIO(source), ("start", "end")):
        depth += 1 if event == "start" else -1
        if depth > MOST_DEPTH:
            raise wrong(f"it is more than {MOST_DEPTH} deep")
        if event == "start":
            root = element if depth == 1 else root
            named[element.get("id", "")] = element
            for name, value in element.attrib.items():
                most = MOST_TRANSFORM if name.lower().endswith("transform") else MOST_STYLE
                if name not in LONG + PASSED and len(value) > most:
                    raise wrong(f"it has {name.rpartition('}')[2]} of more than {most} letters")
        elif element.tag.endswith("style"):
            style += len(element.text or "")
            if style > MOST_STYLE:
                raise wrong(f"it has style sheets of more than {MOST_STYLE} letters")
    _unfolded(root, named, {}, wrong)


def _unfolded(
    element: Element,
    named: dict[str, Element],
    known: dict[int, tuple[int, int, int]],
    wrong: Callable[[str], SceneError],
) -> tuple[int, int, int]:
    """Return the number of elements, letters of attributes, and depth, with references expanded."""
    if id(element) in known:
        if not (found := known[id(element)])[0]:
            raise wrong("a <use> in it refers to itself")
        return found
    known[id(element)] = (0, 0, 0)
    inner = list(element)
    if element.tag.endswith("use"):
        target = next((element.get(name) for name in reversed(PASSED) if element.get(name)), None) or ""
        inner += [named[target[1:]]] if target[1:] in named else []
    parts = [_unfolded(part, named, known, wrong) for part in inner]
    letters = sum(len(value) for name, value in element.attrib.items() if name not in PASSED)
    count, letters = 1 + sum(part[0] for part in parts), letters + sum(part[1] for part in parts)
    depth = 1 + max((part[2] for part in parts), default=0)
    if count > MOST_POINTS or letters > MOST_LETTERS or depth > MOST_DEPTH:
        raise wrong(
            f"unfolded, it has more than {MOST_POINTS} elements, {MOST_LETTERS >> 20} MB"
            f" or {MOST_DEPTH} levels"
        )
    known[id(element)] = count, letters, depth
    return known[id(element)]


def _parts(svgelements: Any, file: Path, drawing: Any) -> Iterator[list[Any]]:
    """Yield the segments of each part of a drawing's paths and shapes."""
    left = MOST_POINTS
    for element in drawing.elements():
        if isinstance(element, svgelements.Shape):
            for part in svgelements.Path(element).as_subpaths():
                segments = list(part)
                left -= len(segments)
                if left < 0:
                    raise refused(
                        "path", file, f"it has more than {MOST_POINTS} lines and curves, simplify it"
                    )
                yield segments


def _contours(svgelements: Any, part: list[Any]) -> Iterator[Contour]:
    """Yield the contour of a part as a polygon in the drawing's units, y down; none for length 0."""
    drawn = [
        segment for segment in part if not isinstance(segment, svgelements.Move) and segment.end is not None
    ]
    if not drawn:
        return
    pieces = [
        np.asarray(segment.npoint(ways(not isinstance(segment, svgelements.Curve))), float)
        for segment in drawn
    ]
    vertices = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    if (vertices != vertices[0]).any():
        yield vertices, any(isinstance(segment, svgelements.Close) for segment in drawn)
