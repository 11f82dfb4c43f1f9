"""`midair sweep`: every problem of a sweep file, as one table of metrics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .progress import progress_bar
from .tables import print_written


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
    from ..sweep import work
    from ..sweep.request import read

    asked = read(request, drives=drives is not None)
    with progress_bar("sweeping") as tell:
        work(asked, output_file, drives, scheduler=scheduler, progress=tell)
    files = f"{output_file}" if drives is None else f"{output_file} and {drives}"
    print_written(f"{asked.problems} rows to {files}")
    return 0
