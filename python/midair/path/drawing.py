"""Outlines of SVG drawings as paths."""

from __future__ import annotations

from os import PathLike

from numpy.typing import ArrayLike

from .._midair import SceneError
from ..shape.vector_graphics import outlines
from .curve import lines
from .path import Path
from .walk import walk


def svg(
    path: str | PathLike[str],
    *,
    size: float,
    z: float,
    speed: float | None = None,
    frequency: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """A point along the outline that an SVG file, or SVG text, draws, its middle at (0, 0, z), y up.

    size : the longer side of what is drawn, in m
    speed : in m/s; or
    frequency : how often a second it walks the outline
    pressures : in Pa; left out, balanced

    The path is closed where the outline is. A drawing of several outlines is refused.

    Raises SceneError for a file that is not there or draws more than one outline, and unless either a speed
    or a frequency above 0 is given.
    """
    contours = outlines("path.svg", path, size, z)
    if len(contours) > 1:
        cure = "leave one in each drawing, and put paths together by & or .then(..., fade=)"
        raise SceneError(f"the drawing has {len(contours)} outlines, of which a point walks one: {cure}")
    return walk(lines(*contours[0]), speed=speed, frequency=frequency, pressures=pressures)
