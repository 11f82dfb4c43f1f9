"""`midair.fly`: simulates beads in the traps of a sequence, and finds which beads are lost, and when."""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Bead, Scene, SceneError
from .._support.arguments import number, real, refused
from ..path._optimal import poised
from .envelope import Hold
from .judged import SETTLING, TAU
from .propagation import TERMS, Course, Forces
from .sequence import Flight, Sequence

#: Largest phase in rad that the fastest oscillation advances per step. Its frequency then has an error of
#: 1e-4.
ANGLE = 0.3

#: Knots (interpolation nodes in time) whose forces are computed together; number of such blocks that are
#: stored for later laps, about 500 MB.
KNOTS, KEPT = 1024, 32

#: Largest number of knots that are simulated in one call; and the number after a bead has left its cell, when
#: it may soon be lost.
FLOWN, SOON = 8192, 16

#: Distance between neighbouring cells, in radii of a cell, so that every place lies well inside of a cell.
LATTICE = 0.8

#: A bead farther than this from its point, in wavelengths, is lost: it is in another node or outside of the
#: field.
LOST = 0.5

#: Number of beads that are simulated together.
LANES = 8


@SETTLING
def fly(
    sequence: Sequence,
    beads: ArrayLike | None = None,
    *,
    speeds: ArrayLike | None = None,
    duration: float | None = None,
    tau: float = TAU,
    hold: Hold = "hold",
    radius: float | None = None,
    density: float | None = None,
    sound_speed: float | None = None,
    gravity: ArrayLike | None = None,
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
    radius, density, sound_speed, gravity
        Properties of the beads, as for `midair.gorkov`.

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
    Each bead obeys m x'' = F + weight - buoyancy - drag. F is Gor'kov's force in the field at that time, the
    drag Schiller and Naumann's in air at rest. m includes half the mass of the air in the bead's place.
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
    scene = sequence.scene(0)
    bead = Bead(scene, radius, density, sound_speed, gravity)
    course = Course.of(sequence._envelope(tau, hold), sequence.points, scene.sound_speed / scene.frequency)
    knots = course.knots(None if duration is None else number("duration", duration, above=0))
    start, points = _start(sequence, course, bead, beads, speeds)
    flown, lost = np.empty((knots, len(points), 3)), np.empty(len(points))
    times, ways = course.times(np.arange(knots)), course.ways(knots, points)
    for first in range(0, len(points), LANES):
        some = slice(first, first + LANES)
        group = Group(scene, course, bead, points[some], start[:, some], knots)
        lost[some] = group.flown(ways[:, some], flown[:, some])
    return Flight(times, flown, ways, lost, points)


def _start(
    sequence: Sequence, course: Course, bead: Bead, beads: ArrayLike | None, speeds: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the beads' places and velocities (2, B, 3) at the start, and the index of each bead's point."""
    points = sequence.points[0]
    moving, pulled = course.moving()
    if beads is None:
        which = np.flatnonzero(sequence.targets[0] > 0)
        if not len(which):
            raise SceneError("targets are 0 in the first frame: give beads, places (B, 3) in m")
        scene, drive = sequence.scene(0), course.drives[0]
        needed = bead.needed(moving[which], pulled[which])
        found = [poised(scene, drive, points[j], bead, force) for j, force in zip(which, needed, strict=True)]
        places = np.stack(
            [points[j] if place is None else place for j, place in zip(which, found, strict=True)]
        )
    else:
        places = np.atleast_2d(real("beads", beads, "give places (B, 3) in m"))
        if places.ndim != 2 or places.shape[1] != 3 or not np.isfinite(places).all():
            raise refused("beads", beads, "give places (B, 3) in m")
        which = np.linalg.norm(places[:, None] - points, axis=2).argmin(axis=1)
    own = moving[which] if speeds is None else real("speeds", speeds, "give (B, 3) in m/s")
    if own.shape not in ((3,), places.shape) or not np.isfinite(own).all():
        raise refused("speeds.shape", own.shape, f"give {places.shape}, finite, in m/s")
    return np.stack([places, np.broadcast_to(own, places.shape)]), which


class Group:
    """Up to eight beads that are simulated together.

    Each is in a cell, a ball that moves with the bead's point.
    """

    def __init__(
        self,
        scene: Scene,
        course: Course,
        bead: Bead,
        points: NDArray[np.intp],
        start: NDArray[np.float64],
        knots: int,
    ) -> None:
        # The knot after the last one of a lap, or of the flight if the flight is shorter than a lap.
        self._end = min(len(course.drives), knots - 1)
        self._course, self._bead, self._points, self._count = course, bead, points, len(points)
        self._forces = Forces(scene, bead.factors)
        # Indices of each bead's cell in a lattice of cells around its point.
        self._cells = np.zeros((self._count, 3), np.intp)
        self._there = np.full(self._count, True)
        self._kept: dict[tuple[int, ...], tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
        self._state = np.full((6, 3, LANES), np.nan)
        self._state[:2] = 0
        self._state[:2, :, : self._count] = start.swapaxes(1, 2)
        self._steps = 1
        self._settle(self._centres(0, 0)[0])
        first = self._stretch(0)
        forces, _ = self._around(*first)
        self._steps = self._fine(forces)
        self._kept = {name: (forces, self._centres(*first)) for name in self._kept}

    def flown(self, ways: NDArray[np.float64], flown: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the time at which each bead was lost, else NaN.

        Writes the beads' places (K, B, 3) at the knots to `flown`; `ways` are the points' places.
        """
        lost, most = np.full(self._count, np.nan), (LOST * self._forces.wavelength) ** 2
        first = 0
        while first < len(ways) - 1 and self._there.any():
            places = self._through(first, len(ways) - 1 - first)
            part = slice(first, first + len(places))
            flown[part] = places
            flown[part, ~self._there] = np.nan
            apart = places - ways[part]
            out = np.einsum("kbx,kbx->kb", apart, apart) > most
            for one in np.flatnonzero(self._there & out.any(axis=0)):
                end = first + int(out[:, one].argmax())
                lost[one] = self._course.times(np.array([end]))[0]
                self._there[one] = False
                flown[end:, one] = np.nan
            first = part.stop - 1
        flown[first + 1 :] = np.nan
        return lost

    def _stretch(self, knot: int) -> tuple[int, int]:
        """Return the first knot of the block whose forces are computed together, and the number of knots."""
        first = knot % len(self._course.drives) // KNOTS * KNOTS
        return first, min(KNOTS, self._end - first)

    def _through(self, first: int, most: int) -> NDArray[np.float64]:
        """Return places (K, B, 3) at up to `most` knots after `first`.

        If a bead leaves its cell, they end soon afterwards.
        """
        (begin, count), lap = self._stretch(first), len(self._course.drives)
        own = first % lap - begin
        # A short lap is simulated repeatedly with the same forces.
        most = min(most, FLOWN if count == lap else count - own)
        places = np.full((own + most + 1, 3, LANES), np.nan)
        places[own] = self._state[0]
        step, last = own * self._steps, (own + most) * self._steps
        while step < last:
            forces, centres = self._around(begin, count)
            reach = np.full(LANES, np.nan)
            reach[: self._count][self._there] = self._forces.unit
            time = self._course.spacing / self._steps, self._steps, self._forces.unit
            some = places[: last // self._steps + 1]
            step = self._bead.fly(self._state, reach.tolist(), forces, centres, step, some, time)
            if step < last:
                last = min(last, (step // self._steps + SOON) * self._steps)
            self._settle(centres[(step - 1) % (count * self._steps) + 1])
        return places[own : last // self._steps + 1, :, : self._count].swapaxes(1, 2)

    def _centres(self, first: int, count: int) -> NDArray[np.float64]:
        """Return the cells' centres (S, 3, 8) at the steps of `count` knots, delayed by the time constant."""
        knots = first + np.arange(count * self._steps + 1) / self._steps
        ways = self._course.points(self._course.times(knots) - self._course.envelope.tau)[:, self._points]
        found = np.zeros((len(knots), 3, LANES))
        found[:, :, : self._count] = (ways + self._offsets()).swapaxes(1, 2)
        return found

    def _offsets(self) -> NDArray[np.float64]:
        """Return the centres (B, 3) of the cells relative to the points."""
        return np.asarray(self._cells * (LATTICE * self._forces.unit), np.float64)

    def _settle(self, centres: NDArray[np.float64]) -> None:
        """Move each bead that is outside of its cell (centres (3, 8)) to the cell that contains it."""
        apart = (self._state[0] - centres)[:, : self._count].T
        out = self._there & (np.linalg.norm(apart, axis=1) > self._forces.unit)
        nearest = np.rint((apart + self._offsets()) / (LATTICE * self._forces.unit))
        self._cells[out] = nearest[out]

    def _around(self, own: int, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return forces (count + 1, 84, 3, 8) in the cells at knots, and centres (S, 3, 8) at the steps."""
        name = (own, count, *self._cells[self._there].ravel(), *np.flatnonzero(self._there))
        if name not in self._kept:
            if len(self._kept) >= KEPT:
                self._kept.clear()
            joined = np.zeros((count + 1, TERMS, 3, LANES))
            for one in np.flatnonzero(self._there):
                joined[..., one] = self._cell(own, count, int(one))
            self._kept[name] = joined, self._centres(own, count)
        return self._kept[name]

    def _cell(self, own: int, count: int, one: int) -> NDArray[np.float64]:
        """Return the force coefficients (count + 1, 84, 3) in the cell of one bead."""
        knots, laps = np.unique(
            np.arange(own, own + count + 1) % len(self._course.drives), return_inverse=True
        )
        drives = self._course.drives[knots]
        times = self._course.times(knots) - self._course.envelope.tau
        places = self._course.points(times)[:, self._points[one]] + self._offsets()[one]
        # While a frame lasts, several knots have equal drives and places; their forces are computed once.
        new = np.full(len(drives), True)
        new[1:] = (drives[1:] != drives[:-1]).any(axis=1) | (places[1:] != places[:-1]).any(axis=1)
        found = self._forces.around(places[new], drives[new])
        each: NDArray[np.float64] = found[(np.cumsum(new) - 1)[laps]]
        return each

    def _fine(self, forces: NDArray[np.float64]) -> int:
        """Return the number of steps between two knots that the stiffest trap needs."""
        slopes = np.linalg.norm(forces[:, 1:4], axis=(1, 2)).max() / self._forces.unit
        return max(ceil(self._course.spacing * float(np.sqrt(slopes / self._bead.mass)) / ANGLE), 1)
