"""Request of a sequence: path, rate and bound, read once; and the speed that the bound allows."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import ceil, floor, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Bead, Scene, SceneError, solvers
from .._support.arguments import number, refused, warn, whole
from ..path import Path, read
from ..path._optimal import poised
from .frames import AIR

if TYPE_CHECKING:
    from .judged import JudgedFrames

#: The bound where none is given, in rad a frame: at 10 kHz the shift of 312 Hz that a transducer follows.
CHANGE = pi / 16

#: Frames that are looked at for the speed limit at most.
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
        Whether only points are given, and they are traps.
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
        """The board's quantization: as an option says, else the array's own."""
        given = self.options.get("quantization")
        return dict((self.array.quantization if given is None else given) or {})

    @property
    def full(self) -> bool:
        """Whether all drives are at full amplitude."""
        return self.aim == "max" and bool((self.targets > 0).any(axis=1).all())


def solver_name(given: Any) -> Any:
    """The name of a solver as it is known, of which case, "-" and "_" do not count; another as it is."""
    if not isinstance(given, str):
        return given

    def plain(name: str) -> str:
        return re.sub("[-_]", "", name).lower()

    return next((name for name in solvers() if plain(name) == plain(given)), given)


def bound(rate: float, change: Any, change_rate: Any) -> float:
    """The bound in rad a frame, given so or in rad/s."""
    if change is not None and change_rate is not None:
        raise refused("change_rate", change_rate, "change is given, too: give one of them")
    if change_rate is not None:
        return number("change_rate", change_rate, least=0) / rate
    if change is None:
        return CHANGE
    rad = number("change", change, least=0)
    if rad > pi:
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
    """Read all of it, and reject parts that do not fit."""
    if not isinstance(array, Array):
        raise TypeError(f"expected a midair.Array first, not {type(array).__qualname__}")
    frames = number("rate", rate, above=0)
    points, targets, loops = read(path, frames, pressures)
    if closed and isinstance(path, Path) and not loops:
        raise refused("closed", closed, "the path's end is not its start, leave it out")
    air = {name: options.pop(name) for name in AIR if name in options}
    reported = pressures is not None or (isinstance(path, Path) and path.pascals)
    requested = np.ones(points.shape[:2]) if targets is None else np.asarray(targets)
    scene = Scene(array, points[0], **air)
    if not reported:
        # Relative to the array's reach in the first frame.
        requested = requested * scene.reach().level
    if aim is None:
        aim = "max" if targets is None else "target"
    elif aim == "max" and _swells(requested):
        warn('aim is "max", but pressures change between frames: leave it out, it plays each frame in full')
    rad = bound(frames, *bounds)
    stiff = targets is None and aim == "max" and scene.signature == "trap"
    loops = bool(loops if closed is None else closed)
    return Request(array, scene, points, requested, frames, rad, loops, aim, air, options, stiff)


def _swells(targets: NDArray[np.float64]) -> bool:
    """Whether the targets (T, M) of the present points of a frame swell and fade together."""
    level = targets.sum(axis=1)[(targets > 0).all(axis=1)]
    return level.size > 0 and bool(level.max() > 1.01 * level.min())


def warn_of_speed(requested: Request, phases: int | None) -> None:
    """Warn where points move faster than the bound lets a focus follow (docs/motion.md).

    On a board's grid the bound is in whole steps of its phases; where not one fits, the solver tells it.

    A focus that moves by d along e between two frames turns transducer i by k d (u_i e), u_i from it to the
    focus, of which one phase is free for all: half the spread of k d (u_i e) is needed.
    """
    needed, speed = _needed(requested)
    step = 0.0 if phases is None else 2 * pi / phases
    allowed = step * floor(requested.change / step + 1e-9) if step else requested.change
    if needed <= allowed * (1 + 1e-9) or allowed == 0:
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
    """The largest bound that a point needs, and its speed, over some frames."""
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


#: Smaller accelerations, in m/s^2, any trap can give; and the time in s over which they are averaged.
SLIGHT, WHILE = 1.0, 3e-3


def warn_of_pull(sequence: JudgedFrames) -> None:
    """Warn where a trap cannot pull a bead as its point moves, at the most curved place of a path."""
    scene, points = sequence.scene(0), sequence.points
    apart = max(round(WHILE * sequence.rate), 1)
    if scene.signature is None or len(points) <= 2 * apart:
        return
    times = np.arange(0 if sequence.closed else apart, len(points) - (0 if sequence.closed else apart))
    before, after = (points[(times + way * apart) % len(points)] for way in (-1, 1))
    pulled = (before - 2 * points[times] + after) * (sequence.rate / apart) ** 2
    moving = (after - before) * (sequence.rate / apart / 2)
    bead = Bead(scene)
    for j in range(points.shape[1]):
        size = np.linalg.norm(pulled[:, j], axis=1) * (sequence.targets[times, j] > 0)
        worst = int(size.argmax())
        if size[worst] < SLIGHT:
            continue
        frame = int(times[worst])
        force = bead.needed(moving[worst, j][None], pulled[worst, j][None])[0]
        if poised(scene, sequence.drive(frame), points[frame, j], bead, force) is None:
            text = (
                f"point {j + 1} takes {size[worst]:.3g} m/s^2 in frame {frame}, more than its trap can give"
            )
            warn(f"{text} a bead of 1 mm radius: go slower, or by midair.path.fastest")
            return


def sight(ahead: Any, closed: bool) -> int | None:
    """The frames that are known in advance, None for all of them; a closed curve has to know its end."""
    if isinstance(ahead, str) and ahead == "all":
        return None
    if isinstance(ahead, str):
        raise refused("ahead", ahead, 'give a whole number of frames, or "all"')
    frames = whole("ahead", ahead, least=0)
    if closed:
        raise SceneError(
            f'closed is True, but ahead is {frames}: give ahead="all", that the last frame meets the first'
        )
    return frames
