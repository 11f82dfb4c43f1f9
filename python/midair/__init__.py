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

from . import path, shape
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
    solve,
    solve_batch,
    solvers,
)
from .boards import (
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
from .boards.playing import play as _play
from .calibration import Calibration, calibrate, calibration_drives
from .compare import Comparison, compare
from .ear import Ear, ear
from .exposure import Exposed, Exposure, exposure
from .files import read, write
from .motion import Felt, Sequence, SequenceMetrics, sequence, stream
from .picture import Picture, image
from .plot import plot
from .streaming import Streaming, streaming
from .studio import View, view
from .sweep import sweep
from .tolerance import Kept, Tolerance, tolerate
from .tuning import Tuning, tune

# Methods that the toolbox adds: `solution.exposure(places)` is `midair.exposure(solution, places)`.
for _owner, _method in (
    (Solution, exposure),
    (Sequence, exposure),
    (Solution, _play),
    (Solution, streaming),
    (Solution, tolerate),
):
    setattr(_owner, _method.__name__, _method)
del _owner, _method, _play

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
    "sequence",
    "shape",
    "solve",
    "solve_batch",
    "solvers",
    "stream",
    "streaming",
    "sweep",
    "tolerate",
    "tune",
    "view",
    "write",
]
