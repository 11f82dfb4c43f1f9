"""Drives for airborne ultrasound phased arrays: the pressure at given points is what you request.

>>> import midair
>>> array = midair.Array.preset("paper20")
>>> scene = midair.Scene(array, [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
>>> solution = midair.solve(scene, "greedy", seed=1)
>>> solution.metrics.accuracy > 0.8
True

SI units, e^{-jwt}, peak pressures: every convention is in docs/conventions.md.
"""

from typing import TYPE_CHECKING

from . import _toolbox
from ._midair import (
    Array,
    Batch,
    BatchMetrics,
    Bead,
    Field,
    Gorkov,
    Mesh,
    Metrics,
    OptionInfo,
    Plane,
    PresetInfo,
    Propagation,
    Reach,
    Rest,
    Scene,
    SceneError,
    SceneWarning,
    Solution,
    Solver,
    SolverInfo,
    Sphere,
    Wall,
    bound,
    field,
    gorkov,
    judge,
    presets,
    rest,
    solve,
    solve_batch,
)

if TYPE_CHECKING:
    # These imports are for type checkers only. At run time each name is loaded at its first use:
    # `_toolbox.HOMES`.
    from . import grad as grad
    from . import jax as jax
    from . import path as path
    from . import shape as shape
    from . import torch as torch
    from ._boards.address import Port, ports
    from ._boards.board import Board
    from ._boards.connection import Connection, connect
    from ._boards.errors import BoardBusy, BoardError, BoardLost, BoardNotFound, BoardPermission, BoardTimeout
    from ._files import read, write
    from ._flight.flight import Flight
    from ._flight.fly import fly
    from ._judging.compare import Comparison, compare
    from ._judging.exposure import Exposed, Exposure, exposure
    from ._judging.streaming import Streaming, streaming
    from ._judging.tolerance import Kept, Tolerance
    from ._judging.tolerate import tolerate
    from ._measuring.calibrate import calibrate, calibration_drives
    from ._measuring.doctor import doctor
    from ._measuring.player import Fault, Report, Tuning
    from ._measuring.result import Calibration
    from ._measuring.tune import tune
    from ._pictures.figures import style
    from ._pictures.notebook import solvers
    from ._pictures.plot import plot
    from ._points.ear import Ear, ear
    from ._points.image import Picture, image
    from ._sequence import Felt, Sequence, SequenceMetrics, sequence, stream
    from ._studio.view import View, view
    from ._sweep import Dataset, dataset, sweep
    from ._touch.haptic import Haptic, haptic
    from ._touch.skin import Skin, skin

    __version__: str
else:
    __getattr__ = _toolbox.load

__all__ = [
    "Array",
    "Batch",
    "BatchMetrics",
    "Bead",
    "Board",
    "BoardBusy",
    "BoardError",
    "BoardLost",
    "BoardNotFound",
    "BoardPermission",
    "BoardTimeout",
    "Calibration",
    "Comparison",
    "Connection",
    "Dataset",
    "Ear",
    "Exposed",
    "Exposure",
    "Fault",
    "Felt",
    "Field",
    "Flight",
    "Gorkov",
    "Haptic",
    "Kept",
    "Mesh",
    "Metrics",
    "OptionInfo",
    "Picture",
    "Plane",
    "Port",
    "PresetInfo",
    "Propagation",
    "Reach",
    "Report",
    "Rest",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Sequence",
    "SequenceMetrics",
    "Skin",
    "Solution",
    "Solver",
    "SolverInfo",
    "Sphere",
    "Streaming",
    "Tolerance",
    "Tuning",
    "View",
    "Wall",
    "bound",
    "calibrate",
    "calibration_drives",
    "compare",
    "connect",
    "dataset",
    "doctor",
    "ear",
    "exposure",
    "field",
    "fly",
    "gorkov",
    "grad",
    "haptic",
    "image",
    "jax",
    "judge",
    "path",
    "plot",
    "ports",
    "presets",
    "read",
    "rest",
    "sequence",
    "shape",
    "skin",
    "solve",
    "solve_batch",
    "solvers",
    "stream",
    "streaming",
    "style",
    "sweep",
    "tolerate",
    "torch",
    "tune",
    "view",
    "write",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


_toolbox.attach()
