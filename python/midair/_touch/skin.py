"""`midair.skin`: the motion of the skin under a sequence, and its felt strength."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._midair import HIGHEST, REACH, Membrane, Mesh, Plane, decibels, excess, hand as hand_through, steady, strength
from .._pictures.colours import MAPS, Axes, Figure, Map, Size
from .._pictures.panel import squares
from .._sequence import Sequence
from .._sequence.felt import places_of, threshold
from .._support.arguments import needs, number, refused, vector, warn
from .._support.text import Facts

#: Mode of SuperLU for symmetric matrices, with pivots on the diagonal.
SYMMETRIC = {"SymmetricMode": True}

#: Largest plausible `reach` in m.
WIDEST = 0.02

#: Default wave speed in m/s, loss factor, and mass in kg/m^2.
SPEED: float
LOSS: float
MASS: float
SPEED, LOSS, MASS = _midair.SKIN


def model_of(
    speed: Any = SPEED, loss: Any = LOSS, mass: Any = MASS, reach: Any = REACH, tau: Any = 0.0
) -> tuple[Membrane, float, float]:
    """Check the arguments of the model; return the membrane, `reach` in m and `tau` in s."""
    membrane = Membrane(number("speed", speed, above=0), number("loss", loss, least=0.1), number("mass", mass, above=0))
    width = number("reach", reach, above=0)
    if width > WIDEST:
        warn(f"reach is {width:g} m, wider than a finger: give {width * 1e-3:g} if mm are meant")
    return membrane, width, number("tau", tau, least=0)


def on_mesh(
    membrane: Membrane, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], mesh: Triangles
) -> NDArray[np.complex64]:
    """Return displacements (L, V) in m for pressure lines (L, V) in Pa at the corners of triangles."""
    order = mesh.order
    loads = (lines[:, order] * mesh.shares[order]).astype(np.complex64)
    solved = mesh.systems.solve(membrane.decay(frequencies) ** 2, loads.ravel())
    found = np.empty_like(lines)
    found[:, order] = solved.reshape(lines.shape) / np.complex64(membrane.tension)
    return found


class Triangles:
    """A surface of triangles with linear finite elements, as SciPy's sparse matrices.

    Parameters
    ----------
    stiffness
        (V, V): integrals of the products of the elements' gradients.
    shares
        (V,) in m^2: a third of the area of the triangles around each corner.
    order
        (V,): order of the corners in which the factors of such matrices are sparse.
    systems
        Systems (stiffness + s^2 shares) x = load of the corners in this order, for any s.
    """

    def __init__(self, vertices: NDArray[np.float64], faces: NDArray[Any]) -> None:
        with needs("skin of a Mesh needs SciPy", "mesh"):
            from scipy.sparse import csr_array, diags_array
            from scipy.sparse.linalg import splu
        corners = vertices[faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        twice = np.linalg.norm(cross, axis=1)
        self._faces, self._areas, count = faces, twice / 2, len(vertices)
        normals = cross / twice[:, None]
        # Gradient of a corner's hat function: the opposite edge, rotated by 90 degrees, divided by twice the
        # area.
        edges = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        hats = np.cross(normals[:, None], edges) / twice[:, None, None]
        rows = np.repeat(np.arange(len(faces)), 3)
        self._gradients = [
            csr_array((hats[..., axis].ravel(), (rows, faces.ravel())), shape=(len(faces), count)) for axis in range(3)
        ]
        weights = diags_array(self._areas)
        self.stiffness = sum(g.T @ weights @ g for g in self._gradients)
        self.shares = np.bincount(faces.ravel(), np.repeat(self._areas / 3, 3), count)
        # This matrix is positive definite and has the pattern of the matrices of all frequencies, so its
        # order of corners suits all of them.
        whole = (self.stiffness + diags_array(self.shares)).tocsc()
        first = splu(whole, "MMD_AT_PLUS_A", 0, options=SYMMETRIC)
        self.order = order = np.argsort(first.perm_c)
        ordered = self.stiffness[order][:, order].tocsc()
        ordered.sort_indices()
        self.systems = _midair.Shifted(ordered.indptr, ordered.indices, ordered.data, self.shares[order])
        outward = np.zeros((count, 3))
        np.add.at(outward, faces, cross[:, None])
        self.normals = outward / np.linalg.norm(outward, axis=1, keepdims=True)

    def slopes(self, lines: NDArray[np.complex64]) -> Iterator[NDArray[np.float64]]:
        """Yield |gradient|^2 (V,) of each line (L, V), averaged over the triangles around each corner."""
        for line in lines:
            squares = sum(np.abs(g @ line) ** 2 for g in self._gradients) * self._areas / 3
            yield np.bincount(self._faces.ravel(), np.repeat(squares, 3), len(line)) / self.shares


@lru_cache(maxsize=2)
def triangles(hand: Mesh) -> Triangles:
    """Return the triangles of a hand's mesh."""
    return Triangles(hand.vertices, hand.faces)


#: Default hand: places per side of the plane, and its margin around the points in m.
SIDE, MARGIN = 64, 0.02

#: The panels of a skin's picture.
Panel = Literal["pressure", "motion", "spectrum"]


def skin(
    sequence: Sequence,
    hand: Plane | Mesh | None = None,
    *,
    speed: float = SPEED,
    loss: float = LOSS,
    mass: float = MASS,
    reach: float = REACH,
    tau: float = 0.0,
) -> Skin:
    """Compute the skin's motion under a sequence that repeats for ever, and its felt strength: a model.

    Parameters
    ----------
    sequence : midair.Sequence
        The frames.
    hand : midair.Plane or midair.Mesh, optional
        A closed mesh needs the extra midair[mesh]. By default a plane of 64 x 64 places through the points.
    speed : float, optional
        Speed of waves on the skin in m/s: 5 to 8 (Frier et al., EuroHaptics 2018).
    loss : float, optional
        Loss factor; 0.4 lets waves of 200 Hz fall to 1/e in 26 mm, of 400 Hz in half of that.
    mass : float, optional
        Moving mass in kg/m^2; fitted to the threshold of 0.4 mN at 200 Hz on the finger (Dalecki et al., J.
        Acoust. Soc. Am. 97, 3165, 1995).
    reach : float, optional
        Distance in m over which the slow channel compares displacements. The default is the radius of the
        receptive field of a fast-adapting unit, 13 mm^2 (Johansson and Vallbo 1983).
    tau : float, optional
        Time constant of the transducers in s, 0 for none.

    Returns
    -------
    midair.Skin
        Motion and strength at each place.

    Raises
    ------
    SceneError
        For wrong arguments, places on a transducer, and where SciPy is missing.

    Notes
    -----
    The skin is an infinite membrane, or the surface of a mesh. Its load is the radiation pressure
    |p|^2/(rho c^2); on a mesh times the squared cosine of the incidence, and 0 on its far side. Each line of
    the sequence's spectrum up to 500 Hz is solved alone, which is exact, because the membrane is linear. The
    static load is left out, and so is pressure outside of the hand. A frame lasts until the next one, so the
    spectrum contains its steps. `docs/touch.md` compares the model with published results.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> ring = midair.path.circle([0, 0, 0.15], 0.02, speed=7)
    >>> touch = midair.skin(midair.sequence(array, ring, rate=4e3, change=1.0))
    >>> touch.displacement.shape, touch.level > 0
    ((9, 4096), True)
    """
    if not isinstance(sequence, Sequence):
        raise refused("sequence", sequence, "give a midair.Sequence")
    membrane, width, tau = model_of(speed, loss, mass, reach, tau)
    if hand is None:
        hand = hand_through(sequence.points[sequence.targets > 0], sequence.array, MARGIN, SIDE)
    if isinstance(hand, Plane):
        places, step = squares(hand), hand.size / max(hand.pixels - 1, 1)
        frequencies, pressure, lines = sequence._push_lines(places, tau)
        shaped = lines.reshape(-1, hand.pixels, hand.pixels)
        displacement, slow, fast = membrane.on_plane(frequencies, shaped, step, width)
        pressed = steady(frequencies, lines)
    elif isinstance(hand, Mesh):
        mesh = triangles(hand)
        places = hand.vertices
        ways = places - sequence.array.positions.mean(axis=0)
        cosines = -np.einsum("pk,pk->p", mesh.normals, ways) / np.linalg.norm(ways, axis=1)
        (near,) = np.nonzero(cosines > 0)
        shares = np.square(cosines[near]).astype(np.float32)
        frequencies, mean, pushed = sequence._push_lines(places[near], tau)
        pressure = np.zeros(len(places), np.float32)
        pressure[near] = mean * shares
        live = _midair.live_lines(pushed * shares)
        lines = np.zeros((int(live.sum()), len(places)), np.complex64)
        lines[:, near] = pushed[live] * shares
        displacement = np.zeros((len(frequencies), len(places)), np.complex64)
        displacement[live] = moved = on_mesh(membrane, frequencies[live], lines, mesh)
        fast = excess(True, frequencies[live], np.square(np.abs(moved)))
        slopes = np.array(list(mesh.slopes(moved)), np.float32).reshape(moved.shape)
        slow = width * excess(False, frequencies[live], slopes)
        pressed = steady(frequencies[live], lines)
    else:
        raise refused("hand", hand, "give a midair.Plane or a midair.Mesh")
    return Skin(places, hand, pressure.astype(np.float64), frequencies, displacement, slow, fast, pressed)


@dataclass(frozen=True, eq=False, repr=False)
class Skin(Facts):
    """Motion of the skin, its felt strength, and the steady push that is felt; from `midair.skin`.

    Attributes
    ----------
    places : (P, 3) ndarray
        Places on the hand in m.
    hand : midair.Plane or midair.Mesh
        The plane, row after row of its pixels, or the mesh.
    pressure : (P,) ndarray
        Radiation pressure in Pa, the mean over time.
    frequencies : (L,) ndarray
        The lines in Hz, above 0 up to 500 Hz.
    displacement : (L, P) ndarray of complex64
        In m: the real part times e^(2 pi j f t) is the motion.
    slow, fast : (P,) ndarray
        How far each channel exceeds its threshold, sqrt(sum of |amplitude / threshold|^2) over the lines; 1
        is just felt. The slow one (non-Pacinian) feels differences of displacement over `reach`, the fast
        one (Pacinian) displacement.
    pressed : (P,) ndarray
        Radiation pressure in Pa that the channel of pressure (SA-I) passes, sqrt(sum of
        |p|^2/(1 + (f/15 Hz)^2)) over the lines. 5 to 15 Hz is felt as a steady push (Morisaki et al. 2022).

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> touch = midair.skin(midair.solve(scene).modulated(200))
    >>> touch.strength.shape, 0.001 < touch.width() < 0.1
    ((4096,), True)
    """

    places: NDArray[np.float64]
    hand: Plane | Mesh
    pressure: NDArray[np.float64]
    frequencies: NDArray[np.float64]
    displacement: NDArray[np.complex64]
    slow: NDArray[np.float64]
    fast: NDArray[np.float64]
    pressed: NDArray[np.float64]

    @property
    def indentation(self) -> NDArray[np.float64]:
        """Quasi-static indentation (P,) in m, peak: `displacement`, passed as in `pressed`."""
        return steady(self.frequencies, self.displacement)

    @property
    def felt_force(self) -> float:
        """Force in N of a contact that is felt alike, to a factor of 2: 9 times the integral of `pressed`.

        The factor is fitted to 0.21 N felt for 0.027 N (Morisaki et al., IEEE Trans. Haptics 15(2), 2022); no
        model explains it. 0.24 N for 0.02 N (the same, 2024, 10.1109/TOH.2023.3338230) sets the uncertainty.
        """
        return float(_midair.GAIN * np.sum(self.pressed * self._areas))

    @property
    def _areas(self) -> NDArray[np.float64] | float:
        """Area in m^2 of each place (P,), or of all."""
        if isinstance(self.hand, Plane):
            return (self.hand.size / max(self.hand.pixels - 1, 1)) ** 2
        return np.asarray(triangles(self.hand).shares, np.float64)

    @property
    def strength(self) -> NDArray[np.float64]:
        """Felt strength at each place (P,): 1 is the threshold.

        It is the stronger channel plus half of the weaker one (Hollins and Roy, Somatosens. Motor Res. 13,
        1996).
        """
        return strength(self.slow, self.fast)

    @property
    def level(self) -> float:
        """Strength at the strongest place, in dB above what is just felt."""
        return decibels(self.strength.max())

    @property
    def rms(self) -> NDArray[np.float64]:
        """Displacement (P,) in m, rms over time."""
        squares = np.sum(np.abs(self.displacement.astype(np.complex128)) ** 2, axis=0)
        found: NDArray[np.float64] = np.sqrt(squares / 2)
        return found

    def spectrum(self, place: ArrayLike) -> NDArray[np.float64]:
        """Return the peak displacement of each spectral line at the place nearest to `place`.

        Parameters
        ----------
        place : (3,) array_like
            Place in m.

        Returns
        -------
        (L,) ndarray
            Displacements in m.

        Raises
        ------
        SceneError
            For a wrong place, and for one that is not on the skin.
        """
        return np.abs(self.displacement[:, self._nearest(place)]).astype(np.float64)

    def along(self, places: ArrayLike) -> NDArray[np.float64]:
        """Return the strength at the places nearest to `places`.

        Parameters
        ----------
        places : (K, 3) array_like
            Places in m.

        Returns
        -------
        (K,) ndarray
            Strength; 1 is just felt.

        Raises
        ------
        SceneError
            For wrong places, and for those that are not on the skin.
        """
        return self.strength[[self._nearest(place) for place in places_of(places)]]

    def width(self, place: ArrayLike | None = None) -> float:
        """Return the felt width: twice the distance to the nearest place with less than half the strength.

        Parameters
        ----------
        place : (3,) array_like, optional
            Place in m; by default the strongest one.

        Returns
        -------
        float
            Width in m; inf if no place has less than half the strength.

        Raises
        ------
        SceneError
            For a wrong place.
        """
        return self._width(self.strength, place)

    def focus_width(self, place: ArrayLike | None = None) -> float:
        """Return the width of the radiation pressure, as `width` of the strength.

        Parameters
        ----------
        place : (3,) array_like, optional
            Place in m; by default that of the largest pressure.

        Returns
        -------
        float
            Width in m.

        Raises
        ------
        SceneError
            For a wrong place.
        """
        return self._width(self.pressure, place)

    def motion(self, times: ArrayLike) -> NDArray[np.float32]:
        """Return the displacement at some times, without the steady part.

        Parameters
        ----------
        times : (K,) array_like
            Times in s.

        Returns
        -------
        (K, P) ndarray of float32
            Displacements in m.

        Raises
        ------
        SceneError
            For wrong times.
        """
        instants = _midair.numbers("times", times, [(-1,), (0,)], "give a list of finite times in s")
        turned = np.exp(2j * np.pi * np.outer(instants, self.frequencies))
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
        """Draw pressure, skin motion (rms) and the spectrum at a place; a mesh as the array sees it.

        Parameters
        ----------
        place : (3,) array_like, optional
            Place of the spectrum in m; by default the strongest one.
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        cmap : str or Colormap, optional
            A colour map of matplotlib.
        panels : {"pressure", "motion", "spectrum"} or list of them, optional
            The panels to draw, side by side; by default all.
        size : float or (float, float), optional
            Size of the figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        SceneError
            For wrong arguments.
        """
        from .._pictures.figures import colour_map, row

        figure, axes = row(panels, get_args(Panel), ax, size, width=3.9, height=3.4)
        colours = colour_map(cmap, MAPS["pressure"])
        best = int(self.strength.argmax()) if place is None else self._nearest(place)
        for name, one in axes.items():
            _draw(self, name, one, colours, best)
        return figure

    def _nearest(self, place: ArrayLike) -> int:
        at = vector("place", place)
        away = np.linalg.norm(self.places - at, axis=1)
        nearest = int(away.argmin())
        if away[nearest] > self._apart:
            apart, most = 1e3 * away[nearest], 1e3 * self._apart
            cure = f"it is {apart:.4g} mm from the skin, give one within {most:.2g} mm"
            raise refused("place", at.tolist(), cure)
        return nearest

    @cached_property
    def _apart(self) -> float:
        """Distance in m between neighbouring pixels of the plane, or the longest edge of the mesh."""
        if isinstance(self.hand, Plane):
            return self.hand.size / max(self.hand.pixels - 1, 1) * 1.001
        corners = self.places[np.asarray(self.hand.faces)]
        return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())

    def _width(self, values: NDArray[np.float64], place: ArrayLike | None) -> float:
        middle = int(values.argmax()) if place is None else self._nearest(place)
        return _midair.felt_width(values, self.places, middle)

    def _rows(self) -> list[tuple[str, str]]:
        best = int(self.strength.argmax())
        x, y, z = 1e3 * self.places[best]
        lines = np.abs(self.displacement[:, best])
        largest = np.sort(np.argsort(-lines)[:4])
        spectrum = ", ".join(f"{1e6 * lines[k]:.3g} um at {self.frequencies[k]:.4g} Hz" for k in largest)
        return [
            ("strongest", f"{self.level:.1f} dB above threshold at ({x:.1f}, {y:.1f}, {z:.1f}) mm"),
            ("slow channel", f"{decibels(self.slow[best]):.1f} dB there"),
            ("fast channel", f"{decibels(self.fast[best]):.1f} dB there"),
            ("pressure", f"felt as {1e3 * self.felt_force:.0f} mN, to a factor of 2"),
            ("width", f"{1e3 * self.width():.1f} mm felt, {1e3 * self.focus_width():.1f} mm of pressure"),
            ("displacement", spectrum or "none"),
        ]


def _draw(skin: Skin, panel: Panel, ax: Axes, colours: Map, best: int) -> None:
    """Draw a panel. The place `best` is marked."""
    if panel == "pressure":
        _map(skin, ax, skin.pressure, "radiation pressure, mean / Pa", colours)
        return
    if panel == "motion":
        _map(skin, ax, 1e6 * skin.rms, "skin motion, rms / µm", colours)
        first, second = _widest(skin)
        ax.plot(1e3 * skin.places[best, first], 1e3 * skin.places[best, second], "+", color="tab:cyan")
        return
    lines = 1e6 * np.abs(skin.displacement[:, best])
    audible = np.geomspace(3, HIGHEST, 200)
    ax.vlines(skin.frequencies, 1e-4, np.maximum(lines, 1e-4), color="tab:blue", label="skin at +")
    ax.plot(audible, 1e6 * threshold(audible), color="black", linewidth=0.9, label="just felt")
    ax.set(xscale="log", yscale="log", xlim=(3, HIGHEST), ylim=(1e-2, 100))
    ax.set(xlabel="frequency / Hz", ylabel="displacement / µm")
    ax.set_title(f"strongest: {skin.level:.0f} dB above threshold", fontsize="medium")
    ax.legend(loc="lower left", fontsize="small")


def _widest(skin: Skin) -> list[int]:
    """Return the two axes along which the places, or the mesh, extend most."""
    sides = np.ptp(skin.places, axis=0)
    return [axis for axis in range(3) if axis != int(sides.argmin())]


def _map(skin: Skin, ax: Axes, values: NDArray[np.float64], label: str, colours: Map) -> None:
    from matplotlib.tri import Triangulation

    first, second = _widest(skin)
    x, y = 1e3 * skin.places[:, first], 1e3 * skin.places[:, second]
    faces = skin.hand.faces if isinstance(skin.hand, Mesh) else None
    drawn = ax.tripcolor(Triangulation(x, y, faces), values, cmap=colours, shading="gouraud")
    ax.margins(0)
    ax.set(aspect="equal", xlabel=f"{'xyz'[first]} / mm", ylabel=f"{'xyz'[second]} / mm")
    ax.figure.colorbar(drawn, ax=ax, label=label)
