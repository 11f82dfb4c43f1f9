"""`midair reproduce`: the figures of the paper made anew, and a table of verdicts on its statements."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich import box
from rich.table import Table

from .progress import progress_bar
from .tables import console


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
    from ..reproduce import reproduce

    names = figures or ("all",)
    verdicts = reproduce(
        names, output_folder, trials=trials, seed=seed, scheduler=scheduler, progress=progress_bar
    )
    table = Table("figure", "statement", "verdict", "what decides", box=box.SIMPLE_HEAD, pad_edge=False)
    for verdict in verdicts:
        table.add_row(verdict.figure, verdict.statement, verdict.verdict, verdict.evidence)
    console.print(table)
    return 0
