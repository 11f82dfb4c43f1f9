"""`midair.tune`: optimises a drive by readings instead of a model."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._boards.errors import named
from .._midair import Array, Scene, SceneWarning, Solution, numbers, solve, solver_name, solvers, stated
from .._support.arguments import callback, flag, refused, sized, warn, whole, word

#: Ends of a tuning: complete, out of readings, stopped by Ctrl-C or progress, or ended by an error of the
#: reader.
Status = Literal["done", "out_of_readings", "stopped", "failed"]


@dataclass(frozen=True, eq=False)
class Tuning:
    """Best drive that `midair.tune` found, and its readings.

    Attributes
    ----------
    drive : (N,) ndarray of complex64
        The drive, |q| <= 1.
    pressures : (M,) ndarray
        |p| of this drive, as read or as three readings determine it.
    value : float
        Distance from the targets: the residual of eq. (7) relative to silence; feedback: 1 - uniformity.
    readings : int
        Number of readings.
    status : str
        "done", "stopped", "out_of_readings" or "failed".
    error : Exception or None
        The error that the reader raised.
    trace : ndarray
        The value after each step; in greedy, after each transducer.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> found = midair.tune(lambda drive: abs(scene.propagation() @ drive), scene, "feedback", steps=3)
    >>> found.status, found.readings
    ('done', 3)
    """

    drive: NDArray[np.complex64]
    pressures: NDArray[np.float64]
    value: float
    readings: int
    status: Status
    error: Exception | None
    trace: NDArray[np.float64]


Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]
Drive = NDArray[np.complex64]
Read = Callable[[Drive], Any]

#: If a microphone reads the same value after this many changes of the drive, it does not measure the sound.
CHANGES = 2
#: Drives that differ by less at every transducer are the same.
SAME = 1e-3


class Ended(Exception):
    """Raised if tuning ends early, with its status."""


class Unreadable(Exception):
    """Raised if the reader has raised an error, with this error."""


class Player:
    """Reads |p| (M,) of drives (N,), at most `budget` times, and keeps the drive nearest to the targets.

    `value` returns the error of pressures (M,); `progress` is called with (readings, budget).
    """

    def __init__(
        self,
        read: Read,
        count: int,
        power: bool,
        value: Callable[[Real], float],
        budget: int,
        progress: Callable[[int, int], object],
    ) -> None:
        self._read, self._count, self._power = read, count, power
        self.value, self.budget, self._progress = value, budget, progress
        self.readings = 0
        self.best: tuple[float, Drive, Real] | None = None
        self.trace: list[float] = []
        self._last: Drive | None = None
        self._changes = 0
        self._quietest, self._loudest = np.full(count, np.inf), np.zeros(count)

    def __call__(self, drive: NDArray[Any]) -> Real:
        """Play a drive, and return |p| (M,) that the reader measures at the places."""
        if self.readings >= self.budget:
            raise Ended("out_of_readings")
        if self._progress(self.readings, self.budget) is False:
            raise Ended("stopped")
        played = drive.astype(np.complex64)
        played.flags.writeable = False
        try:
            given = self._read(played)
            found = self._checked(given)
        except Exception as error:
            raise Unreadable(error) from error
        self.readings += 1
        self._changes += self._last is not None and not np.allclose(played, self._last, rtol=0, atol=SAME)
        self._last = played
        self._quietest, self._loudest = np.minimum(found, self._quietest), np.maximum(found, self._loudest)
        self.offer(played, found)
        return found

    def offer(self, drive: NDArray[Any], pressures: Real) -> None:
        """Keep a drive if its pressures are nearer to the targets than the best so far."""
        value = self.value(pressures)
        if self.best is None or value < self.best[0]:
            kept = drive.astype(np.complex64)
            kept.flags.writeable = False
            self.best = (value, kept, pressures)

    def deaf(self) -> str | None:
        """Return a message about places that read 0 or the same in all readings; None if there are none."""
        same = (self._loudest == self._quietest) & ((self._loudest == 0) | (self._changes >= CHANGES))
        if not same.any():
            return None
        first, *others = np.flatnonzero(same)
        where = f"{first} and {len(others)} more" if others else f"{first}"
        return (
            f"read gave |p| = {self._loudest[first]:.4g} at place {where} in all {self.readings} readings: "
            "a dead microphone, mend it or leave its point out"
        )

    def _checked(self, given: Any) -> Real:
        cure = f"give {'|p|^2' if self._power else '|p|'} at {self._count} places, real numbers"
        shapes = [(self._count,), ()][: 2 if self._count == 1 else 1]
        found = np.atleast_1d(sized("read(drive)", numbers("read(drive)", given, shapes, cure, least=0)))
        return np.sqrt(found) if self._power else found


#: SPSA (Spall 1998, IEEE TAES 34, 817): initial step (rad per unit of value) and perturbation (rad), the
#: exponents by which they fall, and the delay of the step's fall as a fraction of all iterations.
STEP, NUDGE = 4.0, 0.4
STEP_FALLS, NUDGE_FALLS, DELAY = 0.602, 0.101, 0.1


def spsa(player: Player, drive: Complex, steps: int, seed: int, on_board: Callable[[Real], Drive]) -> None:
    """SPSA: phi <- phi - a_k (f(phi + c_k d) - f(phi - c_k d)) / (2 c_k) d, with random signs d.

    phi are the phases, f is the error of the readings, a_k the step and c_k the perturbation of iteration k.
    """
    rng = np.random.default_rng(seed)
    phases = np.angle(drive).astype(np.float64)
    for k in range(steps):
        nudge = NUDGE / (k + 1) ** NUDGE_FALLS
        step = STEP / (k + 1 + DELAY * steps) ** STEP_FALLS * (DELAY * steps) ** STEP_FALLS
        signs = rng.choice([-1.0, 1.0], len(phases))
        values = [player.value(player(on_board(phases + sign * nudge * signs))) for sign in (1.0, -1.0)]
        phases -= step * (values[0] - values[1]) / (2 * nudge) * signs
        player.trace.append(min(values))
    player(on_board(phases))


#: A later candidate wins only if it is better by more than rounding errors (docs/reproducibility.md).
ROUNDING = 1e-7


def greedy(player: Player, drive: Complex, order: Indices, phases: int, tries: bool) -> None:
    """Set one transducer after another to the phase that fits the targets best.

    As a function of one transducer's phase phi, |p|^2 at any place is a + b cos phi + c sin phi. Three
    readings determine it at every phase. `tries` reads each of the L phases instead, as in the paper.
    """
    turns = 2 * np.pi * np.arange(phases) / phases
    received = np.arange(phases) if tries or phases <= 3 else np.round(np.arange(3) * phases / 3).astype(int)
    waves = np.stack([np.ones(phases), np.cos(turns), np.sin(turns)], axis=1)
    # Matrix from |p|^2 at the phases read to |p|^2 at all phases.
    spread = np.eye(phases) if len(received) == phases else waves @ np.linalg.inv(waves[received])
    drive = drive.copy()
    for index in order:
        powers = []
        for phase in received:
            drive[index] = np.exp(1j * turns[phase])
            powers.append(player(drive) ** 2)
        pressures = np.sqrt(np.maximum(spread @ np.array(powers), 0.0))
        values = np.array([player.value(each) for each in pressures])
        chosen = int(np.flatnonzero(values <= values.min() + ROUNDING * max(values.max(), 1.0))[0])
        drive[index] = np.exp(1j * turns[chosen])
        player.offer(drive, pressures[chosen])
        player.trace.append(float(values[chosen]))


#: Exponent of the correction: the part of a deviation, in logarithms, that one step corrects.
POWER = 0.7
#: Lower limit of a place's x_j = |p_j| / target_j, relative to the mean. Without it a silent place would get
#: an unlimited target.
QUIETEST = 0.1


def feedback(player: Player, scene: Scene, targets: Real, solver: str, steps: int) -> None:
    """Correct targets t_j by (mean x / x_j)^0.7, x_j = |p_j| / target_j as read; solve the scene for them.

    This is the camera feedback of slmsuite. Each solve begins with the last drive, because another even field
    would need other corrections.
    """
    info = solvers()[solver_name(word("solver", solver))]
    # Only ratios are corrected, so solvers with `aim` play the points as loud as possible.
    aim: Literal["max"] | None = "max" if info.uses_aim else None
    last: Solution | None = None
    wanted = targets.copy()
    requested = targets > 0
    for step in range(steps):
        with warnings.catch_warnings():
            if step:
                # The corrected targets are internal, so they must not cause warnings.
                warnings.simplefilter("ignore", SceneWarning)
            begun: dict[str, Any] = {"start": last} if last is not None and info.uses_start else {}
            last = solve(scene.replace(pressures=wanted), solver, aim=aim, **begun)
        pressures = player(last.drive)
        player.trace.append(player.value(pressures))
        x = pressures[requested] / targets[requested]
        mean = x.mean()
        if mean == 0:
            return
        wanted[requested] *= (mean / np.maximum(x, QUIETEST * mean)) ** POWER
        wanted[requested] *= targets[requested].mean() / wanted[requested].mean()


METHODS = ("greedy", "feedback", "spsa")
#: Default number of steps of each method.
STEPS = {"feedback": 10, "spsa": 384}


def tune(
    read: Read,
    array_or_scene: Array | Scene,
    method: Literal["greedy", "feedback", "spsa"] = "greedy",
    *,
    targets: ArrayLike | None = None,
    start: Literal["silence", "model"] | ArrayLike | Solution | None = None,
    phases: int = 16,
    tries: bool = False,
    steps: int | None = None,
    budget: int | None = None,
    power: bool = False,
    solver: str = "uniform",
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Tuning:
    """Find a drive by readings of a microphone or camera, without trust in the model.

    Parameters
    ----------
    read : callable
        read(drive) plays a drive (N,) and returns |p| (M,) at the places.
    array_or_scene : midair.Array or midair.Scene
        A scene whose points are the places, or an array alone with `targets`.
    method : {"greedy", "feedback", "spsa"}, optional
        "greedy": transducer by transducer, three readings each. "feedback": the model solved for targets
        that the readings correct. "spsa": all phases changed at random.
    targets : (M,) array_like, optional
        Wanted |p| in the readings' unit; by default the scene's pressures or balanced level.
    start : {"silence", "model"}, (N,) array_like or midair.Solution, optional
        First drive; "model" is the scene solved. By default greedy begins in silence, spsa with the
        model's answer. Feedback always solves.
    phases : int, optional
        Number L of candidates of greedy.
    tries : bool, optional
        Whether greedy reads each candidate: L readings per transducer, as in the paper, in place of three.
    steps : int, optional
        Steps of feedback (10, a reading each) and spsa (384, two readings each).
    budget : int, optional
        Largest number of readings.
    power : bool, optional
        Whether `read` returns |p|^2.
    solver : str, optional
        Method that solves the model.
    seed : int, optional
        Seed of greedy's order and spsa's signs.
    progress : callable, optional
        Called with (readings, total) before each; False stops.

    Returns
    -------
    midair.Tuning
        The best drive found, whatever ends the work: Ctrl-C or progress (status "stopped"), the budget
        ("out_of_readings"), an error of `read` ("failed", with `error`).

    Raises
    ------
    SceneError
        For wrong arguments, and for readings of another shape than the places.

    Warns
    -----
    SceneWarning
        If `read` raises an error, or a place reads 0 or the same value in all readings.

    See Also
    --------
    midair.calibrate : a better model, for every later scene.

    Examples
    --------
    >>> import midair, numpy as np
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> real = scene.propagation() * np.exp(1j * np.linspace(0, 3, 400))
    >>> found = midair.tune(lambda drive: abs(real @ drive), scene, "feedback", steps=5)
    >>> bool(found.pressures.min() > 0.99 * found.pressures.max())
    True
    """
    if not callable(read):
        raise refused("read", read, "give a function of a drive (N,) that answers |p| (M,)")
    if word("method", method) not in METHODS:
        raise refused("method", method, f"give one of {', '.join(METHODS)}")
    if not isinstance(array_or_scene, Array | Scene):
        raise refused("array_or_scene", array_or_scene, "give a midair.Scene or a midair.Array")
    callback(progress, "readings, of how many")
    seed = whole("seed", seed, least=0)
    scene = array_or_scene if isinstance(array_or_scene, Scene) else None
    array = scene.array if scene is not None else array_or_scene
    assert isinstance(array, Array)
    wanted = _targets(targets, scene)
    sounding = array.mask if array.response is None else array.mask & (array.response != 0)
    alive = np.flatnonzero(sounding)
    drive = _start(start, method, scene, sounding, solver)
    received = whole("phases", phases, least=2) if flag("tries", tries) or phases <= 3 else 3
    count = whole("steps", steps, least=1) if steps is not None else STEPS.get(method, 0)
    full = {"greedy": received * len(alive), "feedback": count, "spsa": 2 * count + 1}[method]
    most = full if budget is None else min(full, whole("budget", budget, least=1))
    value = _evenness if method == "feedback" else _residual
    player = Player(
        read, len(wanted), flag("power", power), partial(value, wanted), most, progress or (lambda *_: True)
    )
    work: Callable[[], None]
    if method == "greedy":
        _on_grid(phases, array)
        order = np.random.default_rng(seed).permutation(alive)
        work = partial(greedy, player, drive, order, phases, tries)
    elif method == "feedback":
        if scene is None:
            raise stated("feedback", "solves a model", "give a midair.Scene whose points are the places read")
        work = partial(feedback, player, scene, wanted, solver, count)
    else:
        work = partial(spsa, player, drive, count, seed, partial(_on_board, array, np.abs(drive)))
    status, error = _through(work, player)
    if player.best is None:
        if error is None:
            raise KeyboardInterrupt
        raise stated("read", "failed at its first reading", f"{named(error)}") from error
    if error is not None:
        warn(f"read failed at reading {player.readings + 1}: {named(error)}; the best drive so far is kept")
    if deaf := player.deaf():
        warn(deaf)
    best, played, pressures = player.best
    return Tuning(played, pressures, best, player.readings, status, error, np.array(player.trace))


def _through(work: Callable[[], None], player: Player) -> tuple[Status, Exception | None]:
    try:
        work()
    except Ended as end:
        return end.args[0], None
    except Unreadable as end:
        return "failed", end.args[0]
    except KeyboardInterrupt:
        return "stopped", None
    return ("done" if player.readings else "stopped"), None


def _residual(targets: Real, pressures: Real) -> float:
    """Return the residual of eq. (7), relative to silence."""
    return float(np.sum((targets - pressures) ** 2) / np.sum(targets**2))


def _evenness(targets: Real, pressures: Real) -> float:
    """Return 1 - uniformity."""
    x = pressures[targets > 0] / targets[targets > 0]
    return float(1 - x.min() / x.max()) if x.max() > 0 else 1.0


def _targets(given: ArrayLike | None, scene: Scene | None) -> Real:
    cure = "give |p| (M,) in the readings' unit, one a place, not all 0"
    if given is None and scene is None:
        cure = "give |p| (M,) in the readings' unit, or a scene with points"
        raise stated("targets", "are left out", cure, code="missing")
    if given is None:
        assert scene is not None
        given = np.abs(scene.reach().level if scene.pressures is None else scene.pressures)
    count = -1 if scene is None else len(scene.points)
    found = np.atleast_1d(numbers("targets", given, [(), (1,), (count,)], cure, least=0))
    if not found.any():
        raise refused("targets", given, cure)
    return found if scene is None else np.broadcast_to(found, count)


def _start(
    given: Any, method: str, scene: Scene | None, sounding: NDArray[np.bool_], solver: str
) -> NDArray[np.complex128]:
    """Return the initial drive."""
    if given is None:
        given = "silence" if method != "spsa" else "model" if scene is not None else np.ones(len(sounding))
    if isinstance(given, str):
        if given not in ("silence", "model"):
            raise refused("start", given, 'give "silence", "model" or a drive (N,)')
        if given == "silence" and method == "spsa":
            cure = 'spsa turns phases of what sounds, give "model" or a drive (N,)'
            raise stated("start", 'is "silence"', cure)
        if given == "silence":
            return np.zeros(len(sounding), np.complex128)
        if scene is None:
            cure = "an array alone has none, give a scene whose points are the places"
            raise stated("start", 'is "model"', cure)
        given = solve(scene, solver)
    given, cure = given.drive if isinstance(given, Solution) else given, 'give "silence", "model" or a drive'
    cure = f"{cure} ({len(sounding)},)"
    found = numbers("start", given, [sounding.shape], cure, kinds="iufc", most=1 + 1e-5)
    return np.asarray(found * sounding, np.complex128)


def _on_grid(phases: int, array: Array) -> None:
    """Reject a number of phases that the board cannot play."""
    grid = (array.quantization or {}).get("phases")
    if isinstance(grid, int) and grid % phases:
        raise refused("phases", phases, f"the board has {grid}, give a divisor of that")


def _on_board(array: Array, amplitudes: Real, phases: Real) -> Drive:
    """Return the drive of these amplitudes and phases, with phases rounded to those of the board."""
    grid = (array.quantization or {}).get("phases")
    if isinstance(grid, int):
        phases = np.round(phases * grid / (2 * np.pi)) * (2 * np.pi / grid)
    return np.asarray(amplitudes * np.exp(1j * phases), np.complex64)
