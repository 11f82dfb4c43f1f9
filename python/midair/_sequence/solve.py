"""`midair.sequence`, `stream` and `multiplex`: solve frames within a bound of change, or for their mean."""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from os import PathLike
from pathlib import Path as File
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._midair import Array, Motion, Moving, Scene, SceneError, Solver, numbers, restated, solver_name, stated
from .._support import arguments
from .._support.arguments import flag, frame_rate, number, refused, warn, whole, without_warnings
from ..path import Path, read, still
from ..path._frames import changing_pressures
from . import store
from .drives import time_constant
from .frames import AIR, air_of
from .sequence import Sequence

#: Largest number of frames of a modulated solution: as many as an AUTD3 board can store.
MOST_KEPT = 1024

#: Largest relative error of a number of periods that counts as whole.
ROUNDING = 1e-9

#: Number of frames between two calls of `progress`, and in one piece of a resumed file.
BLOCK = 1024


def sequence(
    array: Array,
    path: Path | ArrayLike,
    solver: str = "glide",
    *,
    rate: float,
    change: float | None = None,
    change_rate: float | None = None,
    tau: float | None = None,
    closed: bool | None = None,
    ahead: int | str = 0,
    pressures: ArrayLike | None = None,
    aim: str | None = None,
    progress: Callable[[int, int], object] | None = None,
    resume: str | PathLike[str] | None = None,
    **options: Any,
) -> Sequence:
    """Solve for points that move, frame after frame, no phase changing by more than a bound.

    Parameters
    ----------
    array : midair.Array
        N transducers.
    path : midair.path.Path or (T, M, 3) array_like
        A path, or the points of each frame in m.
    solver : str, optional
        "glide" keeps the bound. Other solvers begin with the last frame's drive if they use a start drive,
        and keep the bound if they have an option `change`.
    rate : float
        Frames per second.
    change, change_rate : float, optional
        The bound, in rad per frame or in rad/s; by default pi/16 per frame, pi for none.
    tau : float, optional
        Time constant of the transducers' envelopes in s, which `glide` takes into account.
    closed : bool, optional
        Whether the last frame continues to the first; by default as in the path. With ahead="all" this step
        is within the bound, too, and closed=True requires this; else `metrics.seam` reports it.
    ahead : int or "all", optional
        0: only earlier frames are known; n: also the next n frames; "all": all frames are solved together.
        Traps are as stiff as possible with 0 and "all"; with n their foci are equal.
    pressures : float, (M,) or (T, M) array_like, optional
        Targets in Pa, 0 where a point is absent. By default the path's own. Without any, each frame is as
        loud as possible; modulations and fades are those of the highest even level of all frames.
    aim : {"target", "max"}, optional
        As for `midair.solve`; by default "max" if only points are given.
    progress : callable, optional
        Called with (frames done, frames).
    resume : str or path, optional
        An .npz file, written while frames are solved, so that memory needs only a block. If stopped and
        called again with the same arguments, the solve continues and gives the same bits. A file with another
        content is rejected, never replaced.
    **options
        Options of the solver; the air: frequency, sound_speed, temperature, absorption, density, obstacles.
        signature="trap" moves traps. Without pressures the traps are as stiff as possible for `bead`, and
        foci beside them keep their level; with pressures they are solved like foci, and targets and
        pressures are those of these foci.

    Returns
    -------
    midair.Sequence
        The frames and their drives.

    Raises
    ------
    SceneError
        For wrong arguments.

    Warns
    -----
    SceneWarning
        If points move faster than the bound allows, or than traps can move a bead.

    See Also
    --------
    midair.stream : frames that come while they play.

    midair.path : points that move.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> ring = midair.path.circle([0, 0, 0.15], 0.01, frequency=50, points=2)
    >>> sequence = midair.sequence(array, ring, rate=10e3)
    >>> sequence.metrics.uniformity > 0.99, sequence.metrics.largest_change <= 0.1964
    (True, True)
    """
    arguments.callback(progress, "frames done, frames")
    frames = read(path, rate, pressures)
    pace: dict[str, Any] = {"rate": rate, "change": change, "change_rate": change_rate, "tau": tau}
    pace |= {"ahead": ahead, "aim": aim}
    moving = Moving(
        array,
        frames.points,
        frames.targets,
        solver,
        pascals=pressures is not None or (isinstance(path, Path) and path.pascals),
        joined=frames.closed if isinstance(path, Path) else None,
        closed=None if closed is None else flag("closed", closed),
        **pace,
        **options,
    )
    if tau is not None:
        time_constant(tau)
    if resume is not None:
        if moving.ahead is None:
            cure = "all frames are found together, leave it out"
            raise stated("resume", 'is given, but ahead is "all"', cure, code="conflict")
        own = {name: value for name, value in options.items() if name not in AIR}
        solved = store.solved(resume, moving, {"tau": tau, "options": own}, BLOCK, progress)
    else:
        solved = Sequence._solved(moving, _drives(moving, progress))
    moving.warn_of_pulls(solved.drive)
    return solved


def motion_of(file: File) -> Motion | None:
    """Read the motion of a scene file, None if it has no [motion]. Errors name the file and the line."""
    return Motion.read(arguments.existing("path", file, "give a .toml or .json file"))


def solver_of(motion: Motion) -> str:
    """Return the name of a file's solver; glide without one."""
    return motion.scene.solver[0] if motion.scene.solver else "glide"


def solve_motion(motion: Motion, array: Array | None = None, solver: str | None = None, **keywords: Any) -> Sequence:
    """Solve the sequence of a scene file; `array` and `solver` replace those of the file.

    The file's options apply to its own solver only. An error about a value of [motion] names the place in
    the file.
    """
    scene, own = motion.scene, solver_of(motion)
    name = own if solver is None else solver_name(solver)
    options = scene.solver[1] if scene.solver and name == own else {}
    given = {**motion.settings, **air_of(scene), **options, **keywords}
    try:
        return sequence(scene.array if array is None else array, motion.path, name, **given)
    except SceneError as error:
        placed = None if error.item in keywords else motion.placed(error)
        raise (placed or error) from error


def _drives(moving: Moving, progress: Callable[[int, int], object] | None) -> NDArray[Any]:
    """Return drives or codes (T, N) of all frames."""
    total = len(moving)
    if moving.ahead is None:
        step = None if progress is None else lambda step, steps, _: progress(step, steps)
        drives: NDArray[Any] = moving.block(0, total, step)
        return drives
    blocks = []
    for first in range(0, total, BLOCK):
        stop = min(first + BLOCK, total)
        blocks.append(moving.block(first, stop))
        if progress is not None:
            progress(stop, total)
    return blocks[0] if len(blocks) == 1 else np.concatenate(blocks)


def modulated(
    solution: _midair.Solution,
    frequency: float | ArrayLike,
    shape: Literal["sqrt", "cosine", "square"] = "sqrt",
    depth: float = 1.0,
    *,
    samples_rate: float | None = None,
    rate: float = 4e3,
) -> Sequence:
    """Modulate the amplitude of a solution's drive, as `path.Path.modulated` does, as a closed sequence.

    Parameters
    ----------
    solution : midair.Solution
        A solution with a scene.
    frequency : float or (S,) array_like
        Frequency in Hz; or samples from 0 to 1 that repeat.
    shape : {"sqrt", "cosine", "square"}, optional
        Shape of a period.
    depth : float, optional
        Depth of the modulation, from 0 (none) to 1.
    samples_rate : float, optional
        Samples per second.
    rate : float, optional
        Frames per second; at least twice the frequency, or as many as there are samples.

    Returns
    -------
    midair.Sequence
        Frames of whole periods.

    Raises
    ------
    SceneError
        For a solution without a scene, a wrong modulation, and a rate at which up to 1024 frames never
        contain whole periods.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> len(midair.solve(scene).modulated(200)), len(midair.solve(scene).modulated([1, 0], samples_rate=400))
    (20, 20)
    """
    if solution.scene is None:
        raise stated("solution.scene", "is None", "give a solution of a Scene", code="missing")
    frames, scene = frame_rate(rate), solution.scene
    if samples_rate is None:
        pace = number("frequency", frequency, above=0)
    else:
        frequency = numbers("samples", frequency, [(-1,)], "give samples (S,) from 0 to 1", least=0, most=1)
        pace = number("samples_rate", samples_rate, above=0) / len(frequency)
    # `numerator` frames contain `denominator` periods.
    ratio = Fraction(frames / pace).limit_denominator(1024)
    if ratio.numerator > MOST_KEPT or abs(float(ratio) * pace / frames - 1) > ROUNDING:
        near = frames / max(round(frames / pace), 2)
        raise refused("frequency", pace, f"no whole periods at {frames:g} frames/s, give {near:.6g} Hz")
    rest = still(scene.points[:1], duration=ratio.denominator / pace)
    factors = rest.modulated(frequency, shape, depth, samples_rate=samples_rate).frames(frames)[1]
    points = np.broadcast_to(scene.points, (len(factors), *scene.points.shape))
    levels = np.abs(solution.pressures) / max(solution.scale, 1e-30) * factors
    drives = solution.drive * factors.astype(np.float32)
    own: dict[str, Any] = {"rate": frames, "closed": True, "solver": solution.solver}
    return Sequence(scene.array, points, levels, drives, **own, **air_of(scene))


#: Arguments of `sequence` that `stream` does not accept, with the reason.
ELSEWHERE = {
    "pressures": "a stream takes them with each frame, as a pair (points, pressures)",
    "closed": "a stream has no last frame to go on from, leave it out",
}


def stream(
    array: Array,
    frames: Iterable[Any],
    solver: str = "glide",
    *,
    rate: float,
    change: float | None = None,
    change_rate: float | None = None,
    tau: float | None = None,
    ahead: int = 0,
    aim: str | None = None,
    **options: Any,
) -> Iterator[NDArray[np.complex64]]:
    """Yield the drive of each frame of an endless stream; with `ahead`, this many frames later.

    Parameters
    ----------
    array : midair.Array
        N transducers.
    frames : iterable
        Points (M, 3) in m, or pairs of points and pressures (M,) in Pa. M may change: a point that appears or
        vanishes suddenly changes the phases by as much as the bound allows.
    solver, rate, change, change_rate, tau, ahead, aim
        As for `midair.sequence`.
    **options
        Options of the solver, and the air, as for `midair.sequence`.

    Yields
    ------
    (N,) ndarray of complex64
        The drive of a frame.

    Raises
    ------
    SceneError
        If an argument or a frame is invalid.

    See Also
    --------
    midair.sequence : all frames at once.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> hand = ([[0.0005 * t, 0.0, 0.15]] for t in range(5))
    >>> drives = list(midair.stream(array, hand, rate=1e3))
    >>> len(drives), drives[0].shape
    (5, (249,))
    """
    each = frame_rate(rate)
    frames = _frames(frames, options)
    if known := whole("ahead", ahead, least=0):
        most = _midair.bound_of(each, change, change_rate)
        other = {name: value for name, value in options.items() if name not in (*AIR, "quantization")}
        _midair.check_together(solver, tau, other)
        return _ahead(array, frames, most, known, aim, options)
    options = {**_midair.paced(solver, each, change, change_rate, tau, aim), **options}
    follower = Solver(array, solver, **options)
    if tau is not None:
        time_constant(tau)
    return _followed(follower, frames)


def _followed(solver: Solver, frames: Iterable[Any]) -> Iterator[NDArray[np.complex64]]:
    for count, frame in enumerate(frames):
        with _numbered(count):
            points, pressures = _frame(frame)
            drive = solver.follow(points[None], None if pressures is None else pressures[None])[0]
        yield drive


def _ahead(
    array: Array, frames: Iterable[Any], change: float, ahead: int, aim: str | None, options: dict[str, Any]
) -> Iterator[NDArray[np.complex64]]:
    air = {name: options[name] for name in AIR if name in options}
    horizon = None
    for count, frame in enumerate(frames):
        with _numbered(count):
            points, pressures = _frame(frame)
            if pressures is None:
                # Missing pressures are the balanced level of the frame's points.
                pressures = np.full(len(points), Scene(array, points, **air).reach().level)
        if horizon is None:
            # No list is as long as the largest number.
            scene = Scene(array, points, **options)
            horizon = _midair.Horizon(scene, change, min(ahead, sys.maxsize >> 1), aim)
        horizon.push(points, pressures)
        if not horizon.wanted and (drive := horizon.advance()) is not None:
            yield drive
    while horizon is not None and (drive := horizon.advance()) is not None:
        yield drive


@contextmanager
def _numbered(count: int) -> Iterator[None]:
    """Name frame number `count` of a stream in errors about it."""
    try:
        yield
    except SceneError as error:
        place, item = f"frames[{count}]", error.item
        if item == "frame":
            raise restated(error, item=place, index=count) from None
        # A solver counts the frames of one call, which is one frame.
        raise restated(error, place=place, index=count) from None


def _frame(frame: Any) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return points (M, 3) and pressures (M,) or None of a frame of a stream."""
    given, pressures = frame if isinstance(frame, tuple) and len(frame) == 2 else (frame, None)
    cure = "give points x 3 numbers in m, and pressures if any as the second of a pair"
    # The scene checks the coordinates. A copy, because a caller may write the next frame into the same array.
    points = np.array(numbers("frame", given, [(-1, 3)], cure, copy=False), np.float64)
    return points, None if pressures is None else changing_pressures(pressures, 1, len(points))[0]


def _frames(given: Any, options: dict[str, Any]) -> Iterator[Any]:
    if isinstance(given, Path):
        raise TypeError("frames is a midair.path: give path.frames(rate)[0], or use midair.sequence")
    if not isinstance(given, Iterable):
        raise TypeError(f"frames is {given}: give points (M, 3) in m, frame after frame")
    for name, cure in ELSEWHERE.items():
        if name in options:
            raise refused(name, options[name], cure)
    return iter(given)


#: Largest relative error of the mean that gives no warning, as for solvers.
MISSED = 0.01
#: Most rounds: more would run for hours, and the error stands still after some tens.
MOST_ROUNDS = 10_000


def multiplex(
    scene: Scene, frames: int, solver: str = "descent", *, rate: float, rounds: int = 10, **options: Any
) -> Sequence:
    """Solve for several drives that play in turn, so that their mean |p|^2 is what the scene requests.

    Parameters
    ----------
    scene : midair.Scene
        M points and their pressures in Pa.
    frames : int
        Number of drives T, at least 2.
    solver : str, optional
        Solver of each drive; "descent" and "lm" go on from a drive and meet unequal targets.
    rate : float
        Frames per second.
    rounds : int, optional
        Number of times that the targets of the drives are divided anew, at most 10,000.
    **options
        Options of the solver.

    Returns
    -------
    midair.Sequence
        T frames, closed; `rms` (M,) is what the scene requests. `targets` are those of each frame.

    Raises
    ------
    SceneError
        For a scene without pressures or with a signature, and for wrong options.

    Warns
    -----
    SceneWarning
        If the mean misses the pressures by more than 1 %.

    See Also
    --------
    midair.solve : one drive.

    Notes
    -----
    At first each point belongs to one frame, with the target sqrt(T) t_j. In each round, frame k gets the
    targets t_j |p_jk| / sqrt(mean_k |p_jk|^2), the nearest ones with the right mean, and is solved from its
    last drive: alternating projections. The round of least error is returned.

    Examples
    --------
    >>> import midair
    >>> points = [[0.008 * x, 0.008 * y, 0.1] for x in range(-2, 3) for y in range(-2, 3)]
    >>> board = midair.Array.preset("openmpd_board", quantization={})
    >>> scene = midair.Scene(board, points, pressures=300)
    >>> pattern = midair.multiplex(scene, 3, rate=1e3)
    >>> bool(abs(pattern.rms / 300 - 1).max() < 1e-4)
    True
    """
    count, rounds = whole("frames", frames, least=2), whole("rounds", rounds, least=1, most=MOST_ROUNDS)
    rate = frame_rate(rate)
    if not isinstance(scene, Scene) or scene.pressures is None:
        raise refused("scene", scene, "give a midair.Scene with pressures=")
    if scene.signature is not None:
        raise stated("scene.signature", "is given", "a mean is of foci, leave it out", code="conflict")
    wanted, each = scene.pressures, np.ones(len(scene.points)) if scene.weights is None else scene.weights
    # Only ratios of weights count; in sums over points the largest is 1, so that none overflows.
    share = each / max(each.max(), np.finfo(float).tiny)
    # Frame k begins with the points k, k + T, k + 2 T and so on.
    turns = min(count, len(wanted) + 1)
    own = np.arange(len(wanted)) % turns == np.arange(turns)[:, None]
    if not ((share > 0) & (wanted > 0) & own).any(axis=1).all():
        raise refused("frames", frames, "each needs a point of a pressure and a weight above 0: give fewer")
    places = np.broadcast_to(scene.points, (count, *scene.points.shape))
    targets, weights, start = np.sqrt(count) * wanted * own, each * own, None
    gains, least = scene.propagation().T, np.inf
    for _ in range(1 + rounds):
        with without_warnings():
            batch = _midair.solve_batch(scene, places, targets, solver, weights=weights, start=start, **options)
        pressures = np.abs(batch.drives @ gains)
        mean = np.sqrt((pressures**2).mean(axis=0))
        missed = (share * (mean - wanted) ** 2).sum() / (share * wanted**2).sum()
        if missed < least:
            least, best = missed, (targets, batch.drives)
        targets = pressures * np.divide(wanted, mean, out=np.zeros(len(wanted)), where=mean > 0)
        weights, start = each, batch.drives
    if least > MISSED**2:
        warn(
            f"the mean of {count} frames misses the pressures by {100 * np.sqrt(least):.2g} %:"
            " give more frames, or fewer points or lower pressures"
        )
    return Sequence(scene.array, places, *best, rate=rate, closed=True, solver=solver, **air_of(scene))
