"""Places names beside the points of a scatter plot, so that no name covers another name or a point."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

#: Boxes (K, 4) in pixels: x0, y0, x1, y1.
Boxes = NDArray[np.float64]

#: Lengths in points of 1/72 inch. MARKER: half of a marker. GAPS: from a marker to its name. MARGIN: around a
#: name, across and up (negative because a text's box has empty space above and below the letters). SIZE: font
#: size.
MARKER = 3.2
GAPS = (1.0, 3.0, 6.0, 10.0)
MARGIN = (1.0, -1.0)
SIZE = 8.0
#: Directions of a name from its point, in order of preference: right and left are easiest to read.
ANGLES = np.radians([0, 180, 90, 270, 30, 150, 210, 330, 60, 120, 240, 300])
#: Costs of a place in addition to its gap: for each direction in ANGLES before that of the place, and for
#: each other box that the place covers.
TURN, COVER = 0.25, 1000.0
#: Number of random orders in which the names choose their places.
ORDERS = 50


class Place(NamedTuple):
    """A place for a name: its offset from the point, its box, and its cost without other names."""

    offset: NDArray[np.float64]
    box: Boxes
    cost: float


def write(axes: Axes, names: Sequence[str], points: NDArray[np.float64], colours: Sequence[str]) -> None:
    """Writes each name near its point (K, 2) in data coordinates; the figure's layout must be final."""
    unit = axes.get_figure().dpi / 72
    pixels = axes.transData.transform(points)
    markers = np.hstack([pixels - MARKER * unit, pixels + MARKER * unit])
    texts = [
        axes.annotate(
            name,
            point,
            (0, 0),
            textcoords="offset pixels",
            color=colour,
            fontsize=SIZE,
            ha="center",
            va="center",
        )
        for name, point, colour in zip(names, points, colours, strict=True)
    ]
    choices = []
    for number, text in enumerate(texts):
        half = np.array(text.get_window_extent().size) / 2 + unit * np.array(MARGIN)
        others = np.delete(markers, number, axis=0)
        choices.append(_places(pixels[number], half, others, np.array(axes.bbox.extents), unit))
    for text, place in zip(texts, _arrange(choices), strict=True):
        text.set_position(place.offset)


def _places(
    point: NDArray[np.float64], half: NDArray[np.float64], others: Boxes, frame: Boxes, unit: float
) -> list[Place]:
    """Returns all places for a name around its point."""
    places = []
    for gap in GAPS:
        for turn, angle in enumerate(ANGLES):
            way = np.round([np.cos(angle), np.sin(angle)], 9)
            offset = (gap + MARKER) * unit * way + np.sign(way) * half
            box = np.hstack([point + offset - half, point + offset + half])
            hidden = _covered(box, others) + bool(np.any(box[:2] < frame[:2]) or np.any(box[2:] > frame[2:]))
            places.append(Place(offset, box, gap + TURN * turn + COVER * hidden))
    return places


def _covered(box: Boxes, others: Boxes) -> int:
    """Returns the number of other boxes that overlap a box."""
    apart = (box[2:] <= others[:, :2]) | (box[:2] >= others[:, 2:])
    return int((~apart.any(axis=1)).sum())


def _arrange(choices: Sequence[list[Place]]) -> list[Place]:
    """Returns a place for each name: the cheapest result of many random orders.

    In each order, one name after another takes its cheapest place.
    """
    random = np.random.default_rng(0)
    best: list[Place] = []
    least = np.inf
    for _ in range(ORDERS):
        found: dict[int, Place] = {}
        total = 0.0
        for number in random.permutation(len(choices)).tolist():
            taken = np.array([place.box for place in found.values()]).reshape(-1, 4)
            costs = [place.cost + COVER * _covered(place.box, taken) for place in choices[number]]
            cheapest = int(np.argmin(costs))
            found[number] = choices[number][cheapest]
            total += costs[cheapest]
        if total < least:
            least, best = total, [found[number] for number in range(len(choices))]
    return best
