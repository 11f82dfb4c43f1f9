"""`midair.view`: the studio in a notebook; Python and the page exchange points in both directions.

Also scenes for the studio page: the files of the page, and the keys of a scene that it has.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Plane, Scene, Solution, solvers, stated
from .._support import output
from .._support.arguments import needs, warn

if TYPE_CHECKING:
    from .widget import Widget

#: Folder of the built files of the page.
BUILT = Path(__file__).with_name("built")

#: The keys of a scene that the page has, as `misfits` of studio/src/state/scene_file.ts reads them.
KEYS: dict[str, Any] = json.loads(Path(__file__).with_name("keys.json").read_text(encoding="utf-8"))


def file(name: str, folder: Path = BUILT) -> Path:
    """Return the path of a file of the page. Raises SceneError if the page was not built."""
    path = folder / name
    if not path.is_file():
        raise stated(f"the studio's {name}", "is not built", "run `make studio` in a clone of midair")
    return path


def greeting(array: Array) -> Scene:
    """Return the studio's first scene: three foci over an array or between boards, and a vertical slice."""
    x, y, _ = array.positions.mean(axis=0)
    low, high = array.positions[:, 2].min(), array.positions[:, 2].max()
    z = (low + high) / 2 if high - low > 0.05 else high + 0.13
    places = [[x - 0.03, y, z], [x + 0.03, y, z], [x, y, z + 0.03]]
    plane = Plane(axis="y", at=y, size=0.2, center=(x, z))
    return Scene(array, places, frequency=KEYS["medium"]["frequency"]).replace(plane=plane)


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


def view(what: Scene | Solution) -> View:
    """Show a scene as a picture whose points can be dragged, in a notebook. Needs anywidget.

    Parameters
    ----------
    what : midair.Scene or midair.Solution
        A solution shows its scene, with its solver as method A.

    Returns
    -------
    midair.View
        The picture. Its attributes are the points, pressures and scene as shown; new values appear at once.

    Raises
    ------
    SceneError
        For scenes with parts that the page cannot show (docs/studio.md); if anywidget is not installed.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> midair.view(scene).points.tolist()  # doctest: +SKIP
    [[0.0, 0.0, 0.15]]
    """
    if not isinstance(what, Scene | Solution):
        raise TypeError(f"expected a midair.Scene or midair.Solution, not {type(what).__qualname__}")
    return View(scene_text(what))


class View:
    """Studio in a notebook, shown as the last line of a cell; from `midair.view`.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> picture = midair.view(scene)  # doctest: +SKIP
    >>> picture.points = [[0.02, 0, 0.15]]  # doctest: +SKIP
    """

    def __init__(self, text: str, folder: Path = BUILT) -> None:
        with needs("view needs anywidget", "notebook"):
            from .widget import Widget
        page = file("widget.mjs", folder).read_text(encoding="utf-8")
        self._widget = Widget(_esm=page, wasm=file("midair.wasm", folder).read_bytes(), scene=text)
        #: The newest scene as text: the one that Python has set, or the one that the page has reported.
        self._text = text
        self._widget.observe(self._reported, "state")

    @property
    def widget(self) -> Widget:
        """Underlying anywidget, for layouts, `observe(function, "state")` and `close()`."""
        return self._widget

    @property
    def scene(self) -> Scene:
        """Scene that is shown now, with method A as its solver. Setting it shows another scene."""
        return Scene.parse(self._text, name="the studio's scene")

    @scene.setter
    def scene(self, scene: Scene) -> None:
        text = scene_text(scene)
        # The page reacts only to a different text. Its points may have been dragged since it got this text,
        # so a line break makes the text different.
        self._widget.scene = f"{text}\n" if text == self._widget.scene else text
        self._text = text

    @property
    def points(self) -> NDArray[np.float64]:
        """Points (M, 3) in m, as they were dragged; can be set."""
        return self.scene.points

    @points.setter
    def points(self, points: ArrayLike) -> None:
        before = self.scene
        scene = before.replace(points=points)
        plane = before.plane
        if plane is not None and _cuts(plane, before) and not _cuts(plane, scene) and len(scene.points):
            # The slice moves with its point, as it does in the page.
            at = scene.points[0, "xyz".index(plane.axis)]
            plane = Plane(None, plane.size, plane.pixels, plane.center, axis=plane.axis, at=at)
            scene = scene.replace(plane=plane)
        self.scene = scene

    @property
    def pressures(self) -> NDArray[np.float64] | None:
        """Target pressures (M,) in Pa, None for as loud as possible; can be set."""
        pressures = self.scene.pressures
        return None if pressures is None else pressures.real

    @pressures.setter
    def pressures(self, pressures: ArrayLike | None) -> None:
        self.scene = self.scene.replace(pressures=pressures)

    @property
    def methods(self) -> tuple[str, ...]:
        """Two methods that the page compares; empty before the page has started."""
        return tuple(self._widget.methods)

    @property
    def metrics(self) -> dict[str, Any]:
        """Metrics by method (accuracy, sigma, ...) from the page; empty before the page has started."""
        return dict(self._widget.metrics)

    def _reported(self, _: object) -> None:
        """Called if the page has changed its scene, or has taken the one that Python set."""
        self._text = self._widget.state

    def _repr_mimebundle_(self, **keywords: Any) -> Any:
        return self._widget._repr_mimebundle_(**keywords)

    def __repr__(self) -> str:
        return f"<midair.View of {len(self.points)} points>"


def _cuts(plane: Plane, scene: Scene) -> bool:
    """Return whether a point lies in the slice."""
    return bool(np.isclose(scene.points[:, "xyz".index(plane.axis)], plane.at).any())
