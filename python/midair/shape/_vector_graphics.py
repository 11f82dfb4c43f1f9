"""SVG drawings as points, by svgelements."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .._midair import SceneError
from .._support.arguments import existing, number, refused, shown
from ._contour import MOST_POINTS, STEP, Contour, Points, box, placed, points_along, ways


def svg(path: str | PathLike[str], *, size: float, z: float, step: float = STEP) -> Points:
    """Points (M, 3) in m on the paths and basic shapes of an SVG file or text, their middle at (0, 0, z).

    path : a file, or text that begins with "<"
    size : the longer side of what is drawn, in m
    z : where its plane is, in m
    step : between neighbours, in m

    y points up, as in the picture. Colours, widths and fillings are passed over, and so is text that was not
    turned into paths.

    Raises SceneError for a file that is not there or draws nothing, sizes not above 0, and for more points
    than 100000.
    """
    step = number("step", step, above=0)
    return points_along(outlines("shape.svg", path, size, z), step)


def outlines(caller: str, path: str | PathLike[str], size: float, z: float) -> list[Contour]:
    """What an SVG file or text draws, as contours in m, for the function `caller`."""
    size, z = number("size", size, above=0), number("z", z)
    written = isinstance(path, str) and path.lstrip().startswith("<")
    name = Path("SVG text") if written else existing("path", path, "give an SVG file")
    try:
        import svgelements
    except ImportError as error:
        raise SceneError(f'{caller} needs svgelements: pip install "midair[shapes]"') from error
    try:
        drawing = svgelements.SVG.parse(StringIO(str(path)) if written else str(name))
        found = [
            contour for part in _parts(svgelements, name, drawing) for contour in _contours(svgelements, part)
        ]
    except SceneError:
        raise
    # Whatever a damaged file makes the parser raise.
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


def _parts(svgelements: Any, file: Path, drawing: Any) -> Iterator[list[Any]]:
    """The segments of each part of a drawing's paths and shapes."""
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
    """The contour of a part as a polygon in the drawing's units, y down; none of no length."""
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
