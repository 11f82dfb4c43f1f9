"""`midair.fly` simulates beads in the traps of a sequence; `midair.weigh` finds a bead from how it rings."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Bead, Course, Scene, Solution, numbers, rest, stated
from .._sequence.envelope import Hold
from .._sequence.judged import SETTLING, TAU
from .._sequence.sequence import Sequence
from .._support.arguments import number, refused, sized, warn
from .flight import Flight

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
        cure = (
            f"air stops such a bead within {delay:.2g} s, too soon for a flight: give a larger or denser one"
        )
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
    scene, omega = solution.scene, 2 * np.pi * frequency
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
        held = rest(scene, solution.drive, scene.points[point : point + 1], bead=bead)
        stiff = held.stiffness[0, axis] > mass * (omega**2 + ring_down**-2)
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
