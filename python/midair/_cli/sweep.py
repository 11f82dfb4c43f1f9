"""`midair sweep`, `midair reproduce` and `midair dataset`: many problems, as tables and files."""

from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter
from rich import box
from rich.table import Table

from .._midair import stated
from .._support.output import METRICS
from .._support.text import array, counted
from .._sweep import dataset, sweep, work
from .._sweep.request import read
from .given import of
from .progress import progress_bar
from .tables import console, print_columns, print_hint, print_line, print_written


@of(sweep, "scheduler")
def reproduce_command(
    *figures: str,
    trials: int = 1000,
    seed: int = 0,
    output_folder: Annotated[Path, Parameter(name=["--output", "-o"])] = Path("reproduced"),
    **keywords: Any,
) -> int:
    """Make the figures of Suzuki et al. 2021 again, with their numbers, and check the paper's statements.

    If it is stopped and started again, it continues.

    Parameters
    ----------
    figures
        fig2, fig3, fig4, fig5, fig6, fig7; by default, or for "all", every one.
    trials
        Number of random scenes for each number of points.
    seed
        Seed of all random numbers.
    output_folder
        Folder for the pictures, tables and verdicts.csv.
    """
    from .._reproduce import reproduce

    names = figures or ("all",)
    verdicts = reproduce(names, output_folder, trials=trials, seed=seed, progress=progress_bar, **keywords)
    table = Table("figure", "statement", "verdict", "what decides", box=box.SIMPLE_HEAD, pad_edge=False)
    for figure, verdict in verdicts:
        table.add_row(figure, *verdict)
    counts = Counter(verdict.verdict for _, verdict in verdicts)
    reported = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    print_line(f"{counted(len(verdicts), 'statement')} of the paper: {reported}", "bold")
    console.print(table)
    print_hint("reproduce")
    return 0


@of(sweep, "scheduler")
def sweep_command(
    request: Path,
    *,
    output_file: Annotated[Path, Parameter(name=["--output", "-o"])],
    drives: Path | None = None,
    **keywords: Any,
) -> int:
    """Solve every problem of a sweep file, and write a table of their metrics.

    If it is stopped and started again, it continues.

    Parameters
    ----------
    request
        Sweep file, TOML or JSON: docs/sweeps.md.
    output_file
        File for the table: .csv or .parquet; docs/sweeps.md explains its columns.
    drives
        Where to write the drives: a Zarr group, a folder ending in .zarr.
    """
    requested = read(request, drives=drives is not None)
    with progress_bar("sweeping") as tell:
        work(requested, output_file, drives, progress=tell, **keywords)
    files = f"{output_file}" if drives is None else f"{output_file} and {drives}"
    print_written(f"{counted(requested.problems, 'row')} to {files}")
    return 0


@of(dataset, "bounds")
@of(sweep, "scheduler")
def dataset_command(
    request: Path,
    *,
    output_folder: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    judge: Path | None = None,
    **keywords: Any,
) -> int:
    """Make a data set of random scenes and their drives, every tenth held out; or judge drives by one.

    If it is stopped and started again, it continues.

    Parameters
    ----------
    request
        Sweep file with one solver and random points: docs/sweeps.md. With --judge: the folder of a data set.
    output_folder
        Folder for the data set.
    judge
        Drives for the held-out scenes, in their order: a .npy file of complex numbers, (scenes, N).
    """
    from .. import Dataset

    if judge is None:
        if output_folder is None:
            raise stated("--output", "is missing", "give a folder for the data set", code="missing")
        with progress_bar("solving") as tell:
            made = dataset(request, output_folder, progress=tell, **keywords)
        print_written(f"{counted(made.manifest['scenes'], 'scene')} to {output_folder}, every tenth held out")
        return 0
    judged = Dataset(request).judge(drives_of(judge))
    columns = {"metric": list(METRICS)}
    for title, prefix in (("these drives", ""), ("the data set's", "reference_")):
        columns[title] = [f"{judged[prefix + name].mean():.4f}" for name in METRICS]
    words = f"means over {counted(len(judged['accuracy']), 'held-out scene')}"
    print_columns("dataset", columns, words)
    return 0


def drives_of(path: Path) -> np.ndarray[Any, Any]:
    """Return the drives of a .npy file."""
    cure = "give a .npy file of complex numbers"
    try:
        drives = array(path)
    except (OSError, ValueError) as error:
        raise stated(f'"{path}"', "cannot be read as drives", cure, code="unreadable") from error
    if drives.dtype.kind not in "fc":
        raise stated(f'"{path}"', "has no drives", cure)
    return drives
