"""The compiled core. Shapes: N transducers, M points; SI units."""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Array",
    "Batch",
    "BatchMetrics",
    "Field",
    "Metrics",
    "OptionInfo",
    "Plane",
    "PresetInfo",
    "Propagation",
    "Reach",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Solution",
    "Solver",
    "SolverInfo",
    "bound",
    "field",
    "judge",
    "preset_name",
    "presets",
    "scene_files",
    "solve",
    "solve_batch",
    "solver_name",
    "solvers",
]

_Numbers: TypeAlias = ArrayLike | None
_Directivity: TypeAlias = str | dict[str, float]
_Quantization: TypeAlias = dict[str, int | ArrayLike | None]
_Option: TypeAlias = bool | int | float | str | Sequence[int] | NDArray[np.integer] | None

class SceneError(ValueError): ...
class SceneWarning(UserWarning): ...

@final
class Array:
    def __new__(
        cls,
        positions: ArrayLike,
        normals: ArrayLike | None = None,
        *,
        source_pressure: float | None = None,
        directivity: _Directivity | None = None,
        response: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        quantization: _Quantization | None = None,
    ) -> Array: ...
    @staticmethod
    def grid(
        nx: int,
        ny: int,
        pitch: float,
        *,
        source_pressure: float | None = None,
        directivity: _Directivity | None = None,
        response: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        quantization: _Quantization | None = None,
    ) -> Array: ...
    @staticmethod
    def preset(
        name: str,
        tiles: tuple[int, int] | None = None,
        *,
        source_pressure: float | None = None,
        directivity: _Directivity | None = None,
        response: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        quantization: _Quantization | None = None,
    ) -> Array: ...
    @staticmethod
    def presets() -> list[str]: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def normals(self) -> NDArray[np.float64]: ...
    @property
    def response(self) -> NDArray[np.complex128] | None: ...
    @property
    def mask(self) -> NDArray[np.bool_]: ...
    @property
    def quantization(self) -> dict[str, int | NDArray[np.float64] | None] | None: ...
    @property
    def source_pressure(self) -> float: ...
    @property
    def directivity(self) -> _Directivity: ...
    def __len__(self) -> int: ...

@final
class PresetInfo:
    @property
    def summary(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def count(self) -> int: ...
    @property
    def tiles(self) -> bool: ...
    @property
    def source_pressure(self) -> float: ...

@final
class Scene:
    def __new__(
        cls,
        array: Array,
        points: ArrayLike,
        pressures: ArrayLike | None = None,
        *,
        weights: ArrayLike | None = None,
        frequency: float | None = None,
        sound_speed: float | None = None,
        temperature: float | None = None,
        absorption: float | None = None,
        density: float | None = None,
        source_pressure: float | None = None,
        directivity: _Directivity | None = None,
    ) -> Scene: ...
    @staticmethod
    def load(path: str | PathLike[str]) -> Scene: ...
    @staticmethod
    def parse(
        text: str | bytes, *, name: str = "scene", folder: str | PathLike[str] | None = None
    ) -> Scene: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def json(self, solution: Solution | None = None) -> str: ...
    def propagation(self) -> NDArray[np.complex64]: ...
    def reach(self) -> Reach: ...
    @property
    def array(self) -> Array: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def pressures(self) -> NDArray[np.float64] | None: ...
    @property
    def weights(self) -> NDArray[np.float64] | None: ...
    @property
    def frequency(self) -> float: ...
    @property
    def sound_speed(self) -> float: ...
    @property
    def wavelength(self) -> float: ...
    @property
    def absorption(self) -> float: ...
    @property
    def density(self) -> float: ...
    @property
    def in_paper_unit(self) -> bool: ...
    @property
    def solver(self) -> tuple[str, dict[str, _Option]] | None: ...
    @property
    def plane(self) -> Plane | None: ...

@final
class Reach:
    @property
    def alone(self) -> NDArray[np.float64]: ...
    @property
    def level(self) -> NDArray[np.float64]: ...

@final
class Propagation:
    def __new__(cls, matrix: ArrayLike) -> Propagation: ...
    @property
    def shape(self) -> tuple[int, int]: ...

@final
class Plane:
    def __new__(
        cls, z: float, size: float, pixels: int = 200, center: tuple[float, float] = (0, 0)
    ) -> Plane: ...
    @property
    def z(self) -> float: ...
    @property
    def size(self) -> float: ...
    @property
    def pixels(self) -> int: ...
    @property
    def center(self) -> tuple[float, float]: ...
    @property
    def x(self) -> NDArray[np.float64]: ...
    @property
    def y(self) -> NDArray[np.float64]: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Field:
    @property
    def pressure(self) -> NDArray[np.complex64]: ...
    @property
    def radiation(self) -> NDArray[np.float64]: ...
    @property
    def x(self) -> NDArray[np.float64] | None: ...
    @property
    def y(self) -> NDArray[np.float64] | None: ...
    @property
    def plane(self) -> Plane | None: ...
    @property
    def points(self) -> NDArray[np.float64] | None: ...
    @property
    def scene(self) -> Scene: ...

@final
class Metrics:
    @property
    def accuracy(self) -> float: ...
    @property
    def sigma(self) -> float: ...
    @property
    def uniformity(self) -> float: ...
    @property
    def level(self) -> float: ...
    @property
    def residual(self) -> float: ...
    @property
    def leak(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Solution:
    @property
    def drive(self) -> NDArray[np.complex64]: ...
    @property
    def phases(self) -> NDArray[np.float64]: ...
    @property
    def amplitudes(self) -> NDArray[np.float64]: ...
    @property
    def pressures(self) -> NDArray[np.complex64]: ...
    @property
    def radiation(self) -> NDArray[np.float64]: ...
    @property
    def targets(self) -> NDArray[np.float64]: ...
    @property
    def metrics(self) -> Metrics: ...
    @property
    def status(self) -> Literal["done", "out_of_steps", "stopped"]: ...
    @property
    def steps(self) -> int: ...
    @property
    def scale(self) -> float: ...
    @property
    def elapsed(self) -> float: ...
    @property
    def trace(self) -> NDArray[np.float64] | None: ...
    @property
    def scene(self) -> Scene | None: ...
    @property
    def solver(self) -> str: ...
    @property
    def options(self) -> dict[str, _Option]: ...

@final
class OptionInfo:
    @property
    def default(self) -> _Option: ...
    @property
    def doc(self) -> str: ...

@final
class SolverInfo:
    @property
    def name(self) -> str: ...
    @property
    def summary(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def balance(self) -> bool: ...
    @property
    def options(self) -> dict[str, OptionInfo]: ...

@final
class BatchMetrics:
    @property
    def accuracy(self) -> NDArray[np.float64]: ...
    @property
    def sigma(self) -> NDArray[np.float64]: ...
    @property
    def uniformity(self) -> NDArray[np.float64]: ...
    @property
    def level(self) -> NDArray[np.float64]: ...
    @property
    def residual(self) -> NDArray[np.float64]: ...
    @property
    def leak(self) -> NDArray[np.float64]: ...

@final
class Batch:
    @property
    def drives(self) -> NDArray[np.complex64]: ...
    @property
    def pressures(self) -> NDArray[np.complex64]: ...
    @property
    def metrics(self) -> BatchMetrics: ...
    @property
    def scale(self) -> NDArray[np.float64]: ...
    @property
    def status(self) -> list[str]: ...
    @property
    def steps(self) -> NDArray[np.int64]: ...
    @property
    def beyond(self) -> NDArray[np.bool]: ...
    @property
    def weak(self) -> NDArray[np.bool]: ...
    @property
    def elapsed(self) -> float: ...
    def __len__(self) -> int: ...

def solve_batch(
    scene: Scene | Array | Propagation,
    points: ArrayLike | None = None,
    pressures: ArrayLike | None = None,
    solver: str | None = None,
    *,
    weights: ArrayLike | None = None,
    start: ArrayLike | None = None,
    out: NDArray[np.complex64] | None = None,
    threads: int | None = None,
    progress: Callable[[int, int, float], object] | None = None,
    **options: Any,
) -> Batch: ...

@final
class Solver:
    def __new__(
        cls,
        scene: Scene | Array | Propagation,
        solver: str | None = None,
        *,
        points: int | None = None,
        **options: Any,
    ) -> Solver: ...
    @overload
    def __call__(
        self,
        points: ArrayLike | None = None,
        pressures: ArrayLike | None = None,
        *,
        weights: ArrayLike | None = None,
        start: ArrayLike | Solution | None = None,
        out: None = None,
    ) -> Solution: ...
    @overload
    def __call__(
        self,
        points: ArrayLike | None = None,
        pressures: ArrayLike | None = None,
        *,
        weights: ArrayLike | None = None,
        start: ArrayLike | Solution | None = None,
        out: NDArray[np.complex64],
    ) -> Solver: ...
    @property
    def drive(self) -> NDArray[np.complex64]: ...
    @property
    def pressures(self) -> NDArray[np.complex64]: ...
    @property
    def metrics(self) -> Metrics: ...
    @property
    def status(self) -> str: ...
    @property
    def scale(self) -> float: ...
    @property
    def steps(self) -> int: ...
    @property
    def elapsed(self) -> float: ...
    @property
    def solver(self) -> str: ...
    @property
    def options(self) -> dict[str, _Option]: ...

def solve(
    scene: Scene | Propagation,
    solver: str | None = None,
    *,
    pressures: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    quantization: _Quantization | None = None,
    mask: ArrayLike | None = None,
    positions: ArrayLike | None = None,
    balance: bool | None = None,
    aim: Literal["target", "max"] | None = None,
    start: ArrayLike | Solution | None = None,
    progress: Callable[[int, int, float], object] | None = None,
    trace: bool = False,
    **options: _Option,
) -> Solution: ...
def bound(
    scene: Scene | Propagation, *, pressures: _Numbers = None, weights: _Numbers = None, mask: _Numbers = None
) -> float: ...
def field(scene: Scene, drive: ArrayLike, plane: Plane | ArrayLike | None = None) -> Field: ...
def judge(
    scene: Scene | Propagation,
    drive: ArrayLike,
    *,
    pressures: _Numbers = None,
    weights: _Numbers = None,
    mask: _Numbers = None,
) -> Metrics: ...
def solvers() -> dict[str, SolverInfo]: ...
def presets() -> dict[str, PresetInfo]: ...
def preset_name(name: str) -> str: ...
def scene_files(path: str | PathLike[str]) -> list[Path]: ...
def solver_name(name: str) -> str: ...
