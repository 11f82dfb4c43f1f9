"""Loads public names, and methods of the extension's classes, from their modules at the first use.

So `import midair` loads only NumPy and the extension. The extension never imports the Python package; instead
`midair` registers this module with the extension, which calls its functions.
"""

import sys
from importlib import import_module
from typing import Any, cast

from . import _midair
from ._midair import Array, Batch, Field, Scene, Solution, presets
from ._support import slips
from ._support.slips import Later

#: Public names by the module that contains them. A module without names is itself the public name.
HOMES = {
    "_boards.address": "Port ports",
    "_boards.board": "Board",
    "_boards.connection": "Connection connect",
    "_boards.errors": "BoardBusy BoardError BoardLost BoardNotFound BoardPermission BoardTimeout",
    "_files": "read write",
    "_flight.fly": "Flight fly weigh",
    "_judging.compare": "Comparison compare",
    "_judging.exposure": "Exposed Exposure exposure",
    "_judging.streaming": "Streaming streaming",
    "_judging.tolerate": "Kept Tolerance tolerate",
    "_measuring.calibrate": "calibrate calibration_drives",
    "_measuring.doctor": "Fault Report doctor",
    "_measuring.result": "Calibration",
    "_measuring.tune": "Tuning tune",
    "_midair": "Array Batch BatchMetrics Bead Field Gorkov Mesh Metrics OptionInfo Plane PresetInfo "
    "Propagation Reach Rest Scene SceneError SceneWarning Solution Solver SolverInfo Sphere "
    "Wall bound field gorkov judge presets rest solve solve_batch",
    "_pictures.notebook": "solvers",
    "_pictures.plot": "plot",
    "_pictures.figures": "style",
    "_points.beam": "beam",
    "_points.ear": "Ear ear",
    "_points.image": "Picture image",
    "_sequence.felt": "Felt",
    "_sequence.frames": "SequenceMetrics",
    "_sequence.sequence": "Sequence",
    "_sequence.solve": "multiplex sequence stream",
    "_studio.view": "View view",
    "_sweep": "Dataset dataset sweep",
    "_touch.haptic": "Haptic haptic",
    "_touch.recipes": "recipes",
    "_touch.skin": "Skin skin",
    "grad": "",
    "jax": "",
    "path": "",
    "shape": "",
    "torch": "",
}

#: All public names.
NAMES = sorted(name for home, names in HOMES.items() for name in names.split() or [home])

#: Methods by class: `solution.exposure(places)` calls `midair.exposure(solution, places)`.
METHODS: dict[type, dict[str, Later]] = {
    Array: {
        "_repr_html_": Later("_pictures.notebook", "array"),
        "from_file": Later("_files", "read_array", static=True),
    },
    Batch: {"_repr_html_": Later("_pictures.notebook", "batch")},
    Field: {"_repr_html_": Later("_pictures.notebook", "field"), "plot": Later("_pictures.plot", "plot")},
    Scene: {"_repr_html_": Later("_pictures.notebook", "scene")},
    Solution: {
        "_repr_html_": Later("_pictures.notebook", "solution"),
        "exposure": Later("_judging.exposure", "exposure"),
        "field": Later("_midair", "field"),
        "gorkov": Later("_midair", "gorkov"),
        "judge": Later("_midair", "judge"),
        "load": Later("_files.record", "load", static=True),
        "modulated": Later("_sequence.solve", "modulated"),
        "play": Later("_boards.connection", "play"),
        "plot": Later("_pictures.plot", "answer"),
        "rest": Later("_midair", "rest"),
        "save": Later("_files.record", "save"),
        "streaming": Later("_judging.streaming", "streaming"),
        "tolerate": Later("_judging.tolerate", "tolerate"),
    },
}

#: Types of the keywords that the core declares, by their kind, as docstrings name them.
TYPES = {
    "real": "float",
    "directivity": "str or mapping",
    "complexes": "(N,) array_like",
    "flags": "(N,) array_like of bool",
    "indices": "(N,) array_like of int",
    "quantization": "mapping",
}

#: Functions that the extension calls: for tables and meshes of scene files, for writing and for warnings.
CALLED = {
    "points": ("_points.drawn", "points"),
    "mesh": ("_points.drawn", "mesh"),
    "outline": ("_points.drawn", "outline"),
    "sound": ("_points.boundary", "sound"),
    "array_of": ("_files", "array_of"),
    "mesh_file": ("_points.drawn", "read"),
    "write": ("_support.output", "write"),
    "warn": ("_support.arguments", "warn"),
}


def __getattr__(name: str) -> Any:
    if name not in CALLED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home, own = CALLED[name]
    return getattr(import_module(f"midair.{home}"), own)


def load(name: str) -> Any:
    """Load a public name of `midair`. Raises AttributeError if there is no such name."""
    package = sys.modules["midair"]
    if name == "__version__":
        from importlib.metadata import version

        value: Any = version("midair")
    else:
        home = next((home for home, names in HOMES.items() if name in (names.split() or [home])), None)
        if home is None:
            preset = presets().get(name.lower())
            hint = "" if preset is None else f': give midair.Array.preset("{name.lower()}")'
            raise AttributeError(f"module 'midair' has no attribute {name!r}{hint}")
        module = import_module(f"midair.{home}")
        value = module if name == home else slips.guided(getattr(module, name), f"midair.{name}")
    setattr(package, name, value)
    guide()
    return value


def guide() -> None:
    """Add hints about keywords to public classes whose modules are loaded, but whose names are not yet."""
    package = sys.modules["midair"]
    for home, names in HOMES.items():
        loaded = vars(sys.modules.get(f"midair.{home}", package))
        for name in names.split():
            if name not in vars(package) and isinstance(loaded.get(name), type):
                setattr(package, name, slips.guided(loaded[name], f"midair.{name}"))


def declared() -> None:
    """Add properties to Scene (values of the air) and Array (its parts), and list them in the docstrings."""
    keys = _midair.scene_keys()
    # `_new` is the constructor of the extension's classes; `slips` later makes it their `__new__`.
    make, array = cast(Any, Scene)._new, cast(Any, Array)._new([[0, 0, 0]])
    air = {name: about for name, (_, about) in keys["medium"].items()}
    for name in make(array, [[0, 0, 1]]).medium:
        setattr(Scene, name, property(lambda scene, name=name: scene.medium[name], doc=air[name]))  # type: ignore[misc]
    parts = {name: keys["array"][name][1] for name in _midair.array_parts()}
    for name, about in parts.items():
        setattr(Array, name, property(lambda array, name=name: array._part(name), doc=about))  # type: ignore[misc]
    kinds = {**dict.fromkeys(air, "real"), **_midair.array_parts()}
    for owner, place, named in ((Scene, "{medium}", air), (Array, "{parts}", parts)):
        entries = (f"{name} : {TYPES[kinds[name]]}, optional\n    {about}" for name, about in named.items())
        owner.__doc__ = (owner.__doc__ or "").replace(place, "\n".join(entries))
    Scene.__doc__ = (Scene.__doc__ or "").replace("{parts}", ", ".join(parts))


def attach() -> None:
    """Add the methods, and register this module with the extension."""
    declared()
    for owner, methods in METHODS.items():
        for name, method in methods.items():
            method.__set_name__(owner, name)
            setattr(owner, name, method)
    for name in HOMES["_midair"].split():
        getattr(sys.modules["midair"], name)
    _midair.register(sys.modules[__name__])
