"""Display in notebooks (HTML): arrays, scenes, solutions, fields, sequences and the list of solvers."""

import base64
import math
from collections.abc import Iterable, Sequence
from io import BytesIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._midair import Array, Batch, Field, Scene, Solution, SolverInfo
from .._support.arguments import without_warnings
from .._support.text import counted, facts as _facts, html
from .colours import loud, table

#: Longer side of a picture in SVG units.
SIDE = 1000

#: Largest numbers of points, and of corners of paths, in a picture. If there are more, only every second,
#: third, ... is drawn.
MOST_POINTS, MOST_CORNERS = 200, 400

#: Largest number of dots for transducers in a picture. If there are more, one in each square of SQUARE units
#: is drawn.
MOST_DOTS, SQUARE = 1500, 25

#: Colours of points and of quiet points, visible on light and on dark pages.
POINT, QUIET = "#e0662e", "#3b8fd4"

#: Radius of a ring in units for up to LARGE points; more points have smaller rings with the same total area.
RING, LARGE = 22, 12


def above(
    array: Array,
    points: NDArray[np.float64],
    *,
    quiet: ArrayLike = False,
    got: ArrayLike | None = None,
    drive: NDArray[np.complex64] | None = None,
) -> str:
    """Return an SVG: rings at the points (M, 3) in m, and dots at the transducers, from above.

    Parameters
    ----------
    quiet
        (M,) bool: which points are to be silent; they are blue.
    got
        |p| / target (M,): the radius of a filled disc, relative to its ring.
    drive
        (N,): the phases give the transducers' colours; those that are off stay grey.
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
    title = f"{counted(len(points), 'point')} over {counted(len(array), 'transducer')}, from above"
    return view.drawn(marks, title if drive is None else f"{title}; colours are phases", drive)


def trails(array: Array, points: NDArray[np.float64], closed: bool) -> str:
    """Return an SVG of the paths of points (T, M, 3) in m over the transducers; a ring marks each start."""
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
    """Return the radius of rings, in units, for this number of points."""
    return round(RING * min(1.0, math.sqrt(LARGE / max(count, 1))))


def _rings(places: NDArray[np.int_], colour: str, ring: int) -> str:
    circles = "".join(_circle(place, ring) for place in places)
    return f'<g fill="none" stroke="{colour}" stroke-width="6">{circles}</g>' if circles else ""


def _circle(place: NDArray[np.int_], size: int) -> str:
    return f'<circle cx="{place[0]}" cy="{place[1]}" r="{size}"/>'


class _View:
    """The visible area: a box around array and points, in integer units with y down."""

    def __init__(self, array: Array, points: NDArray[np.float64]) -> None:
        everything = np.vstack([array.positions[:, :2], points[:, :2]])
        least, most = everything.min(axis=0), everything.max(axis=0)
        # A margin also for a single point or transducers on one line, whose box would have no area.
        room = max(float((most - least).max()), 1e-3)
        edge = 0.06 * room
        self._corner = np.array([least[0] - edge, most[1] + edge])
        size = most - least + 2 * edge
        self._scale = SIDE / float(size.max())
        self._size = np.ceil(size * self._scale).astype(int)
        self._array = array

    def place(self, points: NDArray[np.float64]) -> NDArray[np.int_]:
        """Return points in m as (x, y) in units."""
        units = (points[:, :2] - self._corner) * self._scale * np.array([1, -1])
        return np.asarray(np.rint(units).astype(int))

    def drawn(self, marks: str, title: str, drive: NDArray[np.complex64] | None = None) -> str:
        """Return the picture: marks over the transducers' dots, which have the colours of their phases."""
        dots = self.place(self._array.positions)
        kept = np.arange(len(dots))
        if len(dots) > MOST_DOTS:
            dots, kept = np.unique(dots // SQUARE, axis=0, return_index=True)
            dots = dots * SQUARE
        if drive is None:
            path = _dots(dots, 14, 'stroke="currentColor" stroke-opacity=".35"')
        else:
            phases = (np.angle(drive[kept]) / (2 * np.pi) + 0.5) * HUES
            hues = np.where(drive[kept] == 0, HUES, np.rint(phases).astype(int) % HUES)
            colours = [bytes(colour).hex() for colour in table("phase")[:: 256 // HUES]]
            strokes = [f'stroke="#{colour}"' for colour in colours[:HUES]]
            strokes.append('stroke="currentColor" stroke-opacity=".15"')
            # Dots as wide as the distance between neighbours in a grid.
            wide = int(np.clip(0.7 * np.sqrt(np.prod(self._size) / len(dots)), 6, 60))
            path = "".join(_dots(dots[hues == hue], wide, strokes[hue]) for hue in np.unique(hues))
        width, height = self._size
        size = f'width="{200 * width // SIDE}" height="{200 * height // SIDE}"'
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" {size} role="img">'
            f"<title>{title}</title>{path}{marks}</svg>"
        )


#: Number of colours of phases in the picture of an array.
HUES = 32


def _dots(dots: NDArray[np.int_], wide: int, stroke: str) -> str:
    """Return dots of one colour as a path: each is a line of length 0 with round ends."""
    steps = np.diff(dots, axis=0, prepend=[[0, 0]])
    path = "".join(f"m{x} {y}h0" for x, y in steps)
    return f'<path d="{path}" {stroke} stroke-width="{wide}" stroke-linecap="round"/>'


#: Side of a slice in pixels on the page, and its largest number of samples per side.
SLICE, SAMPLES = 200, 100

#: Largest number of products (transducers x samples) for which a slice is computed: a notebook cell must not
#: wait long.
PRODUCTS = 2e8


def slice_of(field: Field) -> str:
    """Return |p| of a field in its plane with points, axes and colour bar, as an SVG of about 15 kB."""
    pressure = np.abs(field.pressure)
    plane = field.plane
    assert plane is not None
    assert field.shown is not None
    top = loud(field) or 1.0
    every = -(-plane.pixels // SAMPLES)
    shades = np.rint(255 * np.clip(pressure[::-every, ::every] / top, 0, 1)).astype(np.uint8)
    names = [name for name in "xyz" if name != plane.axis]
    axes = ["xyz".index(name) for name in names]
    low = np.array([getattr(field, name)[0] for name in names])
    high = np.array([getattr(field, name)[-1] for name in names])
    places = (field.scene.points[field.shown][:MOST_POINTS, axes] - low) / (high - low) * SLICE
    rings = "".join(f'<circle cx="{x:.1f}" cy="{SLICE - y:.1f}" r="3"/>' for x, y in places)
    across, up = (f"{name} {1e3 * a:.3g} to {1e3 * b:.3g} mm" for name, a, b in zip(names, low, high, strict=True))
    unit = "" if field.scene.in_paper_unit else " Pa"
    bar = np.arange(255, -1, -1, dtype=np.uint8)[:, None]
    frame = f'height="{SLICE}" preserveAspectRatio="none"'
    described = f"|p| where {plane.axis} = {1e3 * plane.at:.4g} mm, up to {top:.4g}{unit}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SLICE + 70}" height="{SLICE + 34}" role="img" '
        f'font-family="sans-serif" font-size="11" fill="currentColor"><title>{described}</title>'
        f'<image width="{SLICE}" {frame} href="{_image(shades)}"/>'
        f'<image x="{SLICE + 6}" width="10" {frame} href="{_image(bar)}"/>'
        f'<g fill="none" stroke="deepskyblue">{rings}</g>'
        f'<text x="{SLICE + 20}" y="10">{top:.4g}{unit}</text><text x="{SLICE + 20}" y="{SLICE}">0</text>'
        f'<text y="{SLICE + 14}">{across}</text><text y="{SLICE + 29}">{up}, {plane.axis} = '
        f"{1e3 * plane.at:.3g} mm</text></svg>"
    )


def _image(shades: NDArray[np.uint8]) -> str:
    """Return a PNG of shades (rows, columns) in the field's colours, as a data URL."""
    from PIL import Image

    picture, content = Image.fromarray(shades), BytesIO()
    picture.putpalette(table("field").tobytes())
    picture.save(content, "PNG")
    text = base64.b64encode(content.getvalue()).decode()
    return f"data:image/png;base64,{text}"


#: Largest number of rows of a list of points or problems.
MOST = 12


class Solvers(dict[str, SolverInfo]):
    """The solvers by name: a dictionary whose text has one solver per line."""

    def __repr__(self) -> str:
        width = max(map(len, self), default=0)
        return "\n".join(f"{name:{width}}  {info.summary}" for name, info in self.items())

    def _repr_html_(self) -> str:
        rows = [(name, info.summary, ", ".join(info.options), info.source) for name, info in self.items()]
        return _table(rows, ("solver", "what it does", "options", "source"))


def solvers() -> Solvers:
    """List every solver by name, with its options and its source.

    Returns
    -------
    dict of str to midair.SolverInfo
        A dictionary that prints as a table.

    Examples
    --------
    >>> import midair
    >>> midair.solvers()["greedy"].options["phases"].default
    16
    """
    return Solvers(_midair.solvers())


def array(array: Array) -> str:
    """Return the HTML of an array: its size, transducers and board."""
    extent = " x ".join(f"{size:.4g}" for size in 1e3 * np.ptp(array.positions, axis=0))
    directivity = array.directivity
    if not isinstance(directivity, str):
        directivity = ", ".join(f"{name} {parameter:.4g}" for name, parameter in directivity.items())
    board = array.quantization
    return _facts(
        ("midair.Array", f"{len(array)} transducers"),
        ("extent", f"{extent} mm"),
        ("source pressure", f"{array.source_pressure:.4g} Pa m"),
        ("directivity", directivity),
        ("phases", "any" if board is None or board["phases"] is None else board["phases"]),
        ("amplitudes", "any" if board is None or board["amplitudes"] is None else np.size(board["amplitudes"])),
        ("off", int((~array.mask).sum())),
    )


def scene(scene: Scene) -> str:
    """Return the HTML of a scene: its air, its array, its points and a picture."""
    pressures, weights = scene.pressures, scene.weights
    rows = [
        (
            k + 1,
            *(f"{x:.4g}" for x in 1e3 * point),
            "balanced" if pressures is None else f"{pressures[k]:.4g}",
            1 if weights is None else f"{weights[k]:.4g}",
        )
        for k, point in enumerate(scene.points[:MOST])
    ]
    facts = _facts(
        ("midair.Scene", f"{len(scene.array)} transducers, {len(scene.points)} points"),
        ("frequency", f"{scene.frequency:.6g} Hz"),
        ("sound speed", f"{scene.sound_speed:.5g} m/s"),
        ("wavelength", f"{1e3 * scene.wavelength:.4g} mm"),
        *([] if scene.solver is None else [("solver", scene.solver[0])]),
        *([("obstacles", str(scene.obstacles))] if scene.obstacles else []),
    )
    head = ("point", "x / mm", "y / mm", "z / mm", "pressure / Pa", "weight")
    listed = _table(rows, head, len(scene.points))
    quiet = False if pressures is None else pressures == 0
    return facts + listed + above(scene.array, scene.points, quiet=quiet)


def solution(solution: Solution) -> str:
    """Return the HTML of a solution: status, metrics, targets and pressures of the points, and pictures.

    In the first picture a ring is a point's target, the disc in it its pressure, and the colour of a
    transducer its phase. The second one shows |p| in the plane through the points.
    """
    got, targets = np.abs(solution.pressures), solution.targets
    rows = [
        (k + 1, f"{target:.4g}", f"{pressure:.4g}", f"{pressure / target:.3f}" if target else "quiet")
        for k, (target, pressure) in enumerate(zip(targets[:MOST], got, strict=False))
    ]
    facts = _facts(
        ("midair.Solution", f"{solution.solver}, {solution.status}, {solution.steps} steps"),
        *((name, f"{value:.4f}") for name, value in solution.metrics.asdict().items()),
        *([] if solution.scale == 1 else [("scale", f"{solution.scale:.4f}")]),
        ("time", f"{1e3 * solution.elapsed:.4g} ms"),
    )
    listed = _table(rows, ("point", "target / Pa", "pressure / Pa", "ratio"), len(got))
    if solution.scene is None:
        return facts + listed
    scene, part = solution.scene, got / np.where(targets > 0, targets, np.inf)
    phases = above(scene.array, scene.points, quiet=targets == 0, got=part, drive=solution.drive)
    return facts + listed + phases + _slice(solution)


def _slice(solution: Solution) -> str:
    """Return the slice through a solution's points; the first one if the points lie in several planes."""
    scene = solution.scene
    if scene is None or len(scene.array) * SAMPLES**2 > PRODUCTS:
        return ""
    with without_warnings():
        # The solve has already warned of probable mistakes.
        return slice_of(_midair.field(scene, solution))


def field(field: Field) -> str:
    """Return the HTML of a field: its plane, its largest |p| and, if it has a plane, a picture."""
    loudest = f"{np.abs(field.pressure).max():.4g}{'' if field.scene.in_paper_unit else ' Pa'}"
    if field.plane is None:
        return _facts(("midair.Field", f"at {field.pressure.size} points"), ("loudest", loudest))
    plane, panels = field.plane, len(field.panels)
    return _facts(
        ("midair.Field", f"{plane.pixels} x {plane.pixels} places"),
        ("plane", f"{plane.axis} = {1e3 * plane.at:.4g} mm, {1e3 * plane.size:.4g} mm wide"),
        *([("further planes", f"{panels - 1}, in field.panels")] if panels > 1 else []),
        ("loudest", loudest),
        *([] if field.solution is None else [("solver", field.solution.solver)]),
    ) + slice_of(field)


def sequence(array: Array, points: NDArray[np.float64], closed: bool, facts: Iterable[tuple[str, object]]) -> str:
    """Return the HTML of a sequence: its properties and the paths of its points (T, M, 3)."""
    return _facts(*facts) + trails(array, points, closed)


def batch(batch: Batch) -> str:
    """Return the HTML of a batch: mean, least and largest metrics of its problems."""
    rows = [
        (name, f"{values.mean():.4f}", f"{values.min():.4f}", f"{values.max():.4f}")
        for name, values in batch.metrics.asdict().items()
    ]
    facts = _facts(
        ("midair.Batch", f"{len(batch)} problems of {batch.pressures.shape[1]} points"),
        *((status, batch.status.count(status)) for status in sorted(set(batch.status))),
        ("time", f"{1e3 * batch.elapsed:.4g} ms"),
    )
    return facts + _table(rows, ("metric", "mean", "least", "most"))


def _table(rows: Sequence[Iterable[object]], names: Sequence[str], count: int = 0) -> str:
    """Return an HTML table with a head; `count` is the number of all rows, also of those left out."""
    columns = {name: [str(cell) for cell in column] for name, *column in zip(names, *rows, strict=True)}
    return html(columns, f"the first of {count}" if count > len(rows) else "")
