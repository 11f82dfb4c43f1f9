"""The fastest run along a curve: as fast as a trap can accelerate a bead.

Let r(s) be a curve of length s with unit tangent t and curvature vector n. A bead with speed v that gains u
per second needs, in addition to its weight, the force

    f = m (v^2 n + u t) + drag(v) t

A trap gives at most the force R_k along its axis k, and along several axes the forces of the ellipsoid sum_k
(f_k/R_k)^2 <= margin^2. So at each s, every v^2 has a least and a largest u. The fastest run follows from two
passes (H. Pham and Q.-C. Pham, IEEE Trans. Robotics 34, 645, 2018). The backward pass finds, at each s, the
largest v^2 from which the rest of the curve is possible. The forward pass takes the largest u within these
limits. On a closed curve the passes repeat until end and start match. V. Paneva et al., "OptiTrap", ACM TOG 2022,
find such runs by optimal control.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._midair import Array, Bead, Path, Scene, rest, solve, stated
from .._support.arguments import flag, number, refused, vectors, without_warnings
from .._support.slips import BEAD, part_of_bead
from ._frames import Numbers, from_array

#: Steps along a curve; largest number of traps that are solved along it, half a wavelength apart.
STEPS, TRAPS = 500, 48

#: Speeds compared in each search, and number of searches: each one refines the interval, down to 1 cm/s.
TRIED, TIMES = 48, 4

#: Highest speed of a bead that is considered, in m/s.
TOP = 20.0

#: Times in s: between two places of the path, and the shortest time in which the force may change.
TICK, SMOOTH = 1e-4, 1e-3

#: Longest run in s, and least margin.
LONGEST, LEAST = 100.0, 1e-4

#: Without a margin: the one that gives the time of a run. A closed run then takes more force for a lower top
#: speed, because transducers follow late: a bead is behind its point in proportion to its speed. A constant
#: speed may take the part `STEADY` of the force; any other run, whose force changes more, the part `MORE`.
MARGIN, STEADY, MORE = 0.3, 0.5, 0.35
#: Ratio of two times of laps that count as equal.
SAME = 1.005

#: Constant speeds that race a closed run, relative to its mean; and the frames per second of the simulations,
#: at most `FRAMES` in a lap that races, at least `FLOWN` in s and laps.
RACED, RATE, FRAMES, FLOWN = (1.0, 1.03, 1.07, 1.12, 1.2, 1.3), 5e3, 1000, (0.15, 3)
#: Ratios of distances: up to `NEAR` a bead counts as near, beyond `FAR` no higher speed is tried.
NEAR, FAR = 1.05, 2.0


def fastest(
    points: ArrayLike,
    array: Array | Scene,
    *,
    closed: bool = True,
    margin: float | None = None,
    speed: float | None = None,
    bead: Bead | Mapping[str, Any] | None = None,
    **air: Any,
) -> Path:
    """Find the fastest run of a bead along a smooth curve.

    Parameters
    ----------
    points : (K, 3) array_like
        Places in m, at least 4, that a smooth curve goes through.
    array : midair.Array or midair.Scene
        The array that traps the bead. Of a scene, its array, air and obstacles are used.
    closed : bool, optional
        Whether the curve goes on from the last point to the first, for ever. Otherwise the bead starts and
        ends at rest.
    margin : float, optional
        Part of a trap's largest force along each of its axes that the run may take, from 1e-4 to below 1. The
        rest is for a board's steps, other points and draught; `midair.fly` shows whether it suffices. By
        default 0.3. A closed run without `margin` and `speed` takes up to 0.5 for a more even speed. It gives
        way to a constant speed that is faster, if a simulated bead stays as near its point.
    speed : float, optional
        Highest speed in m/s, at most 20. The transducers follow late, so a bead is behind its point by about
        .25 ms of its way; a lower speed bounds this distance.
    bead : midair.Bead or mapping, optional
        The bead; by default that of the scene.
    **air
        With an array: frequency, temperature, absorption, obstacles.

    Returns
    -------
    Path
        The bead's path. `midair.sequence` places each trap so that it gives the force which the run needs.

    Raises
    ------
    SceneError
        If no trap can keep the bead at some place, or an argument is invalid.

    Notes
    -----
    The trap of a single point is solved at places along the curve. The least force that `midair.rest`
    reports along each of its axes limits the run, which includes drag. The simulations take some seconds.

    Examples
    --------
    >>> import midair, numpy as np
    >>> boards = midair.Array.preset("openmpd_pair", quantization={})
    >>> angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    >>> ring = 0.02 * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    >>> midair.path.fastest(ring, boards, margin=0.3).duration < 0.2
    True
    """
    for name in sorted(BEAD & air.keys()):
        # `Scene` takes them for those of the air.
        raise part_of_bead("midair.path.fastest", name)
    share = number("margin", MARGIN if margin is None else margin, least=LEAST)
    if share >= 1:
        raise refused("margin", margin, "give a number below 1")
    if isinstance(array, Scene):
        scene = array.replace(points=[[0, 0, 0]], pressures=None, signature="trap", bead=bead, **air)
    elif isinstance(array, Array):
        scene = Scene(array, [[0, 0, 0]], signature="trap", bead=bead, **air)
    else:
        raise refused("array", array, "give a midair.Array or a midair.Scene")
    top = TOP if speed is None else min(number("speed", speed, above=0), TOP)
    loop = flag("closed", closed)
    curve = _smooth(vectors("points", points, least=4), loop)
    traps = _traps(scene, curve)
    speeds = _speeds(scene, curve, traps, (share, top), loop)
    races = loop and margin is None and speed is None
    if races:
        speeds = _evened(scene, curve, traps, speeds)
    places = curve.at(_timed(curve.step, speeds, loop, share), loop)
    run = from_array(places[:, None], rate=1 / TICK, closed=loop)
    return _raced(scene, curve, run) if races and run.duration * RATE < FRAMES else run


class _Curve(NamedTuple):
    """A curve at steps of equal length, with its start and its end.

    Attributes
    ----------
    step
        Length of a step in m.
    places
        (S, 3) in m.
    tangents
        (S, 3), unit vectors.
    bends
        (S, 3): curvature vectors, the derivative of the tangent, in 1/m.
    """

    step: float
    places: Numbers
    tangents: Numbers
    bends: Numbers

    def at(self, ways: Numbers, loop: bool) -> Numbers:
        """Return the places (T, 3) at lengths (T,) in m along the curve, cubic between the steps."""
        last = len(self.places) - 1
        ways = ways / self.step
        ways = ways % last if loop else ways.clip(0, last)
        before = np.minimum(ways.astype(np.intp), last - 1)
        t = (ways - before)[:, None]
        start, end = self.places[before], self.places[before + 1]
        out, into = self.step * self.tangents[before], self.step * self.tangents[before + 1]
        found: Numbers = start + t * (
            out + t * (3 * (end - start) - 2 * out - into + t * (2 * (start - end) + out + into))
        )
        return found


def _smooth(points: Numbers, loop: bool) -> _Curve:
    """Return the cubic spline through points, at steps of equal length."""
    if loop and np.allclose(points[0], points[-1], atol=1e-9):
        points = points[:-1]
        if len(points) < 4:
            cure = "the curve closes by itself, give at least 4 other points"
            raise refused(f"points[{len(points)}]", points[0].tolist(), cure)
    corners = np.concatenate([points, points[:1]]) if loop else points
    chords = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    if not (chords > 0).all():
        raise stated(f"points[{int(chords.argmin()) + 1}]", "is where the one before is", "leave it out")
    second = _second(corners, chords, loop)
    fine = 2 * STEPS
    along = np.concatenate([[0], np.cumsum(chords)])

    def spline(at: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """Return places, and their first and second derivatives."""
        k = np.minimum(np.searchsorted(along, at, side="right") - 1, len(chords) - 1)
        h, a = chords[k][:, None], (at - along[k])[:, None]
        b = h - a
        low, high, m0, m1 = corners[k], corners[k + 1], second[k], second[k + 1]
        place = (m0 * b**3 + m1 * a**3) / (6 * h) + (low / h - m0 * h / 6) * b + (high / h - m1 * h / 6) * a
        slope = (m1 * a**2 - m0 * b**2) / (2 * h) + (high - low) / h - (m1 - m0) * h / 6
        return place, slope, (m0 * b + m1 * a) / h

    # Length along the spline as a function of its parameter, which is inverted at equal steps.
    at = np.linspace(0, along[-1], 20 * fine + 1)
    speed = np.linalg.norm(spline(at)[1], axis=1)
    way = np.concatenate([[0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(at))])
    steps = np.interp(np.linspace(0, way[-1], STEPS + 1), way, at)
    place, slope, bend = spline(steps)
    rate = np.linalg.norm(slope, axis=1, keepdims=True)
    tangent = slope / rate
    bend -= np.einsum("sk,sk->s", bend, tangent)[:, None] * tangent
    return _Curve(float(way[-1]) / STEPS, place, tangent, bend / rate**2)


def _second(corners: Numbers, chords: Numbers, loop: bool) -> Numbers:
    """Return the second derivatives (K, 3) of the cubic spline: periodic, or 0 at its ends."""
    slopes = np.diff(corners, axis=0) / chords[:, None]
    count = len(chords) if loop else len(chords) + 1
    matrix, right = np.zeros((count, count)), np.zeros((count, 3))
    for k in range(count):
        if not loop and k in (0, count - 1):
            matrix[k, k] = 1
            continue
        before, after = chords[k - 1], chords[k]
        matrix[k, k - 1] += before
        matrix[k, k] += 2 * (before + after)
        matrix[k, (k + 1) % count] += after
        right[k] = 6 * (slopes[k] - slopes[k - 1])
    found = np.linalg.solve(matrix, right)
    return np.asarray(np.concatenate([found, found[:1]]) if loop else found, np.float64)


class _Traps(NamedTuple):
    """Traps at the steps of a curve; each is the trap that was solved at the nearest place.

    Attributes
    ----------
    axes
        (S, 3, 3): three unit vectors as rows.
    most
        (S, 3) in N: the largest restoring force along each axis, in the weaker of its two directions.
    """

    axes: Numbers
    most: Numbers


def _traps(scene: Scene, curve: _Curve) -> _Traps:
    """Return the traps of a bead along a curve."""
    last = len(curve.places) - 1
    half = scene.sound_speed / scene.frequency / 2
    count = min(max(int(last * curve.step / half), 4), TRAPS)
    looked = np.rint(np.linspace(0, last, count + 1)).astype(np.intp)
    found = []
    for place in curve.places[looked]:
        one = scene.replace(points=[place])
        with without_warnings():
            solution = solve(one)
        trap = rest(one, solution)
        if not trap.held[0]:
            # The error says what the warning of a bead that falls would.
            where = ", ".join(f"{1e3 * x:.1f}" for x in place)
            cure = "move the curve to where traps are strong"
            raise stated("no trap", f"holds the bead at ({where}) mm", cure)
        found.append((trap.axes[0], trap.restoring[0].min(axis=1)))
    axes, most = (np.array(part) for part in zip(*found, strict=True))
    nearest = np.abs(np.arange(last + 1)[:, None] - looked).argmin(axis=1)
    return _Traps(axes[nearest], most[nearest])


def _speeds(scene: Scene, curve: _Curve, traps: _Traps, limit: tuple[float, float], loop: bool) -> Numbers:
    """Return the squared speeds (S,) in m^2/s^2 of the fastest run, one for each step of the curve.

    `limit` is the part of a trap's force and the highest speed.
    """
    share, top = limit
    scale = traps.axes / (share * traps.most)[..., None]
    mass = scene._mass()
    gain = mass * np.einsum("skx,sx->sk", scale, curve.tangents)
    turn = mass * np.einsum("skx,sx->sk", scale, curve.bends)
    resist = gain / mass
    fast = np.linspace(0, top, 2001)
    drags = scene._needed(np.outer(fast, [1.0, 0, 0]), np.zeros((len(fast), 3)))[:, 0]

    def limits(i: int, squares: Numbers) -> tuple[Numbers, Numbers]:
        """Return the least and the largest acceleration u along the curve at step i, for squared speeds (K,).

        Both are NaN where none is possible.
        """
        own = np.outer(squares, turn[i]) + np.outer(np.interp(np.sqrt(squares), fast, drags), resist[i])
        a, b, c = gain[i] @ gain[i], own @ gain[i], (own**2).sum(axis=1) - 1
        with np.errstate(invalid="ignore"):
            root = np.sqrt(b * b - a * c)
        return (-b - root) / a, (-b + root) / a

    def highest(i: int, after: float) -> float:
        """Return the largest squared speed at step i from which `after` can be reached at the next step."""
        low, high = 0.0, top**2
        for _ in range(TIMES):
            squares = np.linspace(low, high, TRIED)
            least, _ = limits(i, squares)
            good = squares + 2 * curve.step * least <= after
            # At v = 0 every trap can keep its bead, so that at least one v^2 is possible.
            k = int(good.argmin()) - 1 if not good.all() else TRIED - 1
            low, high = squares[max(k, 0)], squares[min(max(k, 0) + 1, TRIED - 1)]
        return float(low)

    last = len(curve.places) - 1
    most = np.full(last + 1, top**2)
    if not loop:
        most[last] = 0.0
    for _ in range(2 if loop else 1):
        for i in range(last - 1, -1, -1):
            most[i] = highest(i, most[i + 1])
        most[last] = most[0] if loop else 0.0
    found = most.copy()
    if not loop:
        found[0] = 0.0
    for _ in range(4 if loop else 1):
        for i in range(last):
            gained = limits(i, found[i : i + 1])[1][0]
            found[i + 1] = max(min(found[i] + 2 * curve.step * gained, most[i + 1]), 0.0)
        if not loop or found[0] <= found[last] * (1 + 1e-6):
            break
        found[0] = found[last]
    return found


def _evened(scene: Scene, curve: _Curve, traps: _Traps, squares: Numbers) -> Numbers:
    """Return a run (S,) of the same lap with a lower top speed, or `squares` where more force gives none."""
    wanted = _times(curve.step, squares)[-1]
    steady = (len(squares) - 1) * curve.step / wanted
    even = _speeds(scene, curve, traps, (STEADY, steady), True)
    if _times(curve.step, even)[-1] < SAME * wanted:
        return even
    most = _speeds(scene, curve, traps, (MORE, TOP), True)
    low, high = steady**2, float(most.max())
    for _ in range(40):
        middle = (low + high) / 2
        slow = _times(curve.step, most.clip(max=middle))[-1] > wanted
        low, high = (middle, high) if slow else (low, middle)
    # To brake for a bend takes force from below the limit, so the lap may last longer than that of `most`.
    for _ in range(3):
        even = _speeds(scene, curve, traps, (MORE, float(np.sqrt(high))), True)
        longer = _times(curve.step, even)[-1] / wanted
        if longer < SAME:
            return even
        high *= longer**3
    return squares


def _raced(scene: Scene, curve: _Curve, run: Path) -> Path:
    """Return a closed run, or the fastest constant speed whose simulated bead stays as near its point.

    Beads ring in their traps. How much depends on the rate of the laps, so a faster lap may be nearer.
    """
    from .._flight.fly import fly
    from .._sequence.frames import air_of
    from .._sequence.solve import sequence

    def far(path: Path) -> float:
        frames = sequence(scene.array, path, rate=RATE, change=np.pi / 4, **air_of(scene))
        flight = fly(frames, duration=max(FLOWN[0], FLOWN[1] * path.duration))
        return float(flight.farthest[0]) if flight.held[0] else np.inf

    last = len(curve.places) - 1
    with without_warnings():
        most, best = far(run), run
        for faster in RACED:
            count = round(run.duration / faster / TICK)
            places = curve.at(np.arange(count, dtype=np.float64) * (last * curve.step / count), True)
            even = from_array(places[:, None], rate=1 / TICK, closed=True)
            distance = far(even)
            if distance > FAR * most:
                break
            best = even if distance <= NEAR * most else best
    return best


@np.errstate(divide="ignore", invalid="ignore")
def _times(step: float, squares: Numbers) -> Numbers:
    """Return the times (S,) in s at the steps of a run with these squared speeds."""
    speeds = np.sqrt(squares)
    times: Numbers = np.concatenate([[0], np.cumsum(2 * step / (speeds[1:] + speeds[:-1]))])
    return times


@np.errstate(divide="ignore", invalid="ignore")
def _timed(step: float, squares: Numbers, loop: bool, margin: float) -> Numbers:
    """Return lengths (T,) in m along the curve at each tick of a run with these squared speeds, smoothed."""
    speeds, times = np.sqrt(squares), _times(step, squares)
    if not times[-1] < LONGEST:
        raise refused("margin", margin, f"the run takes more than {LONGEST:g} s, give a larger part")
    count = int(np.ceil(times[-1] / TICK))
    lap, length = times[-1], step * (len(speeds) - 1)
    # Twice, this many ticks on each side are averaged. This lengthens a run from rest to rest by as many
    # ticks.
    side = int(SMOOTH / TICK) // 2
    ends = (2 if loop else 4) * side
    ticks = np.arange(-ends, count + ends + (not loop)) * (lap / count)
    inside = ticks % lap if loop else ticks.clip(0, lap)
    k = np.minimum(np.searchsorted(times, inside, side="right") - 1, len(speeds) - 2)
    after = inside - times[k]
    gain = (squares[k + 1] - squares[k]) / (2 * step)
    ways = step * k + speeds[k] * after + gain * after**2 / 2
    if loop:
        ways = ways + length * np.floor(ticks / lap)
    window = np.full(2 * side + 1, 1 / (2 * side + 1))
    return np.convolve(ways, np.convolve(window, window), "valid")
