"""`midair.fly` simulates beads in the traps of a sequence, with their tracks; `midair.weigh` finds a bead."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal, cast, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Bead, Course, Scene, Solution, numbers, rest, stated
from .._pictures.colours import Axes, Figure, Size
from .._sequence.drives import Hold
from .._sequence.frames import SETTLING, TAU
from .._sequence.picture import DPI, PICTURES, write
from .._sequence.sequence import Sequence
from .._support import text
from .._support.arguments import callback, number, refused, sized, warn, whole

#: The panels of a flight's picture.
Way = Literal["path", "distance"]


@dataclass(frozen=True, eq=False)
class Flight:
    """Tracks of beads in flight; from `midair.fly`.

    Attributes
    ----------
    times : (T,) ndarray
        Times in s.
    places, points : (T, B, 3) ndarray
        Places in m of the beads (NaN after they are lost), and of their points.
    lost : (B,) ndarray
        Time in s when each bead is lost; NaN if it stays trapped.
    beads : (B,) ndarray of int
        Number of each bead's point in the sequence.

    Examples
    --------
    >>> import midair
    >>> boards = midair.Array.preset("openmpd_pair", quantization={})
    >>> still = midair.path.still([0, 0, 0], duration=0.02)
    >>> flight = midair.fly(midair.sequence(boards, still, rate=1000, signature="trap"))
    >>> flight.places.shape[1:], bool(flight.farthest[0] < 2e-3)
    ((1, 3), True)
    """

    times: NDArray[np.float64]
    places: NDArray[np.float64]
    points: NDArray[np.float64]
    lost: NDArray[np.float64]
    beads: NDArray[np.intp]

    @property
    def held(self) -> NDArray[np.bool_]:
        """Whether each bead (B,) stays trapped to the end."""
        return np.isnan(self.lost)

    @property
    def distances(self) -> NDArray[np.float64]:
        """Distances (T, B) in m of the beads from their points; NaN after a bead is lost."""
        found: NDArray[np.float64] = np.linalg.norm(self.places - self.points, axis=2)
        return found

    @property
    def farthest(self) -> NDArray[np.float64]:
        """Largest distance (B,) in m of each bead from its point before it is lost."""
        found: NDArray[np.float64] = np.fmax.reduce(self.distances, axis=0, initial=0.0)
        return found

    def plot(
        self, ax: Axes | None = None, *, panels: Way | Iterable[Way] | None = None, size: Size | None = None
    ) -> Figure:
        """Draw tracks of beads and points along the axis of least extent, and distances over time.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        panels : {"path", "distance"} or list of them, optional
            The panels to draw; by default both. A cross marks where a bead was lost.
        size : float or (float, float), optional
            Size of the figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        SceneError
            If a panel or the size is invalid.
        """
        from .._pictures.figures import row

        figure, axes = row(panels, get_args(Way), ax, size, width=4.8, height=4.0)
        for name, one in axes.items():
            _draw(self, name, one)
        return figure

    def animate(
        self,
        path: str | PathLike[str],
        *,
        frames: int | None = None,
        fps: int = 20,
        progress: Callable[[int, int], object] | None = None,
    ) -> None:
        """Write an animation of the beads in flight as .webp, .gif or, by ffmpeg, .mp4.

        Parameters
        ----------
        path : str or path
            File to write, whole or not at all.
        frames, fps : int, optional
            Number of pictures, evenly chosen, by default at most 100; pictures per second.
        progress : callable, optional
            Called with (pictures drawn, pictures).

        Raises
        ------
        SceneError
            If the ending is unknown, the path cannot be written, or `frames` or `fps` is invalid.
        """
        callback(progress, "pictures drawn, pictures")
        most = PICTURES if frames is None else whole("frames", frames, least=1)
        count = min(len(self.times), most)
        fps = whole("fps", fps, least=1)
        write(path, fps, count, self._pictures(count), progress)

    def _pictures(self, count: int) -> Iterator[Any]:
        """Yield pictures (height, width, 3) of the tracks, with the beads at equal intervals of time."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure as Picture

        figure = Picture(figsize=(5.2, 4.6), dpi=DPI, layout="constrained")
        canvas = cast(Any, FigureCanvasAgg)(figure)
        ax = figure.subplots()
        _draw(self, "path", ax)
        first, second = _across(self)
        (dots,) = ax.plot([], [], "o", color="black", markersize=5)
        for k in np.arange(count) * len(self.times) // count:
            dots.set_data(1e3 * self.places[k, :, first], 1e3 * self.places[k, :, second])
            ax.set_title(f"{1e3 * self.times[k]:.1f} ms", fontsize="medium")
            canvas.draw()
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()

    def __repr__(self) -> str:
        lasts = 1e3 * (self.times[-1] - self.times[0])
        head = f"Flight of {lasts:.4g} ms: {int(self.held.sum())} of {len(self.lost)} held"
        return f"{head}\n{text.plain(self._cells())}"

    def _repr_html_(self) -> str:
        return text.html(self._cells())

    def _cells(self) -> dict[str, list[str]]:
        return {
            "bead": [str(one + 1) for one in range(len(self.lost))],
            "point": [str(point + 1) for point in self.beads],
            "largest distance": [f"{1e3 * far:.3f} mm" for far in self.farthest],
            "lost": ["-" if np.isnan(lost) else f"after {1e3 * lost:.1f} ms" for lost in self.lost],
        }


def _across(flight: Flight) -> list[int]:
    """Return the two axes along which the points of a flight move most."""
    sides = np.ptp(flight.points, axis=(0, 1))
    return sorted(np.argsort(-sides, kind="stable")[:2].tolist())


def _draw(flight: Flight, panel: Way, ax: Axes) -> None:
    if panel == "distance":
        for one, distances in enumerate(1e3 * flight.distances.T):
            ax.plot(1e3 * flight.times, distances, linewidth=0.9, label=f"bead {one + 1}")
        ax.set(xlabel="time / ms", ylabel="distance from its point / mm", ylim=(0, None))
        if len(flight.lost) > 1:
            ax.legend(loc="best", fontsize="small")
        return
    first, second = _across(flight)
    for one in range(len(flight.lost)):
        point, place = 1e3 * flight.points[:, one], 1e3 * flight.places[:, one]
        ax.plot(point[:, first], point[:, second], color="silver", linewidth=4, zorder=1)
        ax.plot(place[:, first], place[:, second], linewidth=0.9, zorder=2)
        there = np.flatnonzero(~np.isnan(place[:, 0]))
        if not flight.held[one] and len(there):
            ax.plot(*place[there[-1], [first, second]], "x", color="red", zorder=3)
    ax.set(aspect="equal", xlabel=f"{'xyz'[first]} / mm", ylabel=f"{'xyz'[second]} / mm")
    ax.set_title("grey: points, lines: beads", fontsize="small")


#: Distance in wavelengths from its point beyond which a bead is lost, as in the core.
LOST = 0.5

#: Delays of a bead behind the air in s, below which drag may change too much within a step of a flight.
SOONEST = 2.5e-3


@SETTLING
def fly(
    sequence: Sequence,
    beads: ArrayLike | None = None,
    *,
    speeds: ArrayLike | None = None,
    duration: float | None = None,
    tau: float = TAU,
    hold: Hold = "hold",
    bead: Bead | Mapping[str, Any] | None = None,
) -> Flight:
    """Simulate how beads move in the traps of a sequence: which stay, how far they stray, which are lost.

    Parameters
    ----------
    sequence : midair.Sequence
        A sequence of traps (signature="trap").
    beads : (B, 3) array_like, optional
        Places in m at the start; by default the places of rest at the points of the first frame.
    speeds : (B, 3) array_like, optional
        Velocities in m/s at the start; by default those of the points if the sequence is closed, else 0.
    duration : float, optional
        Duration in s; by default that of an open sequence, and as many laps of a closed one as take 1 s (at
        most 100).
    tau, hold
        Time constant of the transducers in s, and how the board plays a frame, as for `Sequence.between`.
    bead : midair.Bead or mapping, optional
        Properties of every bead; by default those of the sequence's bead.

    Returns
    -------
    midair.Flight
        Places of the beads over time.

    Raises
    ------
    SceneError
        For wrong arguments, and for a bead in an obstacle.

    See Also
    --------
    midair.rest : the traps at rest.

    midair.path.fastest : the fastest run of a bead.

    Notes
    -----
    Each bead obeys m x'' = F + weight - buoyancy - drag. F is the force of sound in the field at that time.
    The drag is Stokes' with Basset's history force of the boundary layer, and Schiller and Naumann's addition
    for the wake. m includes half the mass of the air in the bead's place.
    Beads do not act on one another. The force is a polynomial around each point, exact to 1e-3 of the
    largest (docs/traps.md). A bead is lost when it is more than half a wavelength from its point.

    Examples
    --------
    >>> import midair
    >>> boards = midair.Array.preset("openmpd_pair", quantization={})
    >>> ring = midair.path.circle([0, 0, 0], 0.01, speed=0.1)
    >>> flight = midair.fly(midair.sequence(boards, ring, rate=1000, signature="trap"))
    >>> flight.held
    array([ True])
    """
    if not isinstance(sequence, Sequence):
        raise refused("sequence", sequence, "give a midair.Sequence")
    scene = sequence.scene(0).replace(bead=bead)
    if (delay := _delay(scene)) < SOONEST:
        cure = f"air stops such a bead within {delay:.2g} s, too soon for a flight: give a larger or denser one"
        raise refused("bead.radius", scene.bead.radius, cure)
    wavelength = scene.sound_speed / scene.frequency
    envelope = sequence._envelope(tau, hold)
    course = Course(sequence.points, wavelength, envelope.response, sequence.closed, envelope.before())
    for _, now, following in envelope.played(1):
        course.play(now, following)
    knots = course.knots(None if duration is None else number("duration", duration, above=0))
    places, own, points = _start(sequence, scene, course, beads, speeds)
    try:
        times, flown, ways, lost = course.fly(scene, places, own, points.tolist(), knots)
    except MemoryError as error:
        if duration is None:
            raise
        cure = "give a shorter one, or a higher limit (MIDAIR_MEMORY in the environment)"
        reported = f"the tracks of the beads need {getattr(error, 'value', 'more memory')}"
        raise MemoryError(f"duration is {duration:g} s: {reported}; {cure}") from None
    return Flight(times, flown, ways, lost, points)


def weigh(solution: Solution, frequency: float, ring_down: float, *, point: int = 0, axis: int = 2) -> Bead:
    """Find radius and density of a bead from its measured oscillation in a trap.

    Parameters
    ----------
    solution : midair.Solution
        The traps. Air, gravity and the sound speed of the bead are those of its scene.
    frequency : float
        Measured frequency in Hz of a small oscillation.
    ring_down : float
        Measured time in s in which its amplitude falls by a factor of e.
    point : int
        Index of the trap.
    axis : int
        Axis of the oscillation in the order of `midair.rest`: 0 is the least stiff one, 2 the stiffest.

    Returns
    -------
    midair.Bead
        The bead.

    Raises
    ------
    SceneError
        For numbers that are not above 0, and if no bead of up to an eighth of a wavelength rings like this.

    See Also
    --------
    midair.fly : how a bead rings.

    Notes
    -----
    In a ring-down t the air takes the effective mass m = 3 pi eta a (1 + a/d) t, where d is the thickness of
    the boundary layer. The stiffness of the trap is m (omega^2 + 1/t^2). It is proportional to the square of
    the array's `source_pressure`: if this is 1 % too high, the radius comes out 2 % too small.
    As J. Morrell and D. G. Grier, arXiv 2308.03682.

    Examples
    --------
    >>> import midair
    >>> boards = midair.Array.preset("openmpd_pair")
    >>> solution = midair.solve(midair.Scene(boards, [[0, 0, 0]], signature="trap", temperature=25))
    >>> bead = midair.weigh(solution, frequency=419, ring_down=0.07)
    >>> round(1e3 * bead.radius, 1), 28 < bead.density < 31
    (1.0, True)
    """
    frequency, ring_down = number("frequency", frequency, above=0), number("ring_down", ring_down, above=0)
    scene, omega = getattr(solution, "scene", None), 2 * np.pi * frequency
    if not isinstance(scene, Scene):
        raise refused("solution", solution, "give the result of midair.solve of a scene", "type")
    if point not in range(len(scene.points)) or axis not in range(3):
        cure = f"give point from 0 to {len(scene.points) - 1} and axis from 0 to 2"
        raise refused("point, axis", [point, axis], cure, "out-of-range")
    still, slow = np.zeros((1, 3)), np.array([[1e-6, 0, 0]])
    drag = (scene._needed(slow, still) - scene._needed(still, still))[0, 0] / slow[0, 0]
    viscosity = drag / (6 * np.pi * scene.bead.radius)
    layer = np.sqrt(2 * viscosity / (scene.density * omega))
    own = {name: getattr(scene.bead, name) for name in ("sound_speed", "gravity")}
    ends = low, high = 1e-3 * scene.wavelength, scene.wavelength / 8
    for _ in range(30):
        radius = (low + high) / 2
        mass = 3 * np.pi * viscosity * radius * (1 + radius / layer) * ring_down
        moved = np.pi * scene.density * radius**2 * (2 / 3 * radius + 3 * layer)
        density = max((mass - moved) / (4 / 3 * np.pi * radius**3), scene.density)
        bead = Bead(radius=radius, density=density, **own)
        resting = rest(scene, solution.drive, scene.points[point : point + 1], bead=bead)
        stiff = resting.stiffness[0, axis] > mass * (omega**2 + ring_down**-2)
        low, high = (low, radius) if stiff else (radius, high)
    if low == ends[0] or high == ends[1]:
        cure = "no bead up to an eighth of a wavelength rings like this in the trap: check it and ring_down"
        raise refused("frequency", frequency, cure)
    return bead


def _delay(scene: Scene) -> float:
    """Return the time constant in s with which a slow bead takes the velocity of the air."""
    rest, slow = np.zeros((1, 3)), np.array([[1e-3, 0, 0]])
    weight = scene._needed(rest, rest)
    # Drag of slow beads is linear, so the same number serves as velocity and as acceleration.
    delay = (scene._needed(rest, slow) - weight)[0, 0] / (scene._needed(slow, rest) - weight)[0, 0]
    return float(delay)


def _start(
    sequence: Sequence, scene: Scene, course: Course, beads: ArrayLike | None, speeds: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.intp]]:
    """Return places (B, 3) and velocities (B, 3) of the beads at the start, and each bead's point."""
    points = sequence.points[0]
    if beads is None:
        which = np.flatnonzero(sequence.targets[0] > 0)
        if not len(which):
            raise stated("targets", "are 0 in the first frame", "give beads, places (B, 3) in m")
        places = course.resting(scene, which.tolist())
    else:
        places = numbers("beads", beads, [(3,), (-1, 3)], "give places (B, 3) in m")
        places = sized("beads", places).reshape(-1, 3)
        away = np.linalg.norm(places[:, None] - points, axis=2)
        which, away = away.argmin(axis=1), away.min(axis=1)
        reach = LOST * scene.wavelength
        if len(far := np.flatnonzero(away > reach)):
            first, near = int(far[0]), f"give a place within half a wavelength, {1e3 * reach:.2g} mm"
            others = f" (and {len(far) - 1} more)" if len(far) > 1 else ""
            apart = f"{1e3 * away[first]:.4g} mm from point {which[first] + 1}"
            warn(f"beads[{first}] is {apart}{others}: it is lost at once, {near}")
    own = course.speeds(which.tolist()) if speeds is None else speeds
    own = sized("speeds", numbers("speeds", own, [(3,), places.shape], f"give {places.shape} in m/s"))
    fastest = float(np.linalg.norm(own, axis=-1).max())
    if fastest > scene.sound_speed:
        raise refused("speeds", f"{fastest:.4g} m/s", "faster than sound, give slower beads")
    return places, np.broadcast_to(own, places.shape), which
