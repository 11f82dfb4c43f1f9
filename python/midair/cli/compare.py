"""`midair compare`: one scene by several solvers, as a table and a sheet of pictures."""

from __future__ import annotations

from pathlib import Path

from .. import Scene, output
from ..compare import choices, growing
from .images import write_image
from .progress import progress_bar
from .tables import print_solutions


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
    names = None if solvers == "all" else [name.strip() for name in solvers.split(",")]
    count = len(choices(request, names))
    table = None
    try:
        with progress_bar("comparing") as tell:
            for table in growing(request, names, balance=balance):
                tell(len(table), count)
            if image is not None and table is not None:
                write_image(image, table.plot())
    finally:
        # What was solved before an interruption is worth its line.
        if table is not None:
            print_solutions(table.solutions, table.names, table.gaps)
    return 0
