"""Shapes as points: lines, circles, polylines, text and SVG drawings, evenly spaced along their contours.

Each function returns points (M, 3) in m, for `midair.Scene(array, points)`. `step` is the distance of
neighbours along a contour. By default it is a quarter of the wavelength at 40 kHz and 340 m/s, 2.125 mm, at
which the points run together into a line. It is changed a little, so that each contour has equal steps. A
contour that closes has no doubled point. Where contours cross or touch, a point nearer than half a step to
one before it is left out.

Examples
--------
>>> import midair
>>> midair.shape.line([-0.02, 0, 0.15], [0.02, 0, 0.15], step=0.01)[:, 0].round(3).tolist()
[-0.02, -0.01, 0.0, 0.01, 0.02]
>>> midair.shape.circle([0, 0, 0.15], 0.02).shape
(59, 3)
"""

from .._midair import MOST_POINTS, STEP
from .._support import slips as _slips
from ._figures import circle, line, polyline, text
from ._vector_graphics import svg

__all__ = ["MOST_POINTS", "STEP", "circle", "line", "polyline", "svg", "text"]

_slips.attach(__name__)
