"""Above: the array and the points as somebody sees them from above, a small SVG without any library."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array

#: The picture's longer side, in its own units; a unit is a thousandth of what it shows.
SIDE = 1000

#: The most points and corners of trails that are drawn; of more of them every second, third, ...
MOST_POINTS, MOST_CORNERS = 200, 400

#: The most transducers that are drawn; of more of them one in each square of so many units.
MOST_DOTS, SQUARE = 1500, 25

#: Colours that can be told from a light and from a dark page.
POINT, QUIET = "#e0662e", "#3b8fd4"

#: Radius of the rings of up to so many points, in units; of more the rings cover as much together.
RING, LARGE = 22, 12


def above(
    array: Array, points: NDArray[np.float64], *, quiet: ArrayLike = False, got: ArrayLike | None = None
) -> str:
    """Rings at the points (M, 3) in m over the dots of the transducers.

    quiet : which points (M,) are to be silent; they are drawn in blue
    got : |p| / target (M,), whose share of each ring is filled: the disc's radius is that part of the ring's
    """
    view = _View(array, points)
    chosen = slice(None, None, -(-len(points) // MOST_POINTS))
    places = view.place(points)[chosen]
    silent = np.broadcast_to(np.asarray(quiet, bool), len(points))[chosen]
    ring = radius(len(places))
    marks = _rings(places[~silent], POINT, ring) + _rings(places[silent], QUIET, ring)
    if got is not None:
        share = np.clip(np.nan_to_num(np.asarray(got, float)), 0, 1.5)[chosen]
        sizes = np.rint(ring * share).astype(int)
        discs = zip(places[~silent], sizes[~silent], strict=True)
        marks += f'<g fill="{POINT}">{"".join(_circle(place, size) for place, size in discs)}</g>'
    return view.drawn(marks, f"{len(points)} points over {len(array)} transducers, from above")


def trails(array: Array, points: NDArray[np.float64], closed: bool) -> str:
    """The ways of points (T, M, 3) in m over the dots of the transducers, a ring where each begins."""
    view = _View(array, points.reshape(-1, 3))
    shown = points[:, : MOST_POINTS // 2]
    every = max(1, -(-shown.shape[0] * shown.shape[1] // MOST_CORNERS))
    marks, begins = "", []
    for way in shown.swapaxes(0, 1):
        corners = view.place(way[::every] if closed else np.vstack([way[::every], way[-1:]]))
        line = " ".join(f"{x},{y}" for x, y in corners)
        marks += f'<{"polygon" if closed else "polyline"} points="{line}"/>'
        begins.append(corners[0])
    marks = f'<g fill="none" stroke="{POINT}" stroke-width="8">{marks}</g>'
    marks += _rings(np.array(begins), POINT, radius(len(begins)))
    return view.drawn(marks, f"{points.shape[1]} moving points over {len(array)} transducers, from above")


def radius(count: int) -> int:
    """Of the rings of so many points, in units."""
    return round(RING * min(1.0, math.sqrt(LARGE / max(count, 1))))


def _rings(places: NDArray[np.int_], colour: str, ring: int) -> str:
    circles = "".join(_circle(place, ring) for place in places)
    return f'<g fill="none" stroke="{colour}" stroke-width="6">{circles}</g>' if circles else ""


def _circle(place: NDArray[np.int_], size: int) -> str:
    return f'<circle cx="{place[0]}" cy="{place[1]}" r="{size}"/>'


class _View:
    """What is seen: a box around array and points, in whole units with y down."""

    def __init__(self, array: Array, points: NDArray[np.float64]) -> None:
        everything = np.vstack([array.positions[:, :2], points[:, :2]])
        least, most = everything.min(axis=0), everything.max(axis=0)
        # A lone point, or transducers in one line, have room around them, too.
        room = max(float((most - least).max()), 1e-3)
        edge = 0.06 * room
        self._corner = np.array([least[0] - edge, most[1] + edge])
        size = most - least + 2 * edge
        self._scale = SIDE / float(size.max())
        self._size = np.ceil(size * self._scale).astype(int)
        self._array = array

    def place(self, points: NDArray[np.float64]) -> NDArray[np.int_]:
        """Points in m as (x, y) in units."""
        units = (points[:, :2] - self._corner) * self._scale * np.array([1, -1])
        return np.asarray(np.rint(units).astype(int))

    def drawn(self, marks: str, title: str) -> str:
        """The picture with marks over the transducers' dots."""
        dots = self.place(self._array.positions)
        if len(dots) > MOST_DOTS:
            dots = np.unique(dots // SQUARE, axis=0) * SQUARE
        # Each dot is a line of no length with round ends, from the one before: a few letters a transducer.
        steps = np.diff(dots, axis=0, prepend=[[0, 0]])
        path = "".join(f"m{x} {y}h0" for x, y in steps)
        width, height = self._size
        size = f'width="{200 * width // SIDE}" height="{200 * height // SIDE}"'
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" {size} role="img">'
            f"<title>{title}</title>"
            f'<path d="{path}" stroke="currentColor" stroke-opacity=".35" stroke-width="14" '
            f'stroke-linecap="round"/>{marks}</svg>'
        )
