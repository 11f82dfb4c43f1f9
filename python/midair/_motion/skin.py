"""`midair.skin`: how the skin moves under a sequence, and how strongly that is felt."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Mesh, Plane
from .._pictures.colours import MAPS
from .._support.arguments import number, refused, vector
from ..path._piece import instants
from . import arguments
from .felt import FAST, SLOW, threshold
from .sequence import Sequence
from .sheet import Sheet, Triangles

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .._pictures.colours import Map
    from .._pictures.sheet import Size

#: Places along each side of a hand that is left out, and its margin around the points, in m.
SIDE, MARGIN = 64, 0.02

#: The parts of a skin's picture.
Panel = Literal["pressure", "motion", "spectrum"]

#: The highest frequency that is felt, in Hz.
HIGHEST = 1000.0


def skin(
    sequence: Sequence,
    hand: Plane | Mesh | None = None,
    *,
    speed: float = Sheet.speed,
    loss: float = Sheet.loss,
    mass: float = Sheet.mass,
    reach: float = 2e-3,
    tau: float = 0.0,
) -> Skin:
    """The skin's motion under a sequence that repeats for ever, and what is felt of it: a model.

    hand : a midair.Plane; a midair.Mesh, closed, of the extra midair[mesh]; left out, a plane of 64 x 64
        places through the points, square to the way from the array to them
    speed : of waves on the skin in m/s: 5 to 8 (Frier et al., EuroHaptics 2018)
    loss : loss factor; 0.4 lets waves of 200 Hz fall to 1/e in 26 mm, and of 400 Hz in half of that
    mass : that moves, in kg/m^2; fitted to the threshold of 0.4 mN at 200 Hz on the finger (Dalecki et al.,
        J. Acoust. Soc. Am. 97, 3165, 1995)
    reach : over which the slow channel compares displacements, in m: the radius of the receptive field of a
        fast-adapting unit, 13 mm^2 (Johansson and Vallbo 1983)
    tau : time constant of the transducers in s, 0 for none

    The skin is an endless membrane (of a mesh, its surface) pushed by the radiation pressure
    |p|^2/(rho c^2), on a mesh times the squared cosine of the incidence, and by none on its far side. Each
    line of the sequence's spectrum up to 1 kHz is solved by itself, which is exact: the sheet is linear. The
    steady push is left out, and so is what pushes beside the hand. A frame lasts until the next one, and
    its steps are in the spectrum. `docs/touch.md` lists which published orders the model has, and which not.

    Raises SceneError for arguments that are not in order, places on a transducer, and where SciPy is missing.

    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> ring = midair.path.circle([0, 0, 0.15], 0.02, speed=7)
    >>> touch = midair.skin(midair.sequence(array, ring, rate=4e3, change=1.0))
    >>> touch.displacement.shape, touch.level > 0
    ((18, 4096), True)
    """
    if not isinstance(sequence, Sequence):
        raise refused("sequence", sequence, "give a midair.Sequence")
    sheet = Sheet(
        number("speed", speed, above=0), number("loss", loss, least=0.1), number("mass", mass, above=0)
    )
    width, tau = number("reach", reach, above=0), arguments.time_constant(tau)
    if hand is None:
        hand = _around(sequence)
    if isinstance(hand, Plane):
        places, step = squares(hand), hand.size / max(hand.pixels - 1, 1)
        shape = (hand.pixels, hand.pixels)
        frequencies, lines = _lines(sequence, places, tau)
        moved = sheet.on_plane(frequencies, lines[1:].reshape(-1, *shape), step)
        slopes = [sum(np.abs(g) ** 2 for g in np.gradient(line, step)).ravel() for line in moved]
    elif isinstance(hand, Mesh):
        mesh = _triangles(hand)
        places = hand.vertices
        ways = places - sequence.array.positions.mean(axis=0)
        cosines = -np.einsum("pk,pk->p", mesh.normals, ways) / np.linalg.norm(ways, axis=1)
        (near,) = np.nonzero(cosines > 0)
        frequencies, pushed = _lines(sequence, places[near], tau)
        lines = np.zeros((len(pushed), len(places)), np.complex64)
        lines[:, near] = pushed * np.square(cosines[near]).astype(np.float32)
        moved = sheet.on_mesh(frequencies, lines[1:], mesh)
        slopes = list(mesh.slopes(moved))
    else:
        raise refused("hand", hand, "give a midair.Plane or a midair.Mesh")
    displacement = moved.reshape(len(frequencies), len(places))
    slow = width * np.sqrt(_weighted(np.array(slopes).reshape(displacement.shape), frequencies, SLOW))
    fast = np.sqrt(_weighted(np.abs(displacement) ** 2, frequencies, FAST))
    return Skin(places, hand, lines[0].real.astype(np.float64), frequencies, displacement, slow, fast)


@dataclass(frozen=True, eq=False)
class Skin:
    """How the skin moves, line by line, and how strongly that is felt.

    places : (P, 3) in m
    hand : the midair.Plane, row after row of its pixels, or the midair.Mesh
    pressure : (P,) in Pa, the radiation pressure in the mean over time
    frequencies : (L,) in Hz, the lines above 0 up to 1 kHz
    displacement : (L, P) in m, complex: the real part times e^(2 pi j f t) is the motion
    slow, fast : (P,) by how much each channel exceeds its threshold, sqrt(sum of |amplitude / threshold|^2)
        over the lines: the slow one (non-Pacinian) by differences of displacement over `reach`, the fast one
        (Pacinian) by displacement; 1 is just felt
    """

    places: NDArray[np.float64]
    hand: Plane | Mesh
    pressure: NDArray[np.float64]
    frequencies: NDArray[np.float64]
    displacement: NDArray[np.complex64]
    slow: NDArray[np.float64]
    fast: NDArray[np.float64]

    @property
    def strength(self) -> NDArray[np.float64]:
        """How strongly it is felt at each place (P,): 1 is just felt.

        The stronger channel and half of the weaker one (Hollins and Roy, Somatosensory and Motor Research 13,
        1996).
        """
        found: NDArray[np.float64] = np.maximum(self.slow, self.fast) + np.minimum(self.slow, self.fast) / 2
        return found

    @property
    def level(self) -> float:
        """Strength at the strongest place, in dB above what is just felt."""
        return float(_decibels(self.strength.max()))

    @property
    def rms(self) -> NDArray[np.float64]:
        """Displacement (P,) in m, rms over time."""
        squares = np.sum(np.abs(self.displacement.astype(np.complex128)) ** 2, axis=0)
        found: NDArray[np.float64] = np.sqrt(squares / 2)
        return found

    def spectrum(self, place: ArrayLike) -> NDArray[np.float64]:
        """The peak displacement (L,) in m of each line, at the place (3,) nearest to that given.

        Raises SceneError for a place that is not in order.
        """
        return np.abs(self.displacement[:, self._nearest(place)]).astype(np.float64)

    def along(self, places: ArrayLike) -> NDArray[np.float64]:
        """Strength (K,) at the places nearest to those given (K, 3).

        Raises SceneError for places that are not in order.
        """
        return self.strength[[self._nearest(place) for place in arguments.places(places)]]

    def width(self, place: ArrayLike | None = None) -> float:
        """Felt width in m: twice the way from a place to the nearest one where strength is below its half.

        Left out, the strongest place. inf where strength is nowhere below. Raises SceneError for a place
        that is not in order.
        """
        return self._width(self.strength, place)

    def focus_width(self, place: ArrayLike | None = None) -> float:
        """The same of the radiation pressure, from the place of its maximum where left out.

        Raises SceneError for a place that is not in order.
        """
        return self._width(self.pressure, place)

    def motion(self, times: ArrayLike) -> NDArray[np.float32]:
        """Displacement (K, P) in m at times (K,) in s; without the steady part.

        Raises SceneError for times that are not in order.
        """
        turned = np.exp(2j * np.pi * np.outer(instants(times), self.frequencies))
        moved: NDArray[np.float32] = (turned.astype(np.complex64) @ self.displacement).real
        return moved

    def plot(
        self,
        place: ArrayLike | None = None,
        ax: Axes | None = None,
        *,
        cmap: Map | None = None,
        panels: Panel | Iterable[Panel] | None = None,
        size: Size | None = None,
    ) -> Figure:
        """Pressure, skin motion (rms) and the spectrum at a place, left out the strongest, side by side.

        ax : axes of your own for one panel, the first of `panels`
        cmap : a colour map of matplotlib or its name
        panels : "pressure", "motion", "spectrum" or several; left out, all
        size : (width, height) in inches

        Of a mesh, its places as the array sees them. Raises SceneError for arguments that are not in order.
        """
        from .._pictures.sheet import chosen, colour_map, sheet, whole

        names = chosen(panels, get_args(Panel), ax)
        colours = colour_map(cmap, MAPS["pressure"])
        best = int(self.strength.argmax()) if place is None else self._nearest(place)
        if ax is not None:
            self._draw(names[0], ax, colours, best)
            return whole(ax)
        figure = sheet(3.6 * len(names), 3.4, size)
        for name, one in zip(names, figure.subplots(1, len(names), squeeze=False)[0], strict=True):
            self._draw(name, one, colours, best)
        return figure

    def _draw(self, panel: Panel, ax: Axes, colours: Map, best: int) -> None:
        if panel == "pressure":
            self._map(ax, self.pressure, "radiation pressure, mean / Pa", colours)
            return
        if panel == "motion":
            self._map(ax, 1e6 * self.rms, "skin motion, rms / um", colours)
            first, second = self._across()
            ax.plot(1e3 * self.places[best, first], 1e3 * self.places[best, second], "+", color="tab:cyan")
            return
        lines = 1e6 * np.abs(self.displacement[:, best])
        audible = np.geomspace(3, HIGHEST, 200)
        ax.vlines(self.frequencies, 1e-4, np.maximum(lines, 1e-4), color="tab:blue", label="skin at +")
        ax.plot(audible, 1e6 * threshold(audible), color="black", linewidth=0.9, label="just felt")
        ax.set(xscale="log", yscale="log", xlim=(3, HIGHEST), ylim=(1e-2, 100))
        ax.set(xlabel="frequency / Hz", ylabel="displacement / um", title=f"{self.level:.0f} dB at most")
        ax.legend(loc="lower left", fontsize="small")

    def _across(self) -> list[int]:
        """The two axes along which the places lie, or a mesh is widest."""
        sides = np.ptp(self.places, axis=0)
        return [axis for axis in range(3) if axis != int(sides.argmin())]

    def _map(self, ax: Axes, values: NDArray[np.float64], label: str, colours: Map) -> None:
        from matplotlib.tri import Triangulation

        first, second = self._across()
        x, y = 1e3 * self.places[:, first], 1e3 * self.places[:, second]
        faces = self.hand.faces if isinstance(self.hand, Mesh) else None
        drawn = ax.tripcolor(Triangulation(x, y, faces), values, cmap=colours, shading="gouraud")
        ax.margins(0)
        ax.set(aspect="equal", xlabel=f"{'xyz'[first]} / mm", ylabel=f"{'xyz'[second]} / mm")
        ax.figure.colorbar(drawn, ax=ax, label=label)

    def _nearest(self, place: ArrayLike) -> int:
        return int(np.square(self.places - vector("place", place)).sum(axis=1).argmin())

    def _width(self, values: NDArray[np.float64], place: ArrayLike | None) -> float:
        middle = int(values.argmax()) if place is None else self._nearest(place)
        below = values < values[middle] / 2
        apart = np.linalg.norm(self.places[below] - self.places[middle], axis=1)
        return 2 * float(apart.min(initial=np.inf))

    def __repr__(self) -> str:
        return "\n".join(f"{name:18}  {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        rows = (f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in self._rows())
        return f"<table>{''.join(rows)}</table>"

    def _rows(self) -> list[tuple[str, str]]:
        best = int(self.strength.argmax())
        x, y, z = 1e3 * self.places[best]
        lines = np.abs(self.displacement[:, best])
        largest = np.sort(np.argsort(-lines)[:4])
        spectrum = ", ".join(f"{1e6 * lines[k]:.3g} um at {self.frequencies[k]:.4g} Hz" for k in largest)
        return [
            ("strongest", f"{self.level:.1f} dB above threshold at ({x:.1f}, {y:.1f}, {z:.1f}) mm"),
            ("slow channel", f"{_decibels(self.slow[best]):.1f} dB there"),
            ("fast channel", f"{_decibels(self.fast[best]):.1f} dB there"),
            ("width", f"{1e3 * self.width():.1f} mm felt, {1e3 * self.focus_width():.1f} mm of pressure"),
            ("displacement", spectrum or "none"),
        ]


@lru_cache(maxsize=2)
def _triangles(hand: Mesh) -> Triangles:
    return Triangles(hand.vertices, hand.faces)


def _decibels(strength: float) -> float:
    return float(20 * np.log10(max(strength, 1e-10)))


def _around(sequence: Sequence) -> Plane:
    """A plane through all points that are there, square to the way to them."""
    points = sequence.points[sequence.targets > 0]
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    way = np.abs(middle - sequence.array.positions.mean(axis=0))
    normal = int(way.argmax())
    across = [axis for axis in range(3) if axis != normal]
    size = float(np.ptp(points, axis=0)[across].max()) + 2 * MARGIN
    center = (float(middle[across[0]]), float(middle[across[1]]))
    return Plane(axis="xyz"[normal], at=float(middle[normal]), size=size, pixels=SIDE, center=center)


def squares(plane: Plane) -> NDArray[np.float64]:
    """Places (pixels^2, 3) of a plane, row after row upwards."""
    axes = [plane.along(name) for name in "xyz"]
    across, up = (axis for axis in axes if axis is not None)
    first, second = (values.ravel() for values in np.meshgrid(across, up))
    columns = iter((first, second))
    return np.stack(
        [np.full(len(first), plane.at) if axis is None else next(columns) for axis in axes], axis=1
    )


def _lines(
    sequence: Sequence, places: NDArray[np.float64], tau: float
) -> tuple[NDArray[np.float64], NDArray[np.complex64]]:
    """The lines up to 1 kHz above 0 (L,) in Hz, and (1 + L, P) in Pa: the mean, and the amplitude of each.

    With constant frames, a line h of T frames is the h-th harmonic of their samples times sinc(h / T).
    """
    count = len(sequence)
    harmonics = np.arange(1, int(HIGHEST * count / sequence.rate * (1 + 1e-9)) + 1)
    kept = (np.sinc(harmonics / count) * 2 / count).astype(np.float32)[:, None]
    lines = np.zeros((1 + len(harmonics), len(places)), np.complex64)
    for frames, values in sequence._pushes(places, tau):
        index = np.arange(frames.start, frames.start + len(values))
        lines[0] += values.sum(axis=0) / count
        turns = np.outer(harmonics, index) % count
        waves = kept * np.exp(-2j * np.pi / count * turns).astype(np.complex64)
        lines[1:] += waves @ values
    return (harmonics * (sequence.rate / count)).astype(np.float64), lines.astype(np.complex64)


def _weighted(
    squares: NDArray[np.floating], frequencies: NDArray[np.float64], channel: tuple[tuple[float, float], ...]
) -> NDArray[np.float64]:
    """Sum over the lines (L, P) of squares over those of the channel's threshold."""
    weights = threshold(frequencies, [channel]) ** -2.0
    found: NDArray[np.float64] = weights @ squares.astype(np.float64)
    return found
