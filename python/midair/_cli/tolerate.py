"""`midair tolerate` (effects of faults of array and air) and `midair exposure` (levels at ears and eyes)."""

from pathlib import Path
from typing import Any

from .. import exposure, solve
from .._judging.tolerate import Trials, tolerate
from .._midair import stated
from .._support import output
from .given import Json, Places, SceneFile, SceneName, SolverName, numbers, of
from .progress import progress_bar
from .tables import print_columns, print_written, write_image


def exposure_command(
    scene: SceneName,
    *,
    at: Places = None,
    box: Places = None,
    limit: str = "howard",
    solver: SolverName = None,
    json: Json = False,
) -> int:
    """Solve a scene file and print how loud it is at other places, such as ears and eyes.

    midair exposure scene.toml --at 0,0.1,0.5 --box=-0.1,-0.1,0.4,0.1,0.1,0.6

    Parameters
    ----------
    at
        A place x,y,z in m; repeat the option for each place.
    box
        Two corners x,y,z,x,y,z in m of a box, for its loudest place; repeat the option for each box.
    limit
        Limit with which the levels are compared: howard (110 dB), acgih (115), acgih-air (145), irpa (100),
        or a level in dB.
    """
    places: dict[str, Any] = {}
    for text in at or ():
        places[text] = numbers("--at", text, 3, "three numbers in m, such as --at 0,0.1,0.5")
    for text in box or ():
        corners = numbers("--box", text, 6, "two corners in m, such as --box 0,0.1,0.5,0.03,0.13,0.53")
        places[text] = [corners[:3], corners[3:]]
    if not places:
        raise stated("--at", "is left out", "give places such as --at 0,0.1,0.5, or a --box", code="missing")
    request = SceneFile(scene).scene()
    with progress_bar("solving"):
        solution = solve(request, solver)
    with progress_bar("computing levels"):
        found = exposure(request, solution, places, limit=_limit(limit))
    if json:
        print(output.to_json({"limit": found.limit._asdict(), "places": found.to_dict()}))
    else:
        print_columns("exposure", found.cells(), found.sentence, found.heading)
    return 0


def _limit(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


@of(tolerate, "phase gain dead reversed temperature tilt position trials seed scheduler")
def tolerate_command(
    scene: SceneName, *, solver: SolverName = None, image: Path | None = None, json: Json = False, **keywords: Any
) -> int:
    """Solve a scene file and play the drive with faults: how much of level and uniformity remains.

    midair tolerate scene.toml --phase 20 --dead 0.05 --temperature 5 --tilt 1

    Parameters
    ----------
    image
        Where to write a picture of all trials: .png, .svg, .pdf or .jpg.
    """
    file = SceneFile(scene)
    file.check_outputs((image, output.IMAGES))
    trials, seed, scheduler = (keywords.pop(name) for name in ("trials", "seed", "scheduler"))
    found = Trials(file.scene(), solver, faults=keywords, trials=trials, seed=seed, options={})
    try:
        with progress_bar("trying") as tell:
            found.run(scheduler=scheduler, progress=tell)
    finally:
        # After an interruption, the finished trials are still printed.
        if (table := found.table()) is not None:
            if json:
                report = {"trials": table.trials, "status": table.status, "rows": table.to_dict()}
                print(output.to_json(report))
            else:
                print_columns("tolerate", table.cells(), table.sentence, table.heading)
    if image is not None and table is not None:
        with progress_bar("drawing"):
            write_image(image, table.plot())
        if not json:
            print_written(image)
    return 0
