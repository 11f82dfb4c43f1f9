"""`midair.tolerate`: plays one drive in many trials with random faults of array and air."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._boards.board import changed
from .._midair import Scene, Solution, about, judge, numbers, rotation, solve, solvers, stated, unknown_name
from .._pictures.colours import Axes, Figure, Size
from .._support import text as columns
from .._support.arguments import callback, number, refused, whole
from .._support.cache import Arrays
from .._sweep.engine import Job, Settings, Stopped, go_on, pieces, run

#: Sound speed in m/s at 0 degrees C, and that temperature in K: docs/conventions.md.
SPEED, ZERO = 331.3, 273.15

Responses: TypeAlias = NDArray[np.complex128]


def sizes(**requested: float) -> dict[str, float]:
    """Return the faults above 0, in the order of `FAULTS`; rejects values out of range."""
    read = {name: number(name, requested[name], least=0) for name in FAULTS}
    for name, size in read.items():
        if size > FAULTS[name].most:
            raise refused(name, size, f"give at most {FAULTS[name].most:g}")
    return {name: size for name, size in read.items() if size > 0}


def faulty(scene: Scene, faults: Mapping[str, float], seed: int, trial: int) -> Scene:
    """Return the scene with the faults of a trial. Each fault has random numbers of its own."""
    for index, (name, fault) in enumerate(FAULTS.items()):
        if name in faults:
            random = np.random.default_rng([seed, trial, index])
            scene = fault.draw(scene, faults[name], random)
    return scene


def _responses(scene: Scene, factors: NDArray[np.float64] | Responses) -> Scene:
    array = scene.array
    own = 1.0 if array.response is None else array.response
    return _changed(scene, response=np.asarray(own * factors, complex))


def _changed(scene: Scene, **parts: Any) -> Scene:
    return scene.replace(array=changed(scene.array, quantization=None, **parts))


def _phase(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    angles = np.radians(size) * random.standard_normal(len(scene.array))
    return _responses(scene, np.exp(1j * angles))


def _gain(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    return _responses(scene, np.maximum(1 + size * random.standard_normal(len(scene.array)), 0))


def _dead(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    return _responses(scene, np.where(random.random(len(scene.array)) < size, 0.0, 1.0))


def _reversed(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    return _responses(scene, np.where(random.random(len(scene.array)) < size, -1.0, 1.0))


def _temperature(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    # The error is applied to the absolute temperature, which is proportional to the square of the sound
    # speed.
    believed = ZERO * (scene.sound_speed / SPEED) ** 2
    real = max(believed + size * random.standard_normal(), ZERO / 4)
    return scene.replace(sound_speed=SPEED * math.sqrt(real / ZERO))


def _tilt(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    array = scene.array
    axis, angle = random.standard_normal(3), np.radians(size) * random.standard_normal()
    forward = array.normals.mean(axis=0)
    if (length := np.linalg.norm(forward)) > 0.1:
        # A rotation in the array's own plane is no tilt. Boards that face each other have no such plane.
        axis -= axis @ forward * forward / length**2
    turn = rotation(angle * axis / np.linalg.norm(axis))
    middle = array.positions.mean(axis=0)
    positions = middle + (array.positions - middle) @ turn.T
    return _changed(scene, positions=positions, normals=array.normals @ turn.T)


def _position(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    array = scene.array
    moved = array.positions + size * random.standard_normal(array.positions.shape)
    return _changed(scene, positions=moved)


class Fault(NamedTuple):
    """A fault: a function that draws it at random, its largest value, and its text with the unit."""

    draw: Callable[[Scene, float, np.random.Generator], Scene]
    most: float
    unit: str


#: A fault's index is part of its random seed, so the order must not change.
FAULTS = {
    "phase": Fault(_phase, 180.0, "sd {:g} degrees"),
    "gain": Fault(_gain, 1.0, "sd {:g}"),
    "dead": Fault(_dead, 1.0, "{:g} of all"),
    "reversed": Fault(_reversed, 1.0, "{:g} of all"),
    "temperature": Fault(_temperature, 50.0, "sd {:g} K"),
    "tilt": Fault(_tilt, 45.0, "sd {:g} degrees"),
    "position": Fault(_position, 0.01, "sd {:g} m"),
}


#: Spread of the dots of one row, relative to the distance between rows.
SPREAD = 0.3


#: The panels of the picture.
Panel = Literal["level", "uniformity"]
PANELS = get_args(Panel)

#: The quantile that the table shows.
PART = 0.05

#: Name of the row with all faults together.
TOGETHER = "together"


@dataclass(frozen=True, eq=False)
class Kept:
    """Fractions of level and uniformity that remain in trials with some faults.

    Attributes
    ----------
    level, uniformity : (T,) ndarray
        Values in T trials, relative to the value without faults.

    Examples
    --------
    >>> import midair, numpy as np
    >>> midair.Kept(np.array([0.9, 1.0]), np.array([0.8, 1.0])).summary()["level"]
    0.95
    """

    level: NDArray[np.float64]
    uniformity: NDArray[np.float64]

    def summary(self) -> dict[str, float]:
        """Return mean, 5 % quantile and worst value of level and uniformity by name."""
        reported = {}
        for name, values in (("level", self.level), ("uniformity", self.uniformity)):
            reported[name] = float(values.mean())
            reported[f"{name}_5"] = float(np.quantile(values, PART))
            reported[f"{name}_worst"] = float(values.min())
        return reported


@dataclass(frozen=True, eq=False, repr=False)
class Tolerance:
    """Fractions of level and uniformity that remain with each fault, from `midair.tolerate`.

    Prints as a table; `["phase"]` is a row.

    Attributes
    ----------
    solution : midair.Solution or None
        The solution that is played; None if only a drive was given.
    faults : mapping of str to float
        Sizes of the faults by name, those above 0.
    rows : mapping of str to midair.Kept
        For each fault, and "together" for all of them if there are several: the results of its trials.
    status : str
        "done", or "stopped" if there are fewer trials than requested.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> midair.tolerate(scene, phase=20, gain=0.1, trials=20).trials
    20
    """

    solution: Solution | None
    faults: Mapping[str, float]
    rows: Mapping[str, Kept]
    status: str

    @property
    def trials(self) -> int:
        """Number of trials of each row."""
        return len(next(iter(self.rows.values())).level)

    def _size(self, name: str) -> str:
        """Return the size of a row's fault with its unit; "" for the row of all faults."""
        return FAULTS[name].unit.format(self.faults[name]) if name in FAULTS else ""

    def to_dict(self) -> dict[str, list[Any]]:
        """Return the table as columns: fault, size; mean, 5 % quantile, worst of level and uniformity."""
        table: dict[str, list[Any]] = {
            "fault": list(self.rows),
            "size": [self.faults.get(name) for name in self.rows],
        }
        for row in self.rows.values():
            for name, value in row.summary().items():
                table.setdefault(name, []).append(value)
        return table

    def cells(self) -> dict[str, list[str]]:
        """Return the table as text: the fractions of level and uniformity that remain."""
        table = {"fault": list(self.rows)}
        table["size"] = [self._size(name) for name in self.rows]
        reported = [row.summary() for row in self.rows.values()]
        for name in reported[0]:
            head = name.replace("_5", " 5 %").replace("_", " ")
            table[head] = [f"{row[name]:.4f}" for row in reported]
        return table

    def plot(
        self, ax: Axes | None = None, *, panels: Panel | Iterable[Panel] | None = None, size: Size | None = None
    ) -> Figure:
        """Draw every trial's level and uniformity, with a row for each fault.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        panels : {"level", "uniformity"} or list of them, optional
            The panels to draw; by default both.
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
        from .._pictures.figures import head, row as panels_in_a_row

        rows = list(self.rows)
        height = 1.8 + 0.5 * len(rows)
        figure, axes = panels_in_a_row(panels, PANELS, ax, size, width=4.5, height=height, sharey=True)
        aside = SPREAD * np.random.default_rng(0).uniform(-1, 1, self.trials)
        for what, one in axes.items():
            for row, name in enumerate(rows):
                values = getattr(self.rows[name], what)
                worse = np.quantile(values, PART)
                one.scatter(values, row + aside, s=6, alpha=0.35, linewidths=0, color="tab:blue")
                ends = row - 0.4, row + 0.4
                one.vlines(values.mean(), *ends, color="black", label="" if row else "mean")
                one.vlines(worse, *ends, color="tab:red", label="" if row else f"{PART:.0%} are worse")
            one.set(xlabel=f"{what} kept")
            one.axvline(1, color="lightgrey", zorder=0)
            one.grid(axis="x", alpha=0.3)
        labels = ["\n".join(filter(None, (name, self._size(name)))) for name in rows]
        first = next(iter(axes.values()))
        first.set_yticks(range(len(rows)), labels)
        first.invert_yaxis()
        if ax is not None:
            ax.legend()
            return figure
        figure.legend(*first.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        played = "a drive" if self.solution is None else self.solution.solver
        head(figure, f"{played}, {self.trials} trials a row")
        return figure

    def __repr__(self) -> str:
        return f"{columns.plain(self.cells())}\n{self.heading}"

    def _repr_html_(self) -> str:
        return columns.html(self.cells(), self.heading)

    @property
    def sentence(self) -> str:
        """Level and uniformity that 95 % of the trials keep, in one sentence."""
        name = TOGETHER if TOGETHER in self.rows else next(iter(self.rows))
        reported = self.rows[name].summary()
        faults = "all faults together" if name == TOGETHER else f"{name} alone"
        return (
            f"{faults}: {1 - PART:.0%} of the trials keep {reported['level_5']:.1%} of the level or more, "
            f"and {reported['uniformity_5']:.1%} of the uniformity"
        )

    @property
    def heading(self) -> str:
        """Meaning of the table's numbers, and the number of trials."""
        stopped = ", stopped" if self.status == "stopped" else ""
        return f"parts kept of level and uniformity, {self.trials} trials a row{stopped}"

    def __getitem__(self, name: str) -> Kept:
        if name not in self.rows:
            raise KeyError(f'no fault is named "{name}": there are {", ".join(self.rows)}')
        return self.rows[name]


#: Largest number of trials. They take hours, and means and quantiles then have a statistical error of only a
#: thousandth of the spread.
MOST_TRIALS = 1_000_000

#: Trials per job: few, so that a stop loses little work.
SIZE = 10


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
    given = locals()
    callback(progress, "trials done, trials")
    faults = {name: given[name] for name in FAULTS}
    found = Trials(scene, solver, drive=drive, faults=faults, trials=trials, seed=seed, options=options)
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
            raise TypeError(f"expected a midair.Scene or a midair.Solution first, not {type(scene).__qualname__}")
        known = sizes(**faults)
        if not known:
            raise _faultless(faults, options)
        self._trials = whole("trials", trials, least=1)
        if self._trials > MOST_TRIALS:
            raise refused("trials", trials, f"give at most {MOST_TRIALS}")
        seed = whole("seed", seed, least=0)
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
        self._solution = drive if isinstance(drive, Solution) else None
        drive = drive.drive if isinstance(drive, Solution) else drive
        drive = numbers("drive", drive, [(len(scene.array),)], "give a drive (N,)", kinds="iufc")
        # No files are written, so the settings need not be JSON.
        self._settings: dict[str, Any] = {
            "scene": scene,
            "drive": drive,
            "targets": targets,
            "faults": known,
            "seed": seed,
        }
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
        jobs = pieces(trials_of, self._settings, self._trials, SIZE)

        def receive(job: Job, arrays: Arrays) -> None:
            self._done.append(arrays)
            if progress is not None and progress(job.stop, self._trials) is False:
                raise Stopped

        with suppress(Stopped):
            run(jobs, receive, threads=threads, scheduler=scheduler)

    def table(self) -> Tolerance | None:
        """Return the table of the trials that are done; None if there are none."""
        if not self._done:
            return None
        faults = self._settings["faults"]
        parts = {name: [arrays[name] for arrays in self._done] for name in groups(faults)}
        rows = {name: Kept(*np.concatenate(part).T) for name, part in parts.items()}
        found = Tolerance(self._solution, faults, rows, "done")
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
        except _midair.SceneError as error:
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
