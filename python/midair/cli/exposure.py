"""`midair exposure`: sound pressure levels at places and in boxes, beside a limit and its source."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import SceneError, exposure, output, solve
from .progress import progress_bar
from .scene import SceneFile, numbers
from .tables import console, print_columns


def exposure_command(
    scene: Path,
    *,
    at: Annotated[list[str] | None, Parameter(allow_leading_hyphen=True, negative=())] = None,
    box: Annotated[list[str] | None, Parameter(allow_leading_hyphen=True, negative=())] = None,
    limit: str = "howard",
    solver: str | None = None,
    json: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Solve a scene file and tell how loud it is at other places: ears, eyes.

    midair exposure scene.toml --at 0,0.1,0.5 --box=-0.1,-0.1,0.4,0.1,0.1,0.6

    Parameters
    ----------
    scene
        Scene file, TOML or JSON, or - for standard input.
    at
        A place x,y,z in m; once for each place.
    box
        Two corners x,y,z,x,y,z in m, of which the loudest place is told; once for each box.
    limit
        What the levels stand beside: howard (110 dB), acgih (115), acgih-air (145), irpa
        (100), or a level in dB.
    solver
        Name of the solver; left out, the scene file's, else the default.
    json
        Print one JSON document in place of the table.
    """
    places: dict[str, Any] = {}
    for text in at or ():
        places[text] = numbers("--at", text, 3, "three numbers in m, such as --at 0,0.1,0.5")
    for text in box or ():
        corners = numbers("--box", text, 6, "two corners in m, such as --box 0,0.1,0.5,0.03,0.13,0.53")
        places[text] = [corners[:3], corners[3:]]
    if not places:
        raise SceneError("--at is left out: give places such as --at 0,0.1,0.5, or a --box")
    request = SceneFile(scene).scene()
    with progress_bar("solving"):
        solution = solve(request, solver)
    with progress_bar("listening"):
        found = exposure(request, solution, places, limit=_limit(limit))
    if json:
        print(output.to_json({"limit": vars(found.limit), "places": found.to_dict()}))
    else:
        print_columns(found.cells())
        console.print(found.heading, highlight=False)
    return 0


def _limit(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text
