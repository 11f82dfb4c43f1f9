"""Request of a sequence: path, rate and bound, and the speed of points that the bound allows."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import ceil, floor, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Scene, bound_of, meant, solvers
from .._support.arguments import flag, number, refused, warn
from ..path import Path, read
from .frames import AIR

if TYPE_CHECKING:
    from .judged import JudgedFrames

#: Largest number of frames that are examined for the speed limit.
LOOKED = 200


@dataclass(frozen=True)
class Request:
    """Points (T, M, 3) in m, targets (T, M) in Pa, and the settings of the solve.

    Attributes
    ----------
    scene
        The array, its air and the first frame.
    aim
        "target", or "max" if only points are given.
    stiff
        Whether the points are traps, or traps and foci, without requested pressures. Such traps are solved
        for the largest stiffness.
    """

    array: Array
    scene: Scene
    points: NDArray[np.float64]
    targets: NDArray[np.float64]
    rate: float
    change: float
    closed: bool
    aim: str
    air: dict[str, Any]
    options: dict[str, Any]
    stiff: bool

    @property
    def board(self) -> dict[str, Any]:
        """The board's quantization: from the options, else the array's."""
        given = self.options.get("quantization")
        return dict((self.array.quantization if given is None else given) or {})

    @property
    def full(self) -> bool:
        """Whether all drives have full amplitude."""
        return self.aim == "max" and bool((self.targets > 0).any(axis=1).all())


def solver_name(given: Any) -> Any:
    """Return a solver's registered name for a name with other case, "-" or "_"; else the name itself."""
    if not isinstance(given, str):
        return given

    def plain(name: str) -> str:
        return re.sub("[-_]", "", name).lower()

    return next((name for name in solvers() if plain(name) == plain(given)), given)


def bound(rate: float, change: Any, change_rate: Any) -> float:
    """Return the bound in rad per frame, from `change` in rad per frame or `change_rate` in rad/s."""
    rad = bound_of(rate, change, change_rate)
    if change is not None and rad > pi:
        cure = f"give {np.deg2rad(rad):.3g} if degrees are meant, pi for no bound"
        warn(f"change is {rad:g} rad, and above pi binds nothing: {cure}")
    return rad


def request(
    array: Array,
    path: Path | ArrayLike,
    rate: Any,
    bounds: tuple[Any, Any],
    closed: Any,
    pressures: ArrayLike | None,
    aim: str | None,
    options: dict[str, Any],
) -> Request:
    """Read all arguments of a sequence, and reject those that do not fit together."""
    if not isinstance(array, Array):
        raise TypeError(f"expected a midair.Array first, not {type(array).__qualname__}")
    frames = number("rate", rate, above=0)
    points, targets, loops = read(path, frames, pressures)
    if closed is not None:
        closed = flag("closed", closed)
    if closed and isinstance(path, Path) and not loops:
        raise refused("closed", closed, "the path's end is not its start, leave it out")
    air = {name: options.pop(name) for name in AIR if name in options}
    reported = pressures is not None or (isinstance(path, Path) and path.pascals)
    requested = np.ones(points.shape[:2]) if targets is None else targets
    scene = Scene(array, points[0], **air)
    if not reported:
        # Targets of modulation and fades are relative to the array's reach in the first frame.
        requested = requested * scene.reach().level
    aim, stiff = meant(scene, targets is None, aim)
    if aim == "max" and targets is not None and _swells(requested):
        warn('aim is "max", but pressures change between frames: leave it out, it plays each frame in full')
    rad = bound(frames, *bounds)
    loops = bool(loops if closed is None else closed)
    return Request(array, scene, points, requested, frames, rad, loops, aim, air, options, stiff)


def _swells(targets: NDArray[np.float64]) -> bool:
    """Return whether the sum of the targets (T, M) changes, over frames with all points present."""
    level = targets.sum(axis=1)[(targets > 0).all(axis=1)]
    return level.size > 0 and bool(level.max() > 1.01 * level.min())


def warn_of_speed(requested: Request, phases: int | None, solver: str) -> None:
    """Warn if points move faster than a focus can follow within the bound (docs/motion.md).

    On a board's grid the bound is a whole number of phase steps; if none fits, the solver reports that. Let a
    focus move by d along e between two frames, and let u_i be the direction from transducer i to the focus.
    The phase of transducer i changes by k d (u_i . e). A common phase of all transducers is free, so half the
    spread of k d (u_i . e) is needed.
    """
    info = solvers().get(solver)
    if info is not None and "change" not in info.options:
        return
    if requested.change > pi:
        return  # It binds nothing.
    needed, speed = _needed(requested)
    step = 0.0 if phases is None else 2 * pi / phases
    allowed = step * floor(requested.change / step + 1e-9) if step else requested.change
    if needed <= allowed * (1 + 1e-9) or (allowed == 0 and requested.change > 0):
        return
    if allowed == 0:
        needs = f"{speed:.3g} m/s needs {needed:.2g} rad a frame"
        warn(f"change is 0, and no phase changes: {needs}, give as much, or pi for no bound")
        return
    faster = ceil(requested.rate * needed / allowed / 100) / 10
    wanted = step * ceil(needed / step) if step else needed
    whole = f" in whole steps of {phases} phases" if allowed < requested.change * (1 - 1e-9) else ""
    wider = f" or pi/{int(pi / wanted)}" if wanted <= pi else ""
    text = (
        f"{speed:.3g} m/s needs {needed:.2g} rad a frame, {allowed:.3g} allowed{whole}: the level falls; "
        f"{faster:g} kHz{wider} would do"
    )
    warn(text)


def _needed(requested: Request) -> tuple[float, float]:
    """Return the largest bound that any point needs, over some frames, and the speed of this point."""
    points, there = requested.points, requested.targets > 0
    steps = np.arange(0 if requested.closed else 1, len(points), max((len(points) - 1) // LOOKED, 1))
    wavenumber = 2 * pi * requested.scene.frequency / requested.scene.sound_speed
    most, speed = 0.0, 0.0
    for step in steps:
        both = there[step] & there[step - 1]
        moved = (points[step] - points[step - 1])[both]
        rays = points[step][both][:, None] - requested.array.positions
        rays /= np.maximum(np.linalg.norm(rays, axis=2, keepdims=True), 1e-9)
        along = np.einsum("jik,jk->ji", rays, moved)
        spread = wavenumber * np.ptp(along, axis=1) / 2
        if spread.size and spread.max() > most:
            most = float(spread.max())
            speed = float(np.linalg.norm(moved[spread.argmax()]) * requested.rate)
    return most, speed


#: Accelerations below SLIGHT m/s^2 are possible for any trap. Accelerations are averaged over WHILE s.
SLIGHT, WHILE = 1.0, 3e-3


def warn_of_pull(sequence: JudgedFrames) -> None:
    """Warn if a trap cannot accelerate a bead along the path, at the most curved place."""
    scene, points = sequence.scene(0), sequence.points
    apart = max(round(WHILE * sequence.rate), 1)
    if scene.signature is None or len(points) <= 2 * apart:
        return
    times = np.arange(0 if sequence.closed else apart, len(points) - (0 if sequence.closed else apart))
    before, after = (points[(times + way * apart) % len(points)] for way in (-1, 1))
    pulled = (before - 2 * points[times] + after) * (sequence.rate / apart) ** 2
    moving = (after - before) * (sequence.rate / apart / 2)
    for j in range(points.shape[1]):
        size = np.linalg.norm(pulled[:, j], axis=1) * (sequence.targets[times, j] > 0)
        worst = int(size.argmax())
        if size[worst] < SLIGHT:
            continue
        frame = int(times[worst])
        force = scene._needed(moving[worst, j][None], pulled[worst, j][None])[0]
        if scene._poised(sequence.drive(frame), points[frame, j], force) is None:
            text = (
                f"point {j + 1} takes {size[worst]:.3g} m/s^2 in frame {frame}, more than its trap can give"
            )
            radius = f"{1e3 * scene.bead.radius:.3g} mm radius"
            warn(f"{text} a bead of {radius}: go slower, or by midair.path.fastest")
            return
