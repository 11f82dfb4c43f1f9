"""Reproduces the figures of Suzuki et al. 2021: pictures, tables, and verdicts on the paper's statements."""

import tempfile
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure as Picture

from .._midair import stated, unknown_name
from .._support.cache import locked
from .._support.output import refusing
from . import fig2, fig3, fig5, fig7, scenes, tables
from .tables import Found, Run, Tell, Verdict, silent


class Figure(NamedTuple):
    """Functions that compute a figure's numbers, draw them, and check the paper's statements."""

    collect: Callable[[Run], Found]
    draw: Callable[[Found], Picture]
    judge: Callable[[tables.Rows], list[Verdict]]


FIGURES = {
    "fig2": Figure(fig2.collect, fig2.draw, fig2.judge),
    "fig3": Figure(
        partial(fig3.collect, metric="accuracy"),
        partial(fig3.draw, label="accuracy, eq. (12)"),
        fig3.judge_accuracy,
    ),
    "fig4": Figure(
        partial(fig3.collect, metric="sigma"),
        # The sigmas differ by orders of magnitude.
        partial(fig3.draw, label="deviation sigma, eq. (13) with 1/M", scale="log"),
        fig3.judge_deviation,
    ),
    "fig5": Figure(partial(fig5.collect, over="M"), partial(fig5.draw, over="M"), fig5.judge_points),
    "fig6": Figure(partial(fig5.collect, over="N"), partial(fig5.draw, over="N"), fig5.judge_transducers),
    "fig7": Figure(fig7.collect, fig7.draw, fig7.judge),
}


def reproduce(
    figures: Sequence[str],
    output: Path,
    *,
    trials: int = 1000,
    seed: int = 0,
    scheduler: str | None = None,
    progress: Callable[[str], AbstractContextManager[Tell]] = lambda figure: nullcontext(silent),
) -> list[tuple[str, Verdict]]:
    """Write NAME.png, NAME.svg and NAME.csv for each figure, and verdicts.csv, into the folder `output`.

    Parameters
    ----------
    figures
        Names in FIGURES, or "all".
    trials
        Number of random scenes of figs. 3 and 4, and of random orders of fig. 7. Timing takes at most 15
        rounds.
    scheduler
        Address of a Dask scheduler for all random trials; single scenes and timing run on this machine.
    progress
        Called with the name of each figure; returns a context manager that yields a function of (items done,
        items).

    Returns
    -------
    list of (str, Verdict)
        The verdicts, each with the name of its figure. Finished parts are stored in `output`/.chunks, from
        which a stopped run continues.
    """
    names = [name for requested in figures for name in (FIGURES if requested == "all" else [requested])]
    for name in names:
        if name not in FIGURES:
            raise unknown_name("figure", name, [*FIGURES, "all"])
    if trials < 1:
        raise stated("trials", f"is {trials}", "give 1 or more")
    if not 0 <= seed < 2**63:
        raise stated("seed", f"is {seed}", "give 0 to 2^63 - 1")
    # An output that cannot be written is refused before any work.
    with refusing(f'output "{output}"', "choose another"):
        output.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=output):
            pass
    verdicts: list[tuple[str, Verdict]] = []
    chunks = output / ".chunks"
    with locked(chunks):
        for name in dict.fromkeys(names):
            with progress(name) as tell:
                judged = _figure(name, Run(trials, seed, chunks, scheduler, tell), output)
            verdicts += [(name, verdict) for verdict in judged]
    tables.write(output / "verdicts.csv", [{"figure": name, **one._asdict()} for name, one in verdicts])
    return verdicts


def _figure(name: str, run: Run, output: Path) -> list[Verdict]:
    """Make the numbers, picture and verdicts of a figure.

    Picture and verdicts use the rounded numbers of the written file.
    """
    figure, path = FIGURES[name], output / f"{name}.csv"
    rows, fields = figure.collect(run)
    tables.write(path, rows)
    if fields:
        tables.write(output / f"{name}-fields.csv", scenes.pixels(fields))
    found = Found(tables.read(path), fields)
    scenes.save(figure.draw(found), output, name)
    return figure.judge(found.rows)
