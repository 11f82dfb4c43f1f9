"""`midair.sequence` and `midair.stream`: solve frames one after another within a bound of phase change."""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import (
    Array,
    Horizon,
    Moving,
    Scene,
    SceneError,
    Solution,
    Solver,
    bound_of,
    check_together,
    numbers,
    paced,
    restated,
    stated,
)
from .._support.arguments import callback, flag, frame_rate, number, refused, whole
from ..path import Path, read, still
from ..path._frames import changing_pressures
from . import store
from .arguments import time_constant
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
    callback(progress, "frames done, frames")
    frames = read(path, rate, pressures)
    moving = Moving(
        array,
        frames.points,
        frames.targets,
        solver,
        rate=rate,
        pascals=pressures is not None or (isinstance(path, Path) and path.pascals),
        joined=frames.closed if isinstance(path, Path) else None,
        change=change,
        change_rate=change_rate,
        tau=tau,
        closed=None if closed is None else flag("closed", closed),
        ahead=ahead,
        aim=aim,
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
    solution: Solution,
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
    levels = np.abs(solution.pressures) / max(solution.scale, 1e-30)
    return Sequence(
        scene.array,
        np.broadcast_to(scene.points, (len(factors), *scene.points.shape)),
        levels * factors,
        solution.drive * factors.astype(np.float32),
        rate=frames,
        closed=True,
        solver=solution.solver,
        **air_of(scene),
    )


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
    >>> hand = ([[0.001 * t, 0.0, 0.15]] for t in range(5))
    >>> drives = list(midair.stream(array, hand, rate=1e3))
    >>> len(drives), drives[0].shape
    (5, (249,))
    """
    each = frame_rate(rate)
    frames = _frames(frames, options)
    if known := whole("ahead", ahead, least=0):
        most = bound_of(each, change, change_rate)
        other = {name: value for name, value in options.items() if name not in (*AIR, "quantization")}
        check_together(solver, tau, other)
        return _ahead(array, frames, most, known, aim, options)
    follower = Solver(array, solver, **{**paced(solver, each, change, change_rate, tau, aim), **options})
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
            horizon = Horizon(Scene(array, points, **options), change, min(ahead, sys.maxsize >> 1), aim)
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
