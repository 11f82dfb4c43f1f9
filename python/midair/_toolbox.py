"""Toolbox: methods that Python adds to the extension's classes, and functions that the extension calls.

The extension never imports the package: `midair` registers this module.
"""

from __future__ import annotations

import sys
from typing import Any, cast

from . import _midair
from ._boards.playing import play
from ._files import read_array, record
from ._judging.exposure import exposure
from ._judging.streaming import streaming
from ._judging.tolerate import tolerate
from ._midair import Array, Batch, Field, Scene, Solution
from ._motion import Sequence
from ._pictures import notebook
from ._pictures.answer import answer
from ._pictures.plot import plot
from ._points import drawn
from ._support import arguments, output

#: By class and name: `solution.exposure(places)` is `midair.exposure(solution, places)`.
METHODS: dict[type, dict[str, Any]] = {
    Array: {"_repr_html_": notebook.array, "from_file": staticmethod(read_array)},
    Batch: {"_repr_html_": notebook.batch},
    Field: {"_repr_html_": notebook.field, "plot": plot},
    Scene: {"_repr_html_": notebook.scene},
    Sequence: {"exposure": exposure},
    Solution: {
        "_repr_html_": notebook.solution,
        "exposure": exposure,
        "load": staticmethod(record.load),
        "play": play,
        "plot": answer,
        "save": record.save,
        "streaming": streaming,
        "tolerate": tolerate,
    },
}


#: Functions that the extension calls: for a scene file's tables, for a mesh's file, to write and to warn.
points, mesh, mesh_file, write, warn = drawn.points, drawn.mesh, drawn.read, output.write, arguments.warn


def sound(boundary: _midair.Boundary) -> Any:
    """The sound on a mesh's elements; SciPy and its progress bar load with the first mesh."""
    from ._points.boundary import sound

    return sound(boundary)


def declared() -> None:
    """Gives Scene the numbers of its air and Array its parts: as properties, and in the documentation."""
    keys = _midair.scene_keys()
    # Constructors take their place later: midair._support.slips.
    make, array = cast(Any, Scene)._new, cast(Any, Array)._new([[0, 0, 0]])
    air = {name: about for name, (_, about) in keys["medium"].items()}
    for name in make(array, [[0, 0, 1]]).medium:
        setattr(Scene, name, property(lambda scene, name=name: scene.medium[name], doc=air[name]))  # type: ignore[misc]
    parts = {name: keys["array"][name][1] for name in _midair.array_parts()}
    for name, about in parts.items():
        setattr(Array, name, property(lambda array, name=name: array._part(name), doc=about))  # type: ignore[misc]
    for owner, place, named in ((Scene, "{medium}", air), (Array, "{parts}", parts)):
        lines = "\n".join(f"{name} : {about.removesuffix('.')}" for name, about in named.items())
        owner.__doc__ = (owner.__doc__ or "").replace(place, lines)
    Scene.__doc__ = (Scene.__doc__ or "").replace("{parts}", ", ".join(parts))


def attach() -> None:
    """Adds the methods, and registers this module with the extension."""
    declared()
    for owner, methods in METHODS.items():
        for name, method in methods.items():
            setattr(owner, name, method)
    _midair.register(sys.modules[__name__])
