"""Drives for airborne ultrasound phased arrays: given points in the air feel given pressures.

>>> import midair
>>> array = midair.Array.preset("paper20")
>>> scene = midair.Scene(array, [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
>>> solution = midair.solve(scene, "greedy", seed=1)
>>> solution.metrics.accuracy > 0.8
True

SI units, e^{-jwt}, peak pressures: every convention is in docs/conventions.md.
"""

from importlib.metadata import version as _version

from . import _toolbox
from ._boards import (
    Board,
    BoardBusy,
    BoardError,
    BoardLost,
    BoardNotFound,
    BoardPermission,
    BoardTimeout,
    Connection,
    Port,
    connect,
    ports,
)
from ._files import read, write
from ._judging import Kept, Tolerance, tolerate
from ._judging.compare import Comparison, compare
from ._judging.exposure import Exposed, Exposure, exposure
from ._judging.streaming import Streaming, streaming
from ._measuring import Calibration, Fault, Report, Tuning, calibrate, calibration_drives, doctor, tune
from ._midair import (
    Array,
    Batch,
    BatchMetrics,
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
from ._motion import Felt, Sequence, SequenceMetrics, sequence, stream
from ._pictures.notebook import solvers
from ._pictures.plot import plot
from ._pictures.sheet import style
from ._points.ear import Ear, ear
from ._points.image import Picture, image
from ._studio import View, view
from ._support import slips as _slips
from ._sweep import sweep

_toolbox.attach()

__version__ = _version("midair")
__all__ = [
    "Array",
    "Batch",
    "BatchMetrics",
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
    "Ear",
    "Exposed",
    "Exposure",
    "Fault",
    "Felt",
    "Field",
    "Gorkov",
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
    "doctor",
    "ear",
    "exposure",
    "field",
    "gorkov",
    "image",
    "judge",
    "path",
    "plot",
    "ports",
    "presets",
    "read",
    "rest",
    "sequence",
    "shape",
    "solve",
    "solve_batch",
    "solvers",
    "stream",
    "streaming",
    "style",
    "sweep",
    "tolerate",
    "tune",
    "view",
    "write",
]

_slips.attach(__name__)
