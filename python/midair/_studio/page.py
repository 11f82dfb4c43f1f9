"""Conversion of scenes to the studio page's JSON, and back."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .._midair import (
    Array,
    Mesh,
    Plane,
    Scene,
    SceneError,
    Solution,
    Solver,
    Sphere,
    Wall,
    array_parts,
    solvers,
)
from .._support import output
from .._support.arguments import warn

#: Folder of the built files of the page.
BUILT = Path(__file__).with_name("built")


def file(name: str, folder: Path = BUILT) -> Path:
    """Return the path of a file of the page. Raises SceneError if the page was not built."""
    path = folder / name
    if not path.is_file():
        raise SceneError(f"the studio's {name} is not built: run `make studio` in a clone of midair")
    return path


#: Largest number of points that the page accepts.
MOST_POINTS = 64

#: The page's frequency in Hz.
FREQUENCY = 40e3


def greeting(array: Array) -> Scene:
    """Return the studio's first scene: three foci over an array or between boards, and a vertical slice."""
    x, y, _ = array.positions.mean(axis=0)
    low, high = array.positions[:, 2].min(), array.positions[:, 2].max()
    z = (low + high) / 2 if high - low > 0.05 else high + 0.13
    places = [[x - 0.03, y, z], [x + 0.03, y, z], [x, y, z + 0.03]]
    return Scene(array, places, frequency=FREQUENCY).replace(
        plane=Plane(axis="y", at=y, size=0.2, center=(x, z))
    )


def scene_text(what: Scene | Solution) -> str:
    """Return a scene, or a solution's scene and solver, as JSON text for the page.

    Raises SceneError for content that the page cannot show; warns if the page will solve it differently.
    """
    scene = what.scene if isinstance(what, Solution) else what
    if scene is None:
        raise SceneError("solution is of a matrix: the studio shows scenes, give one with a midair.Scene")
    document = json.loads(scene.json())
    if isinstance(what, Solution) and what.solver in solvers():
        document["solver"] = {"name": what.solver}
    unknown = next(_unknown(scene, document["array"]), None)
    if unknown is not None:
        cure = "leave it out (docs/studio.md says what it knows)"
        raise SceneError(f"the studio has no place for {unknown}: {cure}")
    for item in _passed_over(what):
        warn(f"the studio does not know {item}: its own are taken")
    return json.dumps(document)


def shown_scene(state: dict[str, Any]) -> Scene:
    """Return the scene of a page's State (studio/src/state/types.ts), with its method A as the solver."""
    array, pressures = state["array"], state["pressures"]
    named = ("preset", "tiles") if "preset" in array else ("positions", "normals")
    document = {
        "medium": {name: state.get(name) for name in ("temperature", "absorption", "density")},
        "array": {name: array[name] for name in named},
        "points": [
            {"position": point} | ({} if pressures is None else {"pressure": pressures[k]})
            for k, point in enumerate(state["points"])
        ],
        "solver": {"name": state["methods"][0]},
        "plane": _plane(state["plane"]),
        "obstacles": state["obstacles"],
    }
    if state["quantization"] == "none":
        document["array"]["quantization"] = {}
    if state["signature"]:
        names = state["signature"].split(".")
        document["signature"] = names if len(names) > 1 else names[0]
    return Scene.parse(json.dumps(document), name="the studio's scene")


def _plane(slice_: dict[str, Any]) -> dict[str, Any]:
    """Return the page's slice as the plane of a scene file, with its centre along the plane's two axes."""
    axis, middle = slice_["axis"], dict(zip("xyz", (*slice_["center"], slice_["z"]), strict=True))
    across = [middle[other] for other in "xyz" if other != axis]
    return {"axis": axis, "at": middle[axis], "size": slice_["size"], "center": across}


def _unknown(scene: Scene, written: dict[str, Any]) -> Iterator[str]:
    """Yield the parts of a scene that the page cannot show; `written` is its array as in a scene file."""
    if scene.frequency != FREQUENCY:
        yield f"frequency = {scene.frequency:g} (its own is {FREQUENCY:g})"
    if "preset" in written:
        plain = Array.preset(written["preset"], tuple(written["tiles"]) if "tiles" in written else None)
    else:
        plain = Array(scene.array.positions, scene.array.normals)
    own = json.loads(scene.replace(array=plain).json())["array"]
    for name in array_parts():
        if (value := written.get(name)) and value != (its := own.get(name)):
            yield f"the array's {name}" + ("" if its is None else f" {value} (its own is {its})")
    if len(scene.points) > MOST_POINTS:
        yield f"{len(scene.points)} points (it takes {MOST_POINTS})"
    if scene.weights is not None and (scene.weights != 1).any():
        yield "weights"
    if scene.pressures is not None and np.iscomplexobj(scene.pressures):
        yield "phases of pressures"
    for obstacle in scene.obstacles:
        if not isinstance(obstacle, Wall | Sphere):
            yield "meshes" if isinstance(obstacle, Mesh) else f"a {type(obstacle).__name__.lower()}"


def _passed_over(what: Scene | Solution) -> Iterator[str]:
    """Yield the parts of a scene or solution that the page ignores."""
    if isinstance(what, Solution):
        if what.solver not in solvers():
            yield f"the solver {what.solver}"
        elif _has_options(what):
            yield f"the options of {what.solver}"
    elif what.solver is not None and what.solver[1]:
        yield f"the options of {what.solver[0]}"


def _has_options(solution: Solution) -> bool:
    """Return whether a solution's solver has options other than the defaults."""
    assert solution.scene is not None
    scene = solution.scene
    usual = Solver(scene.array, solution.solver).options
    if solvers()[solution.solver].uses_aim:
        usual = {"aim": "max" if scene.pressures is None else "target", **usual}
    # Options may be arrays, so they are compared as JSON.
    alike: bool = json.loads(output.to_json(usual)) == json.loads(output.to_json(solution.options))
    return not alike
