"""Scenes for the studio page: the files of the page, and the keys of a scene that it has."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .._midair import Array, Plane, Scene, Solution, solvers, stated
from .._support import output
from .._support.arguments import warn

#: Folder of the built files of the page.
BUILT = Path(__file__).with_name("built")


def file(name: str, folder: Path = BUILT) -> Path:
    """Return the path of a file of the page. Raises SceneError if the page was not built."""
    path = folder / name
    if not path.is_file():
        raise stated(f"the studio's {name}", "is not built", "run `make studio` in a clone of midair")
    return path


#: The keys of a scene that the page has, as `misfits` of studio/src/state/scene_file.ts reads them.
KEYS: dict[str, Any] = json.loads(Path(__file__).with_name("keys.json").read_text(encoding="utf-8"))


def greeting(array: Array) -> Scene:
    """Return the studio's first scene: three foci over an array or between boards, and a vertical slice."""
    x, y, _ = array.positions.mean(axis=0)
    low, high = array.positions[:, 2].min(), array.positions[:, 2].max()
    z = (low + high) / 2 if high - low > 0.05 else high + 0.13
    places = [[x - 0.03, y, z], [x + 0.03, y, z], [x, y, z + 0.03]]
    return Scene(array, places, frequency=KEYS["medium"]["frequency"]).replace(
        plane=Plane(axis="y", at=y, size=0.2, center=(x, z))
    )


def scene_text(what: Scene | Solution) -> str:
    """Return a scene, or a solution's scene and solver, as JSON text for the page.

    Raises SceneError for content that the page does not have; warns if the page does not know the solver.
    """
    scene = what.scene if isinstance(what, Solution) else what
    if scene is None:
        raise stated("solution", "is of a matrix", "the studio shows scenes, give one with a midair.Scene")
    document = json.loads(scene.json())
    if isinstance(what, Solution) and what.solver in solvers():
        document["solver"] = {**json.loads(output.to_json(what.options)), "name": what.solver}
    elif isinstance(what, Solution):
        warn(f"the studio does not know the solver {what.solver}: its own are taken")
    for line in misfits(document, KEYS):
        raise stated("", f"{line} (docs/studio.md says what the studio has)", "", code="unreadable")
    return json.dumps(document)


def misfits(value: Any, known: Any, path: str = "") -> Iterator[str]:
    """Yield what a scene has and the page has not.

    `known` are the keys of the page: True for any value; another value for this value only; a table for a
    table with these keys; or, for a list, its largest length and the keys of each item.
    """
    if isinstance(known, dict):
        for key, item in value.items():
            yield from misfits(item, known.get(key), f"{path}.{key}" if path else key)
    elif isinstance(known, list):
        if len(value) > known[0]:
            yield f"{path} is {len(value)}: the page has at most {known[0]}"
        for k, item in enumerate(value):
            yield from misfits(item, known[1], f"{path}[{k}]")
    elif known is None or (known is not True and value != known):
        own = "no place for it" if known is None else f"{known:g}"
        yield f"{path} is {json.dumps(value)[:40]}: the page has {own}"
