"""`midair sweep`: every problem of a sweep file, as one table of metrics."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich import box
from rich.table import Table

from .._support.text import counted
from .progress import progress_bar
from .tables import console, print_line, print_written


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
    from .._reproduce import reproduce

    names = figures or ("all",)
    verdicts = reproduce(
        names, output_folder, trials=trials, seed=seed, scheduler=scheduler, progress=progress_bar
    )
    table = Table("figure", "statement", "verdict", "what decides", box=box.SIMPLE_HEAD, pad_edge=False)
    for figure, verdict in verdicts:
        table.add_row(figure, *verdict)
    console.print(table)
    counts = Counter(verdict.verdict for _, verdict in verdicts)
    told = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    print_line(f"{counted(len(verdicts), 'statement')} of the paper: {told}")
    return 0


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
    from .._sweep import work
    from .._sweep.request import read

    asked = read(request, drives=drives is not None)
    with progress_bar("sweeping") as tell:
        work(asked, output_file, drives, scheduler=scheduler, progress=tell)
    files = f"{output_file}" if drives is None else f"{output_file} and {drives}"
    print_written(f"{counted(asked.problems, 'row')} to {files}")
    return 0
