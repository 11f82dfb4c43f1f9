"""`midair.tolerate`: plays one drive in many trials with random faults of array and air."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._midair import Scene, SceneError, Solution, about, judge, numbers, solve, solvers, stated, unknown_name
from .._support.arguments import callback, refused, whole
from .._support.cache import Arrays
from .._sweep.engine import Job, Settings, Stopped, go_on, pieces, run
from .tolerance import TOGETHER, Kept, Tolerance, faulty, sizes

#: Largest number of trials. They take hours, and means and quantiles then have a statistical error of only a
#: thousandth of the spread.
MOST_TRIALS = 1_000_000

#: Trials per job: few, so that a stop loses little work.
SIZE = 10


class _Halted(Exception):
    """Raised if `progress` requests a stop."""


def tolerate(
    scene: Scene | Solution,
    solver: str | Callable[..., Any] | None = None,
    *,
    drive: ArrayLike | Solution | None = None,
    phase: float = 0,
    gain: float = 0,
    dead: float = 0,
    reversed: float = 0,
    temperature: float = 0,
    tilt: float = 0,
    position: float = 0,
    trials: int = 200,
    seed: int = 0,
    threads: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Tolerance:
    """Measure how much level and uniformity remain when a drive is played with faults it was not solved for.

    Parameters
    ----------
    scene : midair.Scene or midair.Solution
        A solution is played as it is: `solution.tolerate(phase=20)`.
    solver : str or callable, optional
        As for `midair.solve`; the scene is solved once.
    drive : (N,) array_like or midair.Solution, optional
        Played as it is and not solved; targets are the scene's, as in `midair.judge`.
    phase : float, optional
        Error of each transducer's phase, standard deviation in degrees.
    gain : float, optional
        Error of each transducer's amplitude, standard deviation relative to 1; none is below 0.
    dead : float, optional
        Probability that a transducer is silent.
    reversed : float, optional
        Probability that a transducer has its wires the wrong way round.
    temperature : float, optional
        Error of the air's temperature, standard deviation in K.
    tilt : float, optional
        Tilt of the whole array about a random axis in its plane, standard deviation in degrees.
    position : float, optional
        Error of each transducer's position along each axis, standard deviation in m.
    trials : int, optional
        Number of trials, of each fault alone and of all together.
    seed : int, optional
        Seed of all random numbers; the answer does not depend on the number of threads.
    threads : int, optional
        Largest number of threads; by default one per processor.
    scheduler : str, optional
        Address of a Dask scheduler, tcp://host:port; by default this machine does the work.
    progress : callable, optional
        Called with (trials done, trials); False stops, and returns the finished trials.
    **options
        Options of the solver.

    Returns
    -------
    midair.Tolerance
        A row for each fault, and one for all together; `print` shows a table.

    Raises
    ------
    SceneError
        For faults out of their range, a call without faults, and what `midair.solve` refuses.
    TypeError
        If `scene` has another type, or the name of a fault is mistyped.

    See Also
    --------
    midair.judge : the metrics of a drive without faults.

    Notes
    -----
    Level is the mean of |p|/target, uniformity its min/max, as in `midair.judge`; both are relative to those
    without faults. For many transducers in phase, a phase error of s rad leaves exp(-s^2/2) of the level, a
    fraction d of dead ones 1 - d, of reversed ones 1 - 2 d.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> table = midair.tolerate(scene, "uniform", phase=20, dead=0.05, trials=20)
    >>> bool(0.9 < table["dead"].level.mean() < 1.0)
    True
    """
    callback(progress, "trials done, trials")
    found = Trials(
        scene,
        solver,
        drive=drive,
        faults={
            "phase": phase,
            "gain": gain,
            "dead": dead,
            "reversed": reversed,
            "temperature": temperature,
            "tilt": tilt,
            "position": position,
        },
        trials=trials,
        seed=seed,
        options=options,
    )
    found.run(threads=threads, scheduler=scheduler, progress=progress)
    table = found.table()
    assert table is not None
    return table


class Trials:
    """Runs trials and stores their results, so that an interruption does not lose them."""

    def __init__(
        self,
        scene: Scene | Solution,
        solver: str | Callable[..., Any] | None,
        *,
        drive: ArrayLike | Solution | None = None,
        faults: dict[str, float],
        trials: int,
        seed: int,
        options: dict[str, Any],
    ) -> None:
        if isinstance(scene, Solution):
            scene, drive, _ = about(scene, drive)
        elif not isinstance(scene, Scene):
            raise TypeError(
                f"expected a midair.Scene or a midair.Solution first, not {type(scene).__qualname__}"
            )
        self._faults = sizes(**faults)
        if not self._faults:
            raise _faultless(faults, options)
        self._trials = whole("trials", trials, least=1)
        if self._trials > MOST_TRIALS:
            raise refused("trials", trials, f"give at most {MOST_TRIALS}")
        self._seed = whole("seed", seed, least=0)
        if drive is None:
            solution = solve(scene, solver, **options)
            # A solution's scene includes the options of the solve, such as pressures.
            assert solution.scene is not None
            scene, drive, targets = solution.scene, solution, solution.targets
        else:
            for name, value in {"solver": solver, **options}.items():
                if value is not None:
                    raise refused(name, value, "drive is played as it is, give it or a solver")
            targets = np.abs(scene.reach().level if scene.pressures is None else scene.pressures)
        if not judge(scene, drive, pressures=targets).level:
            raise stated("scene", "is silent at its points", "give pressures above 0 that its array reaches")
        self._scene, self._targets = scene, targets
        self._solution = drive if isinstance(drive, Solution) else None
        if self._solution is not None:
            drive = self._solution.drive
        self._drive = numbers("drive", drive, [(len(scene.array),)], "give a drive (N,)", kinds="iufc")
        self._done: list[Arrays] = []

    def run(
        self,
        *,
        threads: int | None = None,
        scheduler: str | None = None,
        progress: Callable[[int, int], object] | None = None,
    ) -> None:
        """Run the trials, block by block."""
        if threads is not None:
            whole("threads", threads, least=1)
        # No files are written, so the settings need not be JSON.
        settings = {
            "scene": self._scene,
            "drive": self._drive,
            "targets": self._targets,
            "faults": self._faults,
            "seed": self._seed,
        }
        jobs = pieces(trials_of, settings, self._trials, SIZE)

        def receive(job: Job, arrays: Arrays) -> None:
            self._done.append(arrays)
            if progress is not None and progress(job.stop, self._trials) is False:
                raise _Halted

        try:
            run(jobs, receive, threads=threads, scheduler=scheduler)
        except _Halted:
            return

    def table(self) -> Tolerance | None:
        """Return the table of the trials that are done; None if there are none."""
        if not self._done:
            return None
        rows = {
            name: Kept(*np.concatenate([arrays[name] for arrays in self._done]).T)
            for name in groups(self._faults)
        }
        found = Tolerance(self._solution, self._faults, rows, "done")
        return found if found.trials == self._trials else replace(found, status="stopped")


def groups(faults: Mapping[str, float]) -> dict[str, Mapping[str, float]]:
    """Return the rows of the table: each fault alone, and all together if there are several."""
    alone: dict[str, Mapping[str, float]] = {name: {name: size} for name, size in faults.items()}
    return {**alone, TOGETHER: faults} if len(faults) > 1 else alone


def trials_of(settings: Settings, start: int, stop: int) -> Arrays:
    """Return level and uniformity (B, 2) of each row in trials start to stop, relative to no faults."""
    scene, drive, targets = settings["scene"], settings["drive"], settings["targets"]

    def measured(played: Scene) -> tuple[float, float]:
        try:
            metrics = judge(played, drive, pressures=targets)
        except SceneError as error:
            # If no working transducer reaches a point, level and uniformity of the trial are 0.
            if error.code == "unreached":
                return 0.0, 0.0
            raise
        return metrics.level, metrics.uniformity

    rows = groups(settings["faults"])
    found = {name: np.empty((stop - start, 2)) for name in rows}
    for trial in range(start, stop):
        for name, faults in rows.items():
            if not go_on():
                raise Stopped
            found[name][trial - start] = measured(faulty(scene, faults, settings["seed"], trial))
    whole = measured(scene)
    return {name: values / whole for name, values in found.items()}


def _faultless(faults: Mapping[str, float], options: Mapping[str, Any]) -> Exception:
    """Return the error of a call without faults. An unknown argument is probably a mistyped fault."""
    known = {*signature(solve).parameters}.union(*(each.options for each in solvers().values()))
    for name in options:
        if name.rstrip("_") not in known:
            return TypeError(str(unknown_name("argument of midair.tolerate", name, list(faults))))
    return stated("no fault", "is given", f"give at least one of {', '.join(faults)} above 0", code="missing")
