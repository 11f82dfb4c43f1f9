"""Paths: control points that move, at constant speed along curves, and their targets in time.

Each function returns a `Path`: `.at(times)` are places (T, M, 3) in m, `.targets(times)` targets (T, M), in
Pa if `pressures` were given, else from 0 to 1. Speed is in m/s along the curve, frequency in laps a
second. `a & b` are both at the same time, `a.then(b)` one after the other, `a.with_am(200)` is modulated.

Examples
--------
>>> import midair
>>> ring = midair.path.circle([0, 0, 0.15], 0.02, frequency=50, points=3)
>>> ring
Path(points=3, duration=0.02, closed=True)
>>> points, targets = ring.with_am(200).frames(rate=10e3)
>>> points.shape, targets.shape
((200, 3, 3), (200, 3))
"""

from .._midair import Path
from .._support import slips as _slips
from ._frames import from_array, read
from ._gcode import gcode, lcode
from ._kinds import circle, line, lissajous, morph, polyline, still, svg, text
from ._optimal import fastest

__all__ = ["Path", "circle", "fastest", "from_array", "gcode", "lcode", "line", "lissajous"]
__all__ += ["morph", "polyline", "read", "still", "svg", "text"]

_slips.attach(__name__)
