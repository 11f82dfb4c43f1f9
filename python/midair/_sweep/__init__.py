"""Sweeps: arrays x points x solvers x options x seeds as one table, computed on one machine or a cluster."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, nullcontext
from os import PathLike
from typing import Any

import numpy as np

from .._support.arguments import callback, path_of, warn
from .._support.cache import Arrays, locked
from . import engine, table
from .block import solve_block
from .engine import Job, counted, pieces, run
from .problems import whole
from .request import Request, read
from .shards import Dataset, dataset
from .table import Shortfall

__all__ = ["Dataset", "dataset", "sweep", "work"]

#: Problems per job: at most seconds of work, and enough for a batch to use all vector lanes.
CHUNK = 64


def sweep(
    request: str | PathLike[str] | Mapping[str, Any],
    output: str | PathLike[str] | None = None,
    *,
    drives: str | PathLike[str] | None = None,
    scheduler: str | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, np.ndarray[Any, Any]]:
    """Solve every problem of a sweep.

    Parameters
    ----------
    request : str, path or mapping
        A sweep file (TOML or JSON, docs/sweeps.md) or a mapping of its keys. There an Array may stand for an
        array's table, a Scene for a scene file, and a function for the name of a solver, as in `midair.solve`.
        A sweep with a function that was stopped in another run begins anew.
    output : str or path, optional
        A file for the table, .csv or .parquet. A stopped sweep continues where it was.
    drives : str or path, optional
        A folder for a Zarr group of drives, points and pressures, a row for each row of the table. An old
        group is replaced if a sweep made it.
    scheduler : str, optional
        Address of a Dask scheduler, tcp://host:port; by default this machine does the work.
    threads : int, optional
        Largest number of threads; by default one per processor.
    progress : callable, optional
        Called with (problems done, problems).

    Returns
    -------
    dict of str to (rows,) ndarray
        The table by column. The numbers depend on the request alone: not on threads, workers, or an
        interruption.

    Raises
    ------
    SceneError
        For a wrong request and for files that cannot be written.

    Warns
    -----
    SceneWarning
        Once, with counts, of problems with targets beyond reach, or with weak foci unbalanced.

    See Also
    --------
    midair.dataset : drives of random scenes, for training.

    Examples
    --------
    >>> import midair
    >>> table = midair.sweep({
    ...     "array": {"preset": "paper20"},
    ...     "points": {"count": [2, 4], "x": [-0.1, 0.1], "y": [-0.1, 0.1], "z": 0.15},
    ...     "solver": [{"name": "greedy", "phases": [16, 256]}, {"name": "naive"}],
    ...     "seeds": 10,
    ... })
    >>> table["accuracy"].shape
    (60,)
    """
    parts: list[dict[str, list[Any]]] = []
    requested = read(request, drives=drives is not None)
    how: dict[str, Any] = {"scheduler": scheduler, "threads": threads, "progress": progress}
    work(requested, output, drives, receive=parts.append, **how)
    return table.as_columns(parts, requested)


def work(
    requested: Request,
    output: str | PathLike[str] | None,
    drives: str | PathLike[str] | None,
    *,
    receive: Callable[[dict[str, list[Any]]], None] = lambda columns: None,
    scheduler: str | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    chunk: int = CHUNK,
) -> None:
    """Run a sweep and pass rows to `receive` in order, `chunk` at a time, so that memory suffices."""
    places = [None if path is None else path_of(name, path) for name, path in (("output", output), ("drives", drives))]
    folder = table.check(requested, *places)
    if threads is not None:
        whole(threads, "threads", least=1)
    shortfall = Shortfall()
    callback(progress, "problems done, problems")
    first = 0

    with nullcontext() if folder is None else locked(folder):
        with ExitStack() as stack:
            write = stack.enter_context(table.open_table(places[0], requested)) if places[0] else None
            give = stack.enter_context(table.open_drives(places[1], requested)) if places[1] else None

            def take(job: Job, arrays: Arrays) -> None:
                nonlocal first
                columns = table.rows(job.owner, job, arrays, first)
                if write is not None:
                    write(columns)
                if give is not None:
                    give(arrays, first)
                receive(columns)
                shortfall.add(arrays)
                first += job.stop - job.start

            how: dict[str, Any] = {"chunks": folder, "scheduler": scheduler, "threads": threads}
            tell = counted(progress, requested.problems)
            run(_jobs(requested, chunk), take, tell=tell, fits=table.fits, **how)
        if folder is not None:
            engine.remove(folder)
    if text := shortfall.text():
        warn(text)


def _jobs(requested: Request, chunk: int) -> Iterator[Job]:
    for block in requested.blocks:
        yield from pieces(solve_block, block.settings, block.trials, chunk, block)
