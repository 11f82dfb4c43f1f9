"""`midair compare`: one scene by several solvers, as a table and a sheet of pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .. import Scene, SceneError, Solution, bound, field, output, solve
from .. import solvers as known_solvers
from ..plot import contact_sheet
from .images import title, write_image
from .progress import progress_bar
from .tables import print_solutions

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The most points that `midair.bound` takes.
BOUND_POINTS = 64


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
        with progress_bar("comparing") as tell:
            most = _bound(request)
            for done, name in enumerate(names):
                solutions.append(solve(request, name, balance=balance))
                if image is not None:
                    fields.append(field(request, solutions[-1].drive))
                tell(done + 1, len(names))
            if image is not None:
                write_image(image, contact_sheet(fields, [title(solution) for solution in solutions]))
    finally:
        # What was solved before an interruption is worth its line.
        if solutions:
            gaps = None if most is None else [_gap(one, most, request.weights) for one in solutions]
            print_solutions(solutions, gaps)
    return 0


def _names(solver_list: str) -> list[str]:
    known = list(known_solvers())
    names = known if solver_list == "all" else [name.strip() for name in solver_list.split(",")]
    for name in names:
        if name not in known:
            raise SceneError(f'unknown solver "{name}": known are {", ".join(known)}')
    return names


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
