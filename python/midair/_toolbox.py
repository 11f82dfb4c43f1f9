"""Toolbox: methods that Python adds to the extension's classes, and functions that the extension calls.

The extension never imports the package: `midair` registers this module.
"""

from __future__ import annotations

import inspect
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
from ._points import drawn
from ._support import arguments, output

#: By class and name: `solution.exposure(places)` is `midair.exposure(solution, places)`.
METHODS: dict[type, dict[str, Any]] = {
    Array: {"_repr_html_": notebook.array, "from_file": staticmethod(read_array)},
    Batch: {"_repr_html_": notebook.batch},
    Field: {"_repr_html_": notebook.field},
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


def air() -> None:
    """Gives Scene the keys of the medium: in its signature and documentation, the numbers as properties."""

    def number(name: str, about: str) -> property:
        def read(scene: Scene) -> float:
            """One number of a scene's air."""
            return scene.medium[name]

        return property(read, doc=about)

    keys = {name: about for name, (_, about) in _midair.scene_keys()["medium"].items()}
    # Constructors take their place later: midair._support.slips.
    make, array = cast(Any, Scene)._new, cast(Any, Array)._new([[0, 0, 0]])
    for name in make(array, [[0, 0, 1]]).medium:
        setattr(Scene, name, number(name, keys[name]))
    lines = "\n".join(f"{name} : {about.removesuffix('.')}" for name, about in keys.items())
    Scene.__doc__ = (Scene.__doc__ or "").replace("{medium}", lines)
    signature = inspect.signature(make)
    own = list(signature.parameters.values())[:-1]
    air = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in keys]
    Scene.__signature__ = signature.replace(parameters=[*own[:4], *air, *own[4:]])


def attach() -> None:
    """Adds the methods, and registers this module with the extension."""
    air()
    for owner, methods in METHODS.items():
        for name, method in methods.items():
            setattr(owner, name, method)
    _midair.register(sys.modules[__name__])
