"""The compiled core. Shapes: N transducers, M points; SI units."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from inspect import Signature
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Final, Literal, TypeAlias, Unpack, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bodies
from . import _keywords as k
from ._boards.playing import play as _play
from ._bodies import Sphere as Sphere
from ._bodies import Wall as Wall
from ._calls import Solver as Solver
from ._calls import solve as solve
from ._calls import solve_batch as solve_batch
from ._files.record import save as _save
from ._judging.exposure import exposure as _exposure
from ._judging.streaming import streaming as _streaming
from ._judging.tolerate import tolerate as _tolerate
from ._metrics import BatchMetrics as BatchMetrics
from ._metrics import Metrics as Metrics
from ._pictures.answer import answer as _answer
from ._pictures.plot import plot as _plot
from ._sequence.solve import modulated as _modulated

__all__ = [
    "HIGHEST",
    "MOST_POINTS",
    "REACH",
    "SKIN",
    "STEP",
    "Array",
    "Batch",
    "BatchMetrics",
    "Bead",
    "Boundary",
    "Codec",
    "Course",
    "Curve",
    "Field",
    "Gorkov",
    "Membrane",
    "Mesh",
    "Metrics",
    "OptionInfo",
    "Plane",
    "PresetInfo",
    "Propagation",
    "Pushes",
    "Reach",
    "Response",
    "Rest",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Shifted",
    "Solution",
    "Solver",
    "SolverInfo",
    "Sphere",
    "Wall",
    "about",
    "along",
    "array_parts",
    "bodies",
    "bound",
    "directivities",
    "drive_from_csv",
    "drive_to_csv",
    "excess",
    "felt_width",
    "field",
    "gorkov",
    "gradient",
    "judge",
    "live_lines",
    "memory_limit",
    "numbers",
    "placed",
    "preset_name",
    "presets",
    "read_motion",
    "read_sweep",
    "read_table",
    "register",
    "rest",
    "scene_files",
    "scene_keys",
    "solve",
    "solve_batch",
    "solver_name",
    "solvers",
    "stiffen",
    "strength",
    "sweep_keys",
    "threshold",
    "tracks",
    "unknown",
]

_Numbers: TypeAlias = ArrayLike | None
_Precision: TypeAlias = Literal["single", "double"]
_Obstacle: TypeAlias = _bodies.Body | Mesh
_Directivity: TypeAlias = str | dict[str, float]
_Quantization: TypeAlias = dict[str, int | ArrayLike | None]
_Option: TypeAlias = bool | int | float | str | Sequence[int] | NDArray[np.integer] | None

HIGHEST: float
MOST_POINTS: int
REACH: float
SKIN: tuple[float, float, float]
STEP: float

@final
class Membrane:
    tension: Final[complex]
    def __new__(cls, speed: float = ..., loss: float = ..., mass: float = ...) -> Membrane: ...
    def decay(self, frequencies: NDArray[np.float64]) -> NDArray[np.complex128]: ...
    def response(self, frequency: float, distances: NDArray[np.float64]) -> NDArray[np.complex128]: ...
    def on_plane(
        self, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], step: float, reach: float
    ) -> tuple[NDArray[np.complex64], NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Pushes:
    def __new__(cls, count: int, rate: float, places: int) -> Pushes: ...
    def add(self, first: int, values: NDArray[np.float32]) -> None: ...
    def lines(self) -> tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.complex64]]: ...

@final
class Curve:
    @staticmethod
    def circle(center: ArrayLike, radius: float, normal: ArrayLike, angle: float) -> Curve: ...
    @staticmethod
    def line(start: ArrayLike, end: ArrayLike, there_and_back: bool) -> Curve: ...
    @staticmethod
    def lines(item: str, corners: ArrayLike, closed: bool) -> Curve: ...
    length: Final[float]
    closed: Final[bool]
    def points(self, step: float) -> NDArray[np.float64]: ...
    def after(self, ways: NDArray[np.float64]) -> NDArray[np.float64]: ...

class SceneError(ValueError): ...
class SceneWarning(UserWarning): ...

@final
class Array(k.Radiating):
    def __new__(
        cls, positions: ArrayLike, normals: ArrayLike | None = None, **parts: Unpack[k.Parts]
    ) -> Array: ...
    @staticmethod
    def grid(nx: int, ny: int, pitch: float, **parts: Unpack[k.Parts]) -> Array: ...
    @staticmethod
    def preset(name: str, tiles: tuple[int, int] | None = None, **parts: Unpack[k.Parts]) -> Array: ...
    @staticmethod
    def from_file(path: str | PathLike[str], **parts: Unpack[k.Parts]) -> Array: ...
    @staticmethod
    def presets() -> list[str]: ...
    positions: Final[NDArray[np.float64]]
    normals: Final[NDArray[np.float64]]
    medium: Final[dict[str, float]]
    _hardware: Final[float | None]
    def _with_hardware(self, hardware: float | None) -> Array: ...
    def _is_behind(self, point: Sequence[float]) -> bool: ...
    def _part(self, name: str) -> Any: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def _repr_html_(array: Array) -> str: ...

@final
class PresetInfo:
    summary: Final[str]
    source: Final[str]
    count: Final[int]
    tiles: Final[bool]
    source_pressure: Final[float]
    board: Final[str | None]
    def __eq__(self, other: object, /) -> bool: ...

@final
class Scene(k.Numbers):
    __signature__: ClassVar[Signature]
    def __new__(
        cls,
        array: Array,
        points: ArrayLike,
        pressures: ArrayLike | None = None,
        *,
        weights: ArrayLike | None = None,
        signature: str | ArrayLike | Sequence[str | None] | None = None,
        bead: Mapping[str, Any] | None = None,
        obstacles: Iterable[_Obstacle] | None = None,
        **keys: Unpack[k.Keys],
    ) -> Scene: ...
    @staticmethod
    def load(path: str | PathLike[str]) -> Scene: ...
    @staticmethod
    def parse(
        text: str | bytes, *, name: str = "scene", folder: str | PathLike[str] | None = None
    ) -> Scene: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def json(self, solution: Solution | None = None) -> str: ...
    def replace(
        self,
        *,
        array: Array | None = None,
        points: _Numbers = None,
        pressures: _Numbers = ...,
        weights: _Numbers = ...,
        signature: str | ArrayLike | Sequence[str | None] | None = ...,
        bead: Mapping[str, Any] | None = ...,
        obstacles: Iterable[_Obstacle] | None = ...,
        plane: Plane | None = ...,
        **keys: Unpack[k.Keys],
    ) -> Scene: ...
    def _far(self, name: str, places: ArrayLike) -> str | None: ...
    def propagation(self) -> NDArray[np.complex64]: ...
    def reach(self) -> Reach: ...
    array: Final[Array]
    points: Final[NDArray[np.float64]]
    pressures: Final[NDArray[np.float64 | np.complex128] | None]
    weights: Final[NDArray[np.float64] | None]
    medium: Final[dict[str, float]]
    wavelength: Final[float]
    in_paper_unit: Final[bool]
    solver: Final[tuple[str, dict[str, _Option]] | None]
    signature: Final[str | NDArray[np.complex128] | list[str | None] | None]
    bead: Final[dict[str, float | list[float]]]
    obstacles: Final[list[_Obstacle]]
    plane: Final[Plane | None]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def _repr_html_(scene: Scene) -> str: ...

@final
class Mesh:
    def __new__(
        cls, vertices: ArrayLike, faces: ArrayLike, kind: Literal["rigid", "soft"] = "rigid"
    ) -> Mesh: ...
    @staticmethod
    def from_file(
        path: str | PathLike[str],
        *,
        scale: float | None = None,
        offset: ArrayLike | None = None,
        kind: Literal["rigid", "soft"] = "rigid",
    ) -> Mesh: ...
    vertices: Final[NDArray[np.float64]]
    faces: Final[NDArray[np.uint32]]
    kind: Final[Literal["rigid", "soft"]]
    volume: Final[float]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Boundary:
    shape: Final[tuple[int, int]]
    def content(self) -> bytes: ...
    def matrix(self, progress: Callable[[int, int, float], object] | None) -> NDArray[np.complex64]: ...
    def incident(self) -> NDArray[np.complex64]: ...
    def left_inside(self, sound: NDArray[np.complex64]) -> float: ...

@final
class Gorkov:
    potential: Final[NDArray[np.float64]]
    force: Final[NDArray[np.float64]]
    stiffness: Final[NDArray[np.float64]]
    hessian: Final[NDArray[np.float64]]
    net: Final[NDArray[np.float64]]
    weight: Final[NDArray[np.float64]]
    mass: Final[float]
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Rest:
    place: Final[NDArray[np.float64]]
    held: Final[NDArray[np.bool_]]
    stiffness: Final[NDArray[np.float64]]
    axes: Final[NDArray[np.float64]]
    basin: Final[NDArray[np.float64]]
    restoring: Final[NDArray[np.float64]]
    frequencies: Final[NDArray[np.float64]]
    acceleration: Final[NDArray[np.float64]]
    mass: Final[float]
    def __len__(self) -> int: ...

@final
class Bead:
    def __new__(
        cls,
        scene: Scene,
        radius: float | None = None,
        density: float | None = None,
        sound_speed: float | None = None,
        gravity: ArrayLike | None = None,
    ) -> Bead: ...
    mass: Final[float]
    def needed(self, velocities: ArrayLike, accelerations: ArrayLike) -> NDArray[np.float64]: ...
    def keywords(self) -> dict[str, Any]: ...
    def poised(
        self, scene: Scene, drive: NDArray[np.complex64], point: Sequence[float], force: Sequence[float]
    ) -> NDArray[np.float64] | None: ...

@final
class Response:
    def __new__(cls, rate: float, tau: float, linear: bool) -> Response: ...
    def memory(self, frames: int) -> int: ...
    def repeated(
        self, last: NDArray[np.complex64], first: NDArray[np.complex64]
    ) -> NDArray[np.complex128]: ...
    def inside(
        self,
        now: NDArray[np.complex64],
        following: NDArray[np.complex64],
        start: NDArray[np.complex128],
        parts: int,
        first: int,
        stop: int,
    ) -> tuple[NDArray[np.complex64], NDArray[np.complex128]]: ...

@final
class Course:
    def __new__(
        cls,
        points: NDArray[np.float64],
        wavelength: float,
        response: Response,
        closed: bool,
        start: NDArray[np.complex128],
    ) -> Course: ...
    def play(self, now: NDArray[np.complex64], following: NDArray[np.complex64]) -> None: ...
    def knots(self, duration: float | None) -> int: ...
    def speeds(self, points: Sequence[int]) -> NDArray[np.float64]: ...
    def resting(self, scene: Scene, bead: Bead, points: Sequence[int]) -> NDArray[np.float64]: ...
    def fly(
        self,
        scene: Scene,
        bead: Bead,
        places: NDArray[np.float64],
        speeds: NDArray[np.float64],
        points: Sequence[int],
        knots: int,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Reach:
    alone: Final[NDArray[np.float64]]
    level: Final[NDArray[np.float64]]
    def __eq__(self, other: object, /) -> bool: ...

@final
class Propagation:
    def __new__(cls, matrix: ArrayLike) -> Propagation: ...
    shape: Final[tuple[int, int]]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Plane:
    def __new__(
        cls,
        z: float | None = None,
        size: float | None = None,
        pixels: int = 200,
        center: tuple[float, float] = (0, 0),
        *,
        axis: str = "z",
        at: float | None = None,
    ) -> Plane: ...
    def along(self, axis: str) -> NDArray[np.float64] | None: ...
    axis: Final[str]
    at: Final[float]
    z: Final[float | None]
    size: Final[float]
    pixels: Final[int]
    center: Final[tuple[float, float]]
    x: Final[NDArray[np.float64] | None]
    y: Final[NDArray[np.float64] | None]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Field:
    pressure: Final[NDArray[np.complex64]]
    radiation: Final[NDArray[np.float64]]
    x: Final[NDArray[np.float64] | None]
    y: Final[NDArray[np.float64] | None]
    z: Final[NDArray[np.float64] | None]
    plane: Final[Plane | None]
    points: Final[NDArray[np.float64] | None]
    shown: Final[NDArray[np.bool_] | None]
    panels: Final[list[Field]]
    scene: Final[Scene]
    solution: Final[Solution | None]
    scale: Final[float]
    def __eq__(self, other: object, /) -> bool: ...
    def _repr_html_(field: Field) -> str: ...
    plot = _plot

@final
class Shifted:
    def __new__(cls, starts: ArrayLike, rows: ArrayLike, values: ArrayLike, shares: ArrayLike) -> Shifted: ...
    def solve(self, shifts: ArrayLike, loads: ArrayLike) -> NDArray[np.complex64]: ...

@final
class Solution:
    @staticmethod
    def load(path: str | PathLike[str]) -> Solution: ...
    drive: Final[NDArray[np.complex64]]
    phases: Final[NDArray[np.float64]]
    amplitudes: Final[NDArray[np.float64]]
    pressures: Final[NDArray[np.complex64]]
    radiation: Final[NDArray[np.float64]]
    targets: Final[NDArray[np.float64]]
    metrics: Final[Metrics]
    complex_error: Final[float | None]
    status: Final[Literal["done", "out_of_steps", "stopped", "missed"]]
    steps: Final[int]
    scale: Final[float]
    elapsed: Final[float]
    spl: Final[NDArray[np.float64]]
    def field(self, plane: Plane | ArrayLike | None = None) -> Field: ...
    def judge(
        self,
        *,
        pressures: _Numbers = None,
        weights: _Numbers = None,
        mask: _Numbers = None,
        precision: _Precision | None = None,
    ) -> Metrics: ...
    def gorkov(
        self,
        points: ArrayLike | None = None,
        *,
        radius: float | None = None,
        density: float | None = None,
        sound_speed: float | None = None,
        gravity: ArrayLike | None = None,
    ) -> Gorkov: ...
    def rest(
        self,
        points: ArrayLike | None = None,
        *,
        radius: float | None = None,
        density: float | None = None,
        sound_speed: float | None = None,
        gravity: ArrayLike | None = None,
    ) -> Rest: ...
    # Functions of the package, of which the solution is the first argument.
    exposure = _exposure
    modulated = _modulated
    play = _play
    plot = _answer
    save = _save
    streaming = _streaming
    tolerate = _tolerate
    trace: Final[NDArray[np.float64] | None]
    scene: Final[Scene | None]
    solver: Final[str]
    options: Final[dict[str, _Option]]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def _repr_html_(solution: Solution) -> str: ...

@final
class OptionInfo:
    default: Final[_Option]
    doc: Final[str]
    words: Final[list[str]]
    list: Final[bool]
    def __eq__(self, other: object, /) -> bool: ...

@final
class SolverInfo:
    name: Final[str]
    summary: Final[str]
    source: Final[str]
    balance: Final[bool]
    uses_phases: Final[bool]
    uses_start: Final[bool]
    uses_aim: Final[bool]
    options: Final[dict[str, OptionInfo]]
    def __eq__(self, other: object, /) -> bool: ...

@final
class Codec:
    def __new__(
        cls,
        name: str,
        array: Array | None = None,
        *,
        channels: Sequence[int] | NDArray[np.integer] | None = None,
        corrections: ArrayLike | None = None,
    ) -> Codec: ...
    @staticmethod
    def kinds() -> dict[str, Codec]: ...
    @staticmethod
    def array(kind: str, tiles: tuple[int, int] | None = None) -> Array: ...
    def encode(self, drive: ArrayLike) -> bytes: ...
    def decode(self, frame: bytes) -> NDArray[np.complex64]: ...
    off_frame: Final[bytes]
    silence: Final[bytes]
    name: Final[str]
    summary: Final[str]
    source: Final[str]
    link: Final[dict[str, Any]]
    boards: Final[int]
    lines: Final[int]
    most_boards: Final[int]
    channels: Final[NDArray[np.int64]]
    frequency: Final[float]
    response: Final[NDArray[np.complex128] | None]
    baud: Final[int | None]
    rate: Final[float]
    steady_rate: Final[float]
    quantization: Final[dict[str, int | NDArray[np.float64] | None]]

@final
class Batch:
    drives: Final[NDArray[np.complex64]]
    pressures: Final[NDArray[np.complex64]]
    metrics: Final[BatchMetrics]
    scale: Final[NDArray[np.float64]]
    status: Final[list[str]]
    steps: Final[NDArray[np.int64]]
    beyond: Final[NDArray[np.bool]]
    weak: Final[NDArray[np.bool]]
    elapsed: Final[float]
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> Solution: ...
    def __eq__(self, other: object, /) -> bool: ...
    def _repr_html_(batch: Batch) -> str: ...

def bound(
    scene: Scene | Propagation, *, pressures: _Numbers = None, weights: _Numbers = None, mask: _Numbers = None
) -> float: ...
def about(
    scene: Scene | Solution, drive: Any = None, place: Any = None
) -> tuple[Scene, ArrayLike | Solution, Any]: ...
def field(
    scene: Scene | Solution,
    drive: ArrayLike | Solution | Plane | None = None,
    plane: Plane | ArrayLike | None = None,
) -> Field: ...
@overload
def judge(
    scene: Scene | Propagation | Solution,
    drive: ArrayLike | Solution | None = None,
    *,
    points: None = None,
    pressures: _Numbers = None,
    weights: _Numbers = None,
    mask: _Numbers = None,
    precision: _Precision | None = None,
    threads: int | None = None,
    progress: Callable[[int, int, float], object] | None = None,
) -> Metrics: ...
@overload
def judge(
    scene: Array | Scene,
    drive: ArrayLike,
    *,
    points: ArrayLike,
    pressures: _Numbers = None,
    weights: _Numbers = None,
    mask: _Numbers = None,
    precision: _Precision | None = None,
    threads: int | None = None,
    progress: Callable[[int, int, float], object] | None = None,
) -> BatchMetrics: ...
def memory_limit() -> int: ...
def tracks(
    scene: Scene,
    points: ArrayLike,
    targets: ArrayLike,
    *,
    change: float,
    phases: int,
    closed: bool,
    rounds: int,
    start: NDArray[np.uint16] | None = None,
    progress: Callable[[int, int, float], object] | None = None,
) -> NDArray[np.uint16]: ...
def threshold(fast: bool, frequencies: NDArray[np.float64]) -> NDArray[np.float64]: ...
def excess(
    fast: bool, frequencies: NDArray[np.float64], squares: NDArray[np.float32]
) -> NDArray[np.float64]: ...
def live_lines(lines: NDArray[np.complex64]) -> NDArray[np.bool_]: ...
def strength(slow: NDArray[np.float64], fast: NDArray[np.float64]) -> NDArray[np.float64]: ...
def felt_width(values: NDArray[np.float64], places: NDArray[np.float64], middle: int) -> float: ...
def stiffen(
    scene: Scene,
    points: ArrayLike,
    codes: NDArray[np.uint16],
    *,
    change: float,
    phases: int,
    closed: bool,
    rate: float,
    margin: int,
    progress: Callable[[int, int, float], object] | None = None,
) -> NDArray[np.uint16]: ...
def register(toolbox: object) -> None: ...
def solvers() -> dict[str, SolverInfo]: ...
def presets() -> dict[str, PresetInfo]: ...
def bodies() -> dict[str, dict[str, int]]: ...
def directivities() -> dict[str, tuple[float | None, str, str]]: ...
def preset_name(name: str) -> str: ...
def along(contours: Sequence[ArrayLike], step: float) -> NDArray[np.float64]: ...
def numbers(
    item: str,
    value: object,
    shapes: Sequence[tuple[int, ...]] | None,
    cure: str,
    *,
    kinds: str = "iuf",
    least: float | None = None,
    most: float | None = None,
    copy: bool = True,
) -> NDArray[Any]: ...
def read_motion(
    path: str | PathLike[str], start: Callable[[str, str], NDArray[np.float64]]
) -> tuple[Scene, dict[str, Any]] | None: ...
def placed(text: bytes, name: str, refusal: str) -> str: ...
def read_sweep(text: bytes, name: str) -> dict[str, Any]: ...
def sweep_keys() -> dict[str, dict[str, tuple[str, str]]]: ...
def read_table(
    text: bytes, name: str, names: list[str] | None = None, units: str = "in metres", example: str = ""
) -> tuple[NDArray[np.uintp], NDArray[np.float64]]: ...
def drive_from_csv(text: bytes, name: str) -> NDArray[np.complex64]: ...
def drive_to_csv(drive: ArrayLike, positions: ArrayLike | None = None) -> str: ...
def scene_files(path: str | PathLike[str], text: bytes | None = None) -> list[Path]: ...
def array_parts() -> dict[str, str]: ...
def scene_keys() -> dict[str, dict[str, tuple[str, str]]]: ...
def solver_name(name: str) -> str: ...
def unknown(kind: str, name: str, known: list[str]) -> tuple[str, str]: ...
def gorkov(
    scene: Scene | Solution,
    drive: ArrayLike | Solution | None = None,
    points: ArrayLike | None = None,
    *,
    radius: float | None = None,
    density: float | None = None,
    sound_speed: float | None = None,
    gravity: ArrayLike | None = None,
) -> Gorkov: ...
def gradient(
    quantity: str,
    scene: Scene | Array | Solution,
    drive: ArrayLike | Solution | None,
    points: ArrayLike | None,
    cotangent: ArrayLike | None = None,
    radius: float | None = None,
    density: float | None = None,
    sound_speed: float | None = None,
) -> tuple[Any, ...]: ...
def rest(
    scene: Scene | Solution,
    drive: ArrayLike | Solution | None = None,
    points: ArrayLike | None = None,
    *,
    radius: float | None = None,
    density: float | None = None,
    sound_speed: float | None = None,
    gravity: ArrayLike | None = None,
) -> Rest: ...
