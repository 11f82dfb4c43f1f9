"""`midair.exposure`: sound pressure levels at named places, beside a limit; audible levels of sequences."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field as member, replace
from itertools import product
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Scene, Solution, about, field, numbers, stated
from .._pictures.colours import Axes, Figure, Size
from .._points.ear import REFERENCE, Ear
from .._sequence import Sequence
from .._sequence.drives import rows
from .._support import text as columns
from .._support.arguments import callback, flag, number, refused, warn, without_warnings
from .audible import audible_lines, loudness


class Limit(NamedTuple):
    """A limit: its name, level in dB re 20 uPa, lowest and highest frequency in Hz, and source."""

    name: str
    spl: float
    band: tuple[float, float]
    source: str


LIMITS = {
    limit.name: limit
    for limit in (
        Limit(
            "howard",
            110.0,
            (25e3, 50e3),
            "consensus of the limits reviewed by Howard, Hansen and Zander 2004, under 4 hours a day",
        ),
        Limit(
            "acgih",
            115.0,
            (31.5e3, 100e3),
            "ACGIH, ceiling at work where the body may touch water or solids that carry the sound",
        ),
        Limit(
            "acgih air",
            145.0,
            (31.5e3, 100e3),
            "ACGIH, the same raised by 30 dB where the body cannot touch such water or solids",
        ),
        Limit("irpa", 100.0, (25e3, 100e3), "IRPA 1984, interim guideline for the public, continuous"),
    )
}


def limit_of(scene: Scene, requested: Any) -> Limit:
    """Return a limit by its name or by a level in dB; rejects one that does not cover the frequency."""
    if not isinstance(requested, str):
        return Limit("own", number("limit", requested), (0.0, float("inf")), "a level of your own")
    found = LIMITS.get(requested.lower().replace("-", " ").replace("_", " "))
    if found is None:
        raise refused("limit", requested, f"give {', '.join(LIMITS)}, or a level in dB")
    low, high = found.band
    if not low <= scene.frequency <= high:
        reported = f"is for {low / 1e3:g} to {high / 1e3:g} kHz, not {scene.frequency / 1e3:g} kHz"
        raise stated(f'limit "{found.name}"', reported, "give a level in dB that is meant for it")
    return found


Points: TypeAlias = NDArray[np.float64]
Levels: TypeAlias = Callable[[Points], NDArray[np.float64]]

#: Samples per wavelength: the loudest sample is at most 2.2 dB below the maximum (Duffin and Schaeffer 1938).
FINE = 8

#: Points per block, so that Ctrl-C takes effect between blocks; and most samples of a box.
BLOCK, MOST = 100_000, 20_000_000

#: Search for the maximum: number of starts, their least distance in wavelengths, halvings of the step.
STARTS, APART, HALVINGS = 32, 0.25, 5

#: Number of loudest samples from which the starts are chosen; one peak contains about 60 of them.
SAMPLES = 4000


def loudest(name: str, low: Points, high: Points, wavelength: float, levels: Levels) -> tuple[Points, float]:
    """Return the place in a box where `levels` of points (P, 3) is largest, and the level there."""
    step = wavelength / FINE
    counts = np.ceil((high - low) / step * (1 - 1e-9)).astype(int) + 1
    total = int(np.prod(counts, dtype=float))
    if total > MOST:
        sides = " x ".join(f"{side:.3g}" for side in high - low)
        cure = f"that is {total} points an eighth of a wavelength apart, give a box of at most {MOST}"
        raise refused(f'places["{name}"]', f"{sides} m", cure)
    axes = [np.linspace(*ends) for ends in zip(low, high, counts, strict=True)]
    starts, values = np.empty((0, 3)), np.empty(0)
    for first in range(0, total, BLOCK):
        cells = np.unravel_index(np.arange(first, min(first + BLOCK, total)), counts)
        points = np.stack([axis[cell] for axis, cell in zip(axes, cells, strict=True)], axis=1)
        points, found = np.r_[starts, points], np.r_[values, levels(points)]
        kept = _peaks(points, found, APART * wavelength)
        starts, values = points[kept], found[kept]
    around = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    for _ in range(HALVINGS):
        step /= 2
        tried = np.clip(starts[:, None] + step * around, low, high)
        found = levels(tried.reshape(-1, 3)).reshape(tried.shape[:2])
        best = found.argmax(axis=1)[:, None]
        starts = np.take_along_axis(tried, best[..., None], axis=1)[:, 0]
        values = np.take_along_axis(found, best, axis=1)[:, 0]
    first = int(values.argmax())
    return starts[first], float(values[first])


def _peaks(points: Points, values: NDArray[np.float64], apart: float) -> NDArray[np.int64]:
    """Return the indices of the loudest points that are at least `apart` m from all louder chosen ones."""
    left = np.argpartition(-values, SAMPLES)[:SAMPLES] if len(values) > SAMPLES else np.arange(len(values))
    left = left[np.argsort(-values[left], kind="stable")]
    taken: list[int] = []
    while len(left) and len(taken) < STARTS:
        taken.append(int(left[0]))
        left = left[np.linalg.norm(points[left] - points[left[0]], axis=1) > apart]
    return np.array(taken, dtype=np.int64)


#: Largest number of products (transducers x points x frames) per block, which take a fraction of a second.
WORK = 200_000_000

#: A function that yields |p| (P, T) in Pa at points (P, 3) in each frame, block by block.
Blocks: TypeAlias = Callable[[Points], Iterator[NDArray[np.float64]]]


@dataclass(frozen=True)
class Exposed:
    """Level at one place of a `midair.Exposure`.

    Attributes
    ----------
    name : str
        The name that you gave.
    spl : float
        20 log10(|p|/sqrt(2)/20 uPa) in dB, in a box at its loudest place; -inf in silence.
    position : (float, float, float)
        The place (x, y, z) in m.
    frame : int
        The loudest frame at this place, of a sequence; otherwise 0.
    audible : float or None
        A-weighted level in dB of the audible sound at the place, of a box in its middle, where it was
        requested; -inf in silence.

    Examples
    --------
    >>> import midair
    >>> midair.Exposed("left ear", 112.5, (0.0, 0.0, 0.6), 0).spl
    112.5
    """

    name: str
    spl: float
    position: tuple[float, float, float]
    frame: int
    audible: float | None = None


@dataclass(frozen=True, repr=False)
class Exposure:
    """Levels at named places, from `midair.exposure`: prints as a table, `["left ear"]` is a place.

    Attributes
    ----------
    places : tuple of midair.Exposed
        The places in the order given.
    limit : Limit
        Name, spl in dB, band in Hz and source of the limit.
    frequencies : (L,) ndarray or None
        Lines of the audible sound in Hz, where it was requested.
    sound : (K, L) ndarray or None
        Their peak pressures in Pa at each place.

    Examples
    --------
    >>> import midair
    >>> solution = midair.solve(midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]]))
    >>> found = solution.exposure({"near": [0, 0, 0.3], "far": [0, 0, 0.9]})
    >>> found.worst.name, found["far"].spl < found["near"].spl
    ('near', True)
    """

    places: tuple[Exposed, ...]
    limit: Limit
    frequencies: NDArray[np.float64] | None = member(default=None, compare=False)
    sound: NDArray[np.float64] | None = member(default=None, compare=False)

    @property
    def worst(self) -> Exposed:
        """Place with the highest level."""
        return max(self.places, key=lambda place: place.spl)

    @property
    def loudest(self) -> float | None:
        """Highest audible level in dB(A), where it was requested."""
        levels = [place.audible for place in self.places if place.audible is not None]
        return max(levels, default=None)

    @property
    def above(self) -> tuple[str, ...]:
        """Names of the places where the level is above the limit."""
        return tuple(place.name for place in self.places if place.spl > self.limit.spl)

    def _with(self, frequencies: NDArray[np.float64] | None, sound: NDArray[np.float64]) -> Exposure:
        """Return this with the lines (L,) in Hz and (K, L) in Pa of its audible sound."""
        assert frequencies is not None
        levels_of = zip(self.places, loudness(frequencies, sound), strict=True)
        places = tuple(replace(one, audible=float(level)) for one, level in levels_of)
        return Exposure(places, self.limit, frequencies, sound)

    def to_dict(self) -> dict[str, list[Any]]:
        """Return the table as columns: place, spl, over (the limit), audible in dB, x, y, z in m, frame."""
        places = self.places
        levels: dict[str, Any] = {
            "spl": [place.spl for place in places],
            "over": [p.spl - self.limit.spl for p in places],
        }
        if self.sound is not None:
            levels["audible"] = [place.audible for place in places]
        axes = {name: [place.position[axis] for place in places] for axis, name in enumerate("xyz")}
        names, frames = [place.name for place in places], [place.frame for place in places]
        return {"place": names, **levels, **axes, "frame": frames}

    def __getitem__(self, name: str) -> Exposed:
        named = {place.name: place for place in self.places}
        if name not in named:
            raise KeyError(f'no place is named "{name}": there are {", ".join(named)}')
        return named[name]

    def __len__(self) -> int:
        return len(self.places)

    def cells(self) -> dict[str, list[str]]:
        """Return the table as text; the column `frame` only if some place has a frame other than 0."""
        table = self.to_dict()
        cells = {
            "place": table["place"],
            "SPL / dB": [f"{spl:.1f}" for spl in table["spl"]],
            "over limit / dB": [f"{over:+.1f}" for over in table["over"]],
            "at x, y, z / mm": [", ".join(f"{1e3 * x:.1f}" for x in place.position) for place in self.places],
        }
        if "audible" in table:
            cells["audible / dB(A)"] = [f"{level:.1f}" for level in table["audible"]]
        return cells if not any(table["frame"]) else {**cells, "frame": [*map(str, table["frame"])]}

    @property
    def heading(self) -> str:
        """Name, level and source of the limit, as text."""
        return f'limit "{self.limit.name}", {self.limit.spl:g} dB: {self.limit.source}'

    @property
    def sentence(self) -> str:
        """The loudest place compared with the limit, in one sentence."""
        worst, over = self.worst, self.worst.spl - self.limit.spl
        if not np.isfinite(over):
            return f"{worst.name}: no sound"
        beside = f"{abs(over):.1f} dB {'above' if over > 0 else 'below'} the limit"
        loudest = "the loudest place" if len(self.places) > 1 else "the place"
        return f"{loudest}, {worst.name}, gets {worst.spl:.1f} dB, {beside}"

    def plot(self, ax: Axes | None = None, *, size: Size | None = None) -> Figure:
        """Draw the levels beside the limit, those above it in another colour.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own.
        size : float or (float, float), optional
            Size of the figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        SceneError
            For an invalid size.
        """
        from .._pictures.figures import dots, row

        height = 1.4 + 0.35 * len(self.places)
        figure, axes = row(None, ("levels",), ax, size, width=4.6, height=height)
        levels = {place.name: place.spl for place in self.places}
        dots(axes["levels"], levels, f'SPL / dB, limit "{self.limit.name}"', self.above, self.limit.spl)
        return figure

    def __repr__(self) -> str:
        return f"{columns.plain(self.cells())}\n{self.heading}"

    def _repr_html_(self) -> str:
        return columns.html(self.cells(), self.heading)


def exposure(
    scene: Scene | Solution | Sequence,
    drive: Any = None,
    places: Mapping[str, ArrayLike | Ear] | None = None,
    *,
    limit: str | float = "howard",
    audible: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> Exposure:
    """Compute sound pressure levels at named places, beside a limit and its source.

    Parameters
    ----------
    scene : midair.Scene, midair.Solution or midair.Sequence
        A solution or a sequence gives its scene and its drive: then `places` comes second, or
        `solution.exposure(places)`.
    drive : (N,) array_like, midair.Solution or midair.Sequence, optional
        The drive that plays. For a sequence, each place reports its loudest frame, taken as constant.
    places : mapping
        Places by name: a position (3,) in m, a box as two corners (2, 3), or a `midair.Ear` (a box).
        Positions must be at least lambda/100 from every transducer, boxes at least lambda.
    limit : str or float, optional
        "howard" (110 dB), "acgih" (115), "acgih air" (145), "irpa" (100), or a level in dB.
    audible : bool, optional
        Whether to compute the audible sound that the air makes of a sequence, clicks between frames included.
        Its time grows with frames times transducers.
    progress : callable, optional
        Called with (points, of how many) of the air; `audible` stops if it returns False.

    Returns
    -------
    midair.Exposure
        The level at each place; `print` shows a table.

    Raises
    ------
    SceneError
        For wrong places, a wrong limit or a wrong drive.
    TypeError
        If `scene` has another type.

    Notes
    -----
    SPL = 20 log10(|p|/sqrt(2)/20 uPa) of a steady wave. A box is sampled every eighth of a wavelength and
    searched about its loudest samples. The air is free: a head or a wall, which reflects, adds up to 6 dB.
    A limit is the level that its source states, not a promise of safety. A place behind every
    transducer gives a SceneWarning.

    The audible sound is the integral of d^2(|p|^2/2)/dt^2 beta/(4 pi rho c^4 R) over the air in front of the
    array, R from the ear, beta = 1.2 (Westervelt, J. Acoust. Soc. Am. 35, 535, 1963; on the axis far from a
    beam Berktay's formula, J. Sound Vib. 2, 435, 1965). The sequence repeats; its transducers have a time
    constant of .2 ms; no hand or wall stops the beam.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> found = midair.exposure(midair.solve(scene), {"left ear": [0, 0, 0.6]})
    >>> found.above
    ('left ear',)
    """
    if isinstance(scene, Sequence):
        scene, drive, places = scene.scene(0), scene, drive if places is None else places
    elif isinstance(scene, Scene) and drive is not None and places is None:
        cure = "a scene alone has no drive, give exposure(scene, solution, places) or leave the scene out"
        raise stated("places", "is None", cure, code="missing")
    else:
        scene, drive, places = about(scene, drive, places)
    named = limit_of(scene, limit)
    boxes = _boxes(places)
    wanted = flag("audible", audible)
    callback(progress, "points, of how many")
    if wanted and not isinstance(drive, Sequence):
        raise refused("audible", audible, "give a sequence: a drive that does not change makes no audible sound")
    blocks = _of_frames(scene, drive) if isinstance(drive, Sequence) else _of_one(scene, drive)

    def levels(points: Points) -> NDArray[np.float64]:
        return np.concatenate([block.max(axis=1) for block in blocks(points)])

    found = []
    for name, (low, high) in boxes.items():
        place = low
        if far := scene._far(f'places["{name}"]', high[None]):
            warn(far)
        _keep_off(scene, name, low, high)
        if all(scene.array._is_behind(corner) for corner in product(*zip(low, high, strict=True))):
            why = "behind every transducer, where the model has no sound that leaks: give a place in front"
            warn(f'places["{name}"] is {why}')
        if (high > low).any():
            place, _ = loudest(name, low, high, scene.wavelength, levels)
        (there,) = np.concatenate(list(blocks(place[None])))
        frame = int(there.argmax())
        spl = -np.inf if there[frame] == 0 else 20 * np.log10(there[frame] / np.sqrt(2) / REFERENCE)
        x, y, z = map(float, place)
        found.append(Exposed(name, float(spl), (x, y, z), frame))
    levels_at = Exposure(tuple(found), named)
    if not (wanted and isinstance(drive, Sequence)):
        return levels_at
    middles = np.array([(low + high) / 2 for low, high in boxes.values()])
    return levels_at._with(*audible_lines(drive, middles, progress))


def _boxes(places: Any) -> dict[str, tuple[Points, Points]]:
    """Return the lowest and highest corner of each place."""
    if not isinstance(places, Mapping) or not places:
        cure = 'give a dict of names and positions, such as {"left ear": [0, 0.1, 0.5]}'
        raise refused("places", places, cure)
    boxes = {}
    for name, place in places.items():
        if not isinstance(name, str):
            raise refused("places", name, "give names as text")
        corners = place.points if isinstance(place, Ear) else place
        cure = "give a place (3,), or two corners (2, 3) of a box, in m"
        corners = numbers(f'places["{name}"]', corners, [(3,), (-1, 3)], cure).reshape(-1, 3)
        boxes[name] = corners.min(axis=0), corners.max(axis=0)
    return boxes


def _keep_off(scene: Scene, name: str, low: Points, high: Points) -> None:
    """Reject a box that touches a transducer, where |p| is largest, and a position near to a transducer."""
    positions = scene.array.positions
    away = np.linalg.norm(positions - positions.clip(low, high), axis=1)
    nearest = int(away.argmin())
    box = (high > low).any()
    least = scene.wavelength if box else scene.wavelength / 100
    if away[nearest] < least:
        kind, apart = ("a box ", "a wavelength") if box else ("", "a hundredth of a wavelength")
        reported = f"is {kind}{1e3 * away[nearest]:.2g} mm from transducer {nearest}"
        cure = f"give one at least {apart} away, {1e3 * least:.2g} mm"
        raise stated(f'places["{name}"]', reported, cure)


def _of_one(scene: Scene, drive: ArrayLike | Solution) -> Blocks:
    """Return a function that yields |p| (P, 1) of one drive."""

    def blocks(points: Points) -> Iterator[NDArray[np.float64]]:
        with without_warnings():
            # `exposure` has warned of far places by their names.
            pressure = field(scene, drive, points).pressure
        yield np.abs(pressure)[:, None].astype(np.float64)

    return blocks


def _of_frames(scene: Scene, sequence: Sequence) -> Blocks:
    """Return a function that yields |p| (P, T) of the frames of a sequence."""
    if sequence.array != scene.array:
        raise stated("drive", "is a sequence of another array", "give sequence.scene(0) as the scene")
    bare = scene.replace(pressures=None, weights=None, signature=None)
    drives = sequence.drives
    size = max(WORK // drives.size, 1)

    def blocks(points: Points) -> Iterator[NDArray[np.float64]]:
        for first in range(0, len(points), size):
            matrix = rows(bare, points[first : first + size], "places", first)
            yield np.abs(matrix @ drives.T).astype(np.float64)

    return blocks
