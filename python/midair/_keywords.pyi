"""Keywords that the core declares: of the air, of arrays, of scenes and of each solver.
Made by `make generated`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._midair import Array, Bead, Plane

_Directivity: TypeAlias = str | dict[str, float]
_Quantization: TypeAlias = dict[str, int | ArrayLike | None]

class Air(TypedDict, total=False):
    frequency: float | None
    """Frequency f in Hz; by default the frequency of the array's board, or 40e3."""
    sound_speed: float | None
    """Sound speed c in m/s; by default that of the given temperature, else of 25 degrees C for a board, or 340."""
    absorption: float | None
    """Absorption alpha of the amplitude in Np/m; by default that of the given air, else of room air for a board, or 0."""
    density: float | None
    """Density rho in kg/m^3; by default that of the given air, else of room air for a board, or 1.223."""
    temperature: float | None
    """Temperature T of the air in degrees C, instead of the sound speed c = 331.3 sqrt(1 + T/273.15) m/s; also changes absorption and density."""
    humidity: float | None
    """Relative humidity of the air in percent, for absorption (ISO 9613-1) and density; default 50."""
    air_pressure: float | None
    """Pressure of the air in Pa, for absorption and density; default 101325."""

class Numbers:
    @property
    def frequency(self) -> float:
        """Frequency f in Hz; by default the frequency of the array's board, or 40e3."""
    @property
    def sound_speed(self) -> float:
        """Sound speed c in m/s; by default that of the given temperature, else of 25 degrees C for a board, or 340."""
    @property
    def absorption(self) -> float:
        """Absorption alpha of the amplitude in Np/m; by default that of the given air, else of room air for a board, or 0."""
    @property
    def density(self) -> float:
        """Density rho in kg/m^3; by default that of the given air, else of room air for a board, or 1.223."""

class Parts(TypedDict, total=False):
    source_pressure: float | None
    """Pressure on the axis times distance, at full drive, in Pa m; by default that of the preset, or 4.386."""
    directivity: _Directivity | None
    """Directivity of a transducer: its name, or a table of the name and the parameter."""
    response: ArrayLike | None
    """Complex factor [re, im] of each transducer's pressure; 0 means that it is dead."""
    mask: ArrayLike | None
    """Whether each transducer is on; false means off."""
    channels: ArrayLike | None
    """Channel of each transducer, if several share one; by default that of the preset, or one for each transducer."""
    pins: ArrayLike | None
    """Channel of the boards that plays each transducer; by default the order of the transducers decides."""
    quantization: _Quantization | None
    """Phases and amplitudes that the board can play; by default those of the preset. {} allows any drive."""

class Keys(Air, Parts, total=False): ...

class Radiating:
    @property
    def source_pressure(self) -> float:
        """Pressure on the axis times distance, at full drive, in Pa m; by default that of the preset, or 4.386."""
    @property
    def directivity(self) -> _Directivity:
        """Directivity of a transducer: its name, or a table of the name and the parameter."""
    @property
    def response(self) -> NDArray[np.complex128] | None:
        """Complex factor [re, im] of each transducer's pressure; 0 means that it is dead."""
    @property
    def mask(self) -> NDArray[np.bool_]:
        """Whether each transducer is on; false means off."""
    @property
    def channels(self) -> NDArray[np.int64] | None:
        """Channel of each transducer, if several share one; by default that of the preset, or one for each transducer."""
    @property
    def pins(self) -> NDArray[np.int64] | None:
        """Channel of the boards that plays each transducer; by default the order of the transducers decides."""
    @property
    def quantization(self) -> dict[str, int | NDArray[np.float64] | None] | None:
        """Phases and amplitudes that the board can play; by default those of the preset. {} allows any drive."""

class _Request(Keys, total=False):
    signature: str | ArrayLike | Sequence[str | None] | None
    bead: Bead | Mapping[str, Any] | None
    obstacles: Iterable[Any] | None

class Changes(_Request, total=False):
    array: Array | None
    points: ArrayLike | None
    pressures: ArrayLike | None
    weights: ArrayLike | None
    plane: Plane | None

class Setting(_Request, total=False):
    positions: ArrayLike | None
    balance: bool | None
    aim: Literal["target", "max"] | None

class Uniform(TypedDict, total=False):
    """even points at the highest common level, |q| alike."""
    steps: int | None
    """Weighted Gerchberg-Saxton sweeps before the Gauss-Newton steps."""
    tolerance: float | None
    """Ends when no point is off the common level by more than this part of it."""
    quiet: float | None
    """Allowed leak of a quiet point, relative to the loudest point. It is divided by the point's weight, relative to the largest weight of a target."""
class SettingUniform(Setting, Uniform): ...

class Best(TypedDict, total=False):
    """the loudest even field from many starts."""
    starts: int | None
    """Number of start phases that are tried on the M x M matrix, at least 1. A single one is found as in `uniform`, without the seed."""
    steps: int | None
    """Weighted Gerchberg-Saxton sweeps from each of the four best starts."""
    tolerance: float | None
    """Ends when no point is off the common level by more than this part of it."""
    quiet: float | None
    """Allowed leak of a quiet point, relative to the loudest point. It is divided by the point's weight, relative to the largest weight of a target."""
    seed: int | None
    """Seed of the point phases, 0 to 2^64 - 1."""
class SettingBest(Setting, Best): ...

class Greedy(TypedDict, total=False):
    """greedy with brute-force search over phases and amplitudes."""
    phases: int | None
    """Phase quantization L, 2 to 65536, or a divisor of the device's: phases are 2 pi l/L."""
    amplitudes: int | None
    """Amplitude quantization K, 1 to 256: amplitudes are (k+1)/K or as many of the device's, never off."""
    objective: Literal["l2", "l1"] | Callable[[NDArray[np.complex64], NDArray[np.float64], NDArray[np.float64]], ArrayLike] | None
    """Objective: "l2" (squared errors, the paper's text) or "l1" (its authors' code)."""
    order: Literal["random", "rows", "columns"] | Sequence[int] | NDArray[np.integer] | None
    """Order of the updates: "random", "rows", "columns" or a permutation of 0..N."""
    seed: int | None
    """Seed of the random order, 0 to 2^64 - 1."""
    change: float | None
    """Largest change of a phase from a start drive, in rad, 0 or above; below 2 pi/phases no phase changes."""
    sweeps: int | None
    """Number of passes over all transducers, 1 to 1000. From the second on, each one is chosen again in the field of all others."""
class SettingGreedy(Setting, Greedy): ...

class Fast(TypedDict, total=False):
    """greedy in closed form: one sum instead of a search."""
    block: int | None
    """Number of transducers that are updated from the same field, 1 to 8."""
    sweeps: int | None
    """Further sweeps over all transducers, 0 to 1000."""
    seed: int | None
    """Seed of the order of the updates, 0 to 2^64 - 1."""
class SettingFast(Setting, Fast): ...

class Glide(TypedDict, total=False):
    """even points in motion, phases within a bound of the last frame's."""
    change: float | None
    """Largest change of a phase from the last frame to this one, in rad; pi or more leaves phases free."""
    tau: float | None
    """Time constant of the transducers' envelopes in s; 0 means no envelope."""
    rate: float | None
    """Frames a second; envelopes and traps in motion depend on it."""
    sweeps: int | None
    """Weighted Gerchberg-Saxton sweeps a frame."""
    steps: int | None
    """Largest number of Gauss-Newton steps a frame."""
class SettingGlide(Setting, Glide): ...

class Descent(TypedDict, total=False):
    """least squares over all phases: pictures, and more points than can be even."""
    steps: int | None
    """Largest number of steps of the best start."""
    tolerance: float | None
    """Ends when ten steps lower the error (the root of the residual) by less than this part of it."""
    starts: int | None
    """Number of starts, each followed for a fifth of the steps: a focus behind the points whose cone covers them, then one in front of them, then random phases. Points among the transducers start with all in phase instead."""
    seed: int | None
    """Seed of the random phases, 0 to 2^64 - 1."""
class SettingDescent(Setting, Descent): ...

class Lm(TypedDict, total=False):
    """Levenberg-Marquardt on all phases, |q| = 1."""
    steps: int | None
    """Largest number of steps."""
    tau: float | None
    """First damping relative to the largest diagonal entry of J^T J, above 0."""
    eps: float | None
    """Ends when the gradient, or the root mean square of a step in turns, is below this; 0 takes all steps."""
    seed: int | None
    """Seed of the random start phases, 0 to 2^64 - 1."""
class SettingLm(Setting, Lm): ...

class Gspat(TypedDict, total=False):
    """GS-PAT: Gerchberg-Saxton on the M x M matrix."""
    steps: int | None
    """Largest number of steps."""
    tolerance: float | None
    """Ends when no |p| changes by more than this part of its target in a step; 0 takes all steps."""
    limit: Literal["clamp", "normalize", "full"] | None
    """Rule that reduces drives above 1: "clamp", "normalize" or "full"."""
class SettingGspat(Setting, Gspat): ...

class Gs(TypedDict, total=False):
    """Gerchberg-Saxton, |q| = 1."""
    steps: int | None
    """Largest number of steps."""
    tolerance: float | None
    """Ends when no |p| changes by more than this part of its target in a step; 0 takes all steps."""
class SettingGs(Setting, Gs): ...

class Wgs(TypedDict, total=False):
    """weighted Gerchberg-Saxton, damped, |q| = 1, best iterate kept."""
    steps: int | None
    """Largest number of steps."""
    tolerance: float | None
    """Ends when 1 - uniformity is at most this; 0 takes all steps."""
class SettingWgs(Setting, Wgs): ...

class Evd(TypedDict, total=False):
    """leading eigenvector's phases, then a regularised solve."""
    gamma: float | None
    """Exponent of Long's regularising weights, 0 to 10."""
    limit: Literal["clamp", "normalize", "full"] | None
    """Rule that reduces drives above 1: "clamp", "normalize" or "full"."""
class SettingEvd(Setting, Evd): ...

class Sdp(TypedDict, total=False):
    """SDP relaxation of the point phases, then the pseudo-inverse."""
    steps: int | None
    """Largest number of random columns that are updated."""
    tolerance: float | None
    """Ends when no update of a column changes an entry of X by more than this; 0 takes all steps. The descent comes to rest only with lambda near 1, not with 0.9."""
    lambda_: float | None
    """Factor lambda in the update of a column, above 0 and below 1."""
    alpha: float | None
    """Damping of the pseudo-inverse in units of 1/mm^2 (at P0 = 1e-3 Pa m), above 0."""
    moduli: Literal["raw", "unit"] | None
    """Moduli of the eigenvector: "raw" (the paper's) or "unit"."""
    seed: int | None
    """Seed of the order of the columns, 0 to 2^64 - 1."""
    limit: Literal["clamp", "normalize", "full"] | None
    """Rule that reduces drives above 1: "clamp", "normalize" or "full"."""
class SettingSdp(Setting, Sdp): ...

class Bounded(TypedDict, total=False):
    """the least error of complex targets, to a proven tolerance."""
    steps: int | None
    """Largest number of steps."""
    tolerance: float | None
    """Ends when the error is proven to be within this part of the least possible one; 0 takes all steps."""
class SettingBounded(Setting, Bounded): ...

class Tikhonov(TypedDict, total=False):
    """regularised pseudo-inverse, target phases 0 unless given."""
    regularization: float | None
    """Damping relative to the mean of diag(G G^H), above 0."""
    limit: Literal["clamp", "normalize", "full"] | None
    """Rule that reduces drives above 1: "clamp", "normalize" or "full"."""
class SettingTikhonov(Setting, Tikhonov): ...

class Naive(TypedDict, total=False):
    """single foci, superposed."""
    limit: Literal["clamp", "normalize", "full"] | None
    """Rule that reduces drives above 1: "clamp", "normalize" or "full"."""
class SettingNaive(Setting, Naive): ...

class Every(TypedDict, total=False):
    """Options of all solvers, for the one that a scene file names."""
    steps: int | None
    tolerance: float | None
    quiet: float | None
    starts: int | None
    seed: int | None
    phases: int | None
    amplitudes: int | None
    objective: Literal["l2", "l1"] | Callable[[NDArray[np.complex64], NDArray[np.float64], NDArray[np.float64]], ArrayLike] | None
    order: Literal["random", "rows", "columns"] | Sequence[int] | NDArray[np.integer] | None
    change: float | None
    sweeps: int | None
    block: int | None
    tau: float | None
    rate: float | None
    eps: float | None
    limit: Literal["clamp", "normalize", "full"] | None
    gamma: float | None
    lambda_: float | None
    alpha: float | None
    moduli: Literal["raw", "unit"] | None
    regularization: float | None
class SettingEvery(Setting, Every): ...
