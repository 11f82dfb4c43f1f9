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

if TYPE_CHECKING:
    # These imports are for type checkers only. At run time each name is loaded at its first use:
    # `_toolbox.HOMES`.
    from . import grad as grad, jax as jax, path as path, shape as shape, torch as torch
    from ._boards.address import Port as Port, ports as ports
    from ._boards.board import Board as Board
    from ._boards.connection import Connection as Connection, connect as connect
    from ._boards.errors import (
        BoardBusy as BoardBusy,
        BoardError as BoardError,
        BoardLost as BoardLost,
        BoardNotFound as BoardNotFound,
        BoardPermission as BoardPermission,
        BoardTimeout as BoardTimeout,
    )
    from ._files import read as read, write as write
    from ._flight.flight import Flight as Flight
    from ._flight.fly import fly as fly
    from ._judging.compare import Comparison as Comparison, compare as compare
    from ._judging.exposure import Exposed as Exposed, Exposure as Exposure, exposure as exposure
    from ._judging.streaming import Streaming as Streaming, streaming as streaming
    from ._judging.tolerate import Kept as Kept, Tolerance as Tolerance, tolerate as tolerate
    from ._measuring.calibrate import calibrate as calibrate, calibration_drives as calibration_drives
    from ._measuring.doctor import doctor as doctor
    from ._measuring.player import Fault as Fault, Report as Report, Tuning as Tuning
    from ._measuring.result import Calibration as Calibration
    from ._measuring.tune import tune as tune
    from ._midair import (
        Array as Array,
        Batch as Batch,
        BatchMetrics as BatchMetrics,
        Bead as Bead,
        Field as Field,
        Gorkov as Gorkov,
        Mesh as Mesh,
        Metrics as Metrics,
        OptionInfo as OptionInfo,
        Plane as Plane,
        PresetInfo as PresetInfo,
        Propagation as Propagation,
        Reach as Reach,
        Rest as Rest,
        Scene as Scene,
        SceneError as SceneError,
        SceneWarning as SceneWarning,
        Solution as Solution,
        Solver as Solver,
        SolverInfo as SolverInfo,
        Sphere as Sphere,
        Wall as Wall,
        bound as bound,
        field as field,
        gorkov as gorkov,
        judge as judge,
        presets as presets,
        rest as rest,
        solve as solve,
        solve_batch as solve_batch,
    )
    from ._pictures.figures import style as style
    from ._pictures.notebook import solvers as solvers
    from ._pictures.plot import plot as plot
    from ._points.beam import beam as beam
    from ._points.ear import Ear as Ear, ear as ear
    from ._points.image import Picture as Picture, image as image
    from ._sequence import (
        Felt as Felt,
        Sequence as Sequence,
        SequenceMetrics as SequenceMetrics,
        multiplex as multiplex,
        sequence as sequence,
        stream as stream,
    )
    from ._studio.view import View as View, view as view
    from ._sweep import Dataset as Dataset, dataset as dataset, sweep as sweep
    from ._touch.haptic import Haptic as Haptic, haptic as haptic
    from ._touch.skin import Skin as Skin, skin as skin

    __version__: str
else:
    __all__ = _toolbox.NAMES
    __getattr__ = _toolbox.load


def __dir__() -> list[str]:
    return [*_toolbox.NAMES, "__version__"]


_toolbox.attach()
