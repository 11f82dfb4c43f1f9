"""The command line: `midair solve | compare | solvers | presets | reproduce | sweep`."""

from __future__ import annotations

import io
import json
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

import numpy as np
from cyclopts import App, CycloptsError, Parameter
from rich import box
from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from . import (
    Scene,
    SceneError,
    SceneWarning,
    Solution,
    __version__,
    bound,
    field,
    output,
    presets,
    solve,
    solvers,
)
from .ctrl_c import interruptible
from .plot import contact_sheet, picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

app = App(
    name="midair",
    help="Drives for airborne ultrasound phased arrays: given points in the air feel given pressures.",
    version=__version__,
    # It is `main` that tells of an interruption.
    suppress_keyboard_interrupt=False,
)
# A pipe has no width of its own; tables keep theirs.
console = Console() if sys.stdout.isatty() else Console(width=120)

#: The most points that `midair.bound` takes.
BOUND_POINTS = 64

#: Exit status of a request that cannot be answered, and of Ctrl-C (128 + SIGINT).
REFUSED, INTERRUPTED = 2, 130


@app.command(name="solve")
def solve_command(
    scene: Path,
    *,
    solver: str | None = None,
    output_file: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    image: Path | None = None,
    balance: bool | None = None,
    aim: Literal["target", "max"] | None = None,
    **options: str,
) -> int:
    """Find a drive for a scene file, judge it, and write what is asked for.

    Any option of the solver is an option here (`midair solvers` lists them): --phases 16 --seed 1.

    Parameters
    ----------
    scene
        Scene file, TOML or JSON.
    solver
        Name of the solver; left out, the scene file's, else the default.
    output_file
        Where the drive goes: .npz, .csv or .json. Left out, nothing is written.
    image
        Where a picture of the field goes: .png, .svg, .pdf or .jpg.
    balance
        Solve at the level the array can reach and reduce the drives afterwards.
    aim
        "target" for as loud as asked, "max" for as loud as the array can, for the solvers that use one.
    options
        Options of the solver, as --name value.
    """
    request = Scene.load(scene)
    if output_file is not None:
        output.check(output_file, output.DRIVES)
    if image is not None:
        output.check(image, output.IMAGES)
    with _progress("solving") as tell, interruptible() as interrupted:

        def watch(step: int, steps: int, residual: float) -> bool:
            tell(step, steps)
            return not interrupted()

        solution = solve(request, solver, balance=balance, aim=aim, progress=watch, **_values(options))
    _print_table([solution])
    if output_file is not None:
        output.write_drive(output_file, request, solution)
        console.print(f"wrote {output_file}", markup=False, emoji=False, highlight=False, soft_wrap=True)
    if solution.status == "stopped":
        print("stopped: what was found so far is above", file=sys.stderr)
        return INTERRUPTED
    if image is not None:
        with _progress("drawing"):
            drawn = picture(field(request, solution.drive), _title(solution))
            _write_image(image, drawn)
    return 0


@app.command(name="compare")
def compare_command(
    scene: Path, *, solvers: str = "all", image: Path | None = None, balance: bool | None = None
) -> int:
    """Solve a scene file by several methods: a table, and a picture with a panel for each on one scale.

    The column "gap" tells how far the weakest point stays below a level that no drive exceeds
    (`midair.bound`, up to 64 points).

    Parameters
    ----------
    scene
        Scene file, TOML or JSON. Its solver options hold for its solver.
    solvers
        Names separated by commas, or "all".
    image
        Where the contact sheet of fields goes: .png, .svg, .pdf or .jpg.
    balance
        Balance for every method, or (--no-balance) for none; left out, each method's own habit.
    """
    request = Scene.load(scene)
    if image is not None:
        output.check(image, output.IMAGES)
    names = _names(solvers)
    solutions, fields = [], []
    most = None
    try:
        with _progress("comparing") as tell:
            most = _bound(request)
            for done, name in enumerate(names):
                solutions.append(solve(request, name, balance=balance))
                if image is not None:
                    fields.append(field(request, solutions[-1].drive))
                tell(done + 1, len(names))
            if image is not None:
                _write_image(image, contact_sheet(fields, [_title(solution) for solution in solutions]))
    finally:
        # What was solved before an interruption is worth its line.
        if solutions:
            gaps = None if most is None else [_gap(one, most, request.weights) for one in solutions]
            _print_table(solutions, gaps)
    return 0


@app.command(name="solvers")
def solvers_command() -> int:
    """List the solvers with their options and defaults."""
    table = Table("solver", "option", "default", "what it does", box=box.SIMPLE_HEAD)
    for name, info in solvers().items():
        table.add_row(f"[bold]{name}[/bold]", "", "", f"{info.summary} ({info.source})")
        for option, about in info.options.items():
            table.add_row("", option, str(about.default), about.doc)
        table.add_row(
            "", "balance", str(info.balance), "Solve at the balanced level, reduce the drives afterwards."
        )
    console.print(table)
    return 0


@app.command(name="presets")
def presets_command() -> int:
    """List the arrays known by name."""
    table = Table("preset", "transducers", "tiles", "P0 / Pa m", "what it is", "source", box=box.SIMPLE_HEAD)
    for name, info in presets().items():
        tiles = "yes" if info.tiles else "no"
        table.add_row(
            f"[bold]{name}[/bold]",
            str(info.count),
            tiles,
            f"{info.source_pressure:g}",
            info.summary,
            info.source,
        )
    console.print(table)
    return 0


@app.command(name="reproduce")
def reproduce_command(
    *figures: str,
    trials: int = 1000,
    seed: int = 0,
    output_folder: Annotated[Path, Parameter(name=["--output", "-o"])] = Path("reproduced"),
    scheduler: str | None = None,
) -> int:
    """Make the figures of Suzuki et al. 2021 anew, with the numbers behind them, and judge its statements.

    Stopped and started again, it goes on where it was.

    Parameters
    ----------
    figures
        fig2, fig3, fig4, fig5, fig6, fig7; left out, or "all": every one.
    trials
        Random scenes for each number of points.
    seed
        Seed of all that is random.
    output_folder
        Where the pictures, tables and verdicts.csv go.
    scheduler
        Address of a Dask scheduler, tcp://host:port; left out, this machine works.
    """
    from .reproduce import reproduce

    names = figures or ("all",)
    verdicts = reproduce(
        names, output_folder, trials=trials, seed=seed, scheduler=scheduler, progress=_progress
    )
    table = Table("figure", "statement", "verdict", "what decides", box=box.SIMPLE_HEAD, pad_edge=False)
    for verdict in verdicts:
        table.add_row(verdict.figure, verdict.statement, verdict.verdict, verdict.evidence)
    console.print(table)
    return 0


@app.command(name="sweep")
def sweep_command(
    request: Path,
    *,
    output_file: Annotated[Path, Parameter(name=["--output", "-o"])],
    drives: Path | None = None,
    scheduler: str | None = None,
) -> int:
    """Solve every problem of a sweep file; one table of their metrics.

    Stopped and started again, it goes on where it was.

    Parameters
    ----------
    request
        Sweep file, TOML or JSON: docs/sweeps.md.
    output_file
        Where the table goes: .csv or .parquet.
    drives
        Where the drives go: a Zarr group, a folder ending in .zarr.
    scheduler
        Address of a Dask scheduler, tcp://host:port; left out, this machine works.
    """
    from .sweep import work
    from .sweep.request import read

    asked = read(request, drives=drives is not None)
    with _progress("sweeping") as tell:
        work(asked, output_file, drives, scheduler=scheduler, progress=tell)
    files = f"{output_file}" + ("" if drives is None else f" and {drives}")
    told = f"wrote {asked.problems} rows to {files}"
    console.print(told, markup=False, emoji=False, highlight=False, soft_wrap=True)
    return 0


def _names(solver_list: str) -> list[str]:
    known = list(solvers())
    names = known if solver_list == "all" else [name.strip() for name in solver_list.split(",")]
    for name in names:
        if name not in known:
            raise SceneError(f'unknown solver "{name}": known are {", ".join(known)}')
    return names


def _values(options: dict[str, str]) -> dict[str, Any]:
    """Options as typed: 16, true and [1, 0] are what they look like, anything else is a word."""
    values: dict[str, Any] = {}
    for name, text in options.items():
        key = name.replace("-", "_")
        if key in {"pressures", "weights", "start", "progress", "trace"}:
            raise SceneError(
                f"--{name} is no option of the command line: put it into the scene file or use Python"
            )
        try:
            value = json.loads(text)
        except (ValueError, RecursionError):
            value = None
        # null is no value of any option: it stays a word, and is refused as one.
        values[key] = text if value is None else value
    return values


def _title(solution: Solution) -> str:
    options = solution.options
    told = (
        key for key in ("phases", "amplitudes", "order", "limit") if isinstance(options.get(key), str | int)
    )
    return ", ".join([solution.solver, *(f"{key}={options[key]}" for key in told)])


def _print_table(solutions: Sequence[Solution], gaps: Sequence[float] | None = None) -> None:
    """Metrics side by side; the leak only where there are quiet points, the gap where it is known."""
    names = ["accuracy", "sigma", "uniformity", "level", "residual"]
    if any(solution.metrics.leak > 0 for solution in solutions):
        names.append("leak")
    known = [] if gaps is None else ["gap"]
    table = Table(
        "solver", *names, *known, "limit", "steps", "time", "status", box=box.SIMPLE_HEAD, pad_edge=False
    )
    for k, solution in enumerate(solutions):
        numbers = [f"{getattr(solution.metrics, name):.4f}" for name in names]
        numbers += [] if gaps is None else [f"{gaps[k]:.1%}"]
        limit = str(solution.options.get("limit", "-"))
        time = _duration(solution.elapsed)
        status = solution.status if solution.scale == 1 else f"{solution.status}, scale {solution.scale:.3g}"
        table.add_row(solution.solver, *numbers, limit, str(solution.steps), time, status)
    console.print(table)


def _bound(scene: Scene) -> float | None:
    """The level that no drive exceeds, or None where it would take too long to know."""
    wanted = np.ones(len(scene.points), dtype=bool)
    for given in (scene.pressures, scene.weights):
        wanted &= True if given is None else given > 0
    return bound(scene) if wanted.sum() <= BOUND_POINTS else None


def _gap(solution: Solution, most: float, weights: NDArray[np.float64] | None) -> float:
    """How far a solution's weakest point stays below that level, relative to it."""
    heard = (solution.targets > 0) & (True if weights is None else weights > 0)
    weakest = np.min(np.abs(solution.pressures[heard]) / solution.targets[heard])
    return float(1 - weakest / most)


def _duration(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 1 else f"{seconds * 1e3:.2f} ms"


def _write_image(path: Path, figure: Figure) -> None:
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=150)
    output.write(path, content.getvalue())


@contextmanager
def _progress(doing: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar for whatever takes over a second; the block calls what it gets with (step, steps)."""
    columns = (SpinnerColumn(), TextColumn(doing), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    terminal = Console(stderr=True)
    # Elsewhere even a bar that leaves nothing behind leaves an empty line.
    bar = Progress(*columns, console=terminal, transient=True, disable=not terminal.is_terminal)
    task = bar.add_task(doing, total=None)
    began = time.monotonic()
    shown = began

    def tell(step: int, steps: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - began > 1 and now - shown > 0.1:
            shown = now
            bar.start()
            bar.update(task, completed=step, total=steps)

    try:
        yield tell
    finally:
        # A bar that was never shown would still end its line.
        if bar.live.is_started:
            bar.stop()


def _one_line(error: BaseException) -> str:
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and leave with its status: 0, 2 for a request refused, 130 for Ctrl-C."""
    warnings.showwarning = lambda message, *_: print(f"warning: {message}", file=sys.stderr)
    warnings.simplefilter("always", SceneWarning)
    try:
        status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except (SceneError, OSError, CycloptsError) as error:
        print(f"error: {_one_line(error)}", file=sys.stderr)
        sys.exit(REFUSED)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
    sys.exit(status if isinstance(status, int) else 0)
