"""`midair solve`: one scene by one solver, its metrics, its drive as a file and a picture of its field."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from .. import Scene, SceneError, field, output, solve
from ..ctrl_c import interruptible
from ..plot import picture
from .images import title, write_image
from .progress import progress_bar
from .status import INTERRUPTED
from .tables import print_solutions, print_written


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
    with progress_bar("solving") as tell, interruptible() as interrupted:

        def watch(step: int, steps: int, residual: float) -> bool:
            tell(step, steps)
            return not interrupted()

        solution = solve(request, solver, balance=balance, aim=aim, progress=watch, **_values(options))
    print_solutions([solution])
    if output_file is not None:
        output.write_drive(output_file, request, solution)
        print_written(output_file)
    if solution.status == "stopped":
        print("stopped: what was found so far is above", file=sys.stderr)
        return INTERRUPTED
    if image is not None:
        with progress_bar("drawing"):
            drawn = picture(field(request, solution.drive), title(solution))
            write_image(image, drawn)
    return 0


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
