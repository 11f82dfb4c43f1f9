"""The drives to play while microphones listen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, SceneError
from .._support.arguments import number, refused, whole

#: Phases of a device that has any.
PHASES = 256
#: Drives of more numbers than this are no calibration that somebody waits for.
MOST = 100_000_000


def calibration_drives(
    array: Array | Scene, readings_per_transducer: float = 4.0, *, microphones: int = 4, seed: int = 0
) -> NDArray[np.complex64]:
    """Drives (K, N) to play for `midair.calibrate`: full drive, random phases of the board.

    readings_per_transducer : K times the microphones over N; 4 of |p| or 2 complex ones are plenty
    microphones : how many listen
    seed : of the phases

    All transducers sound in every drive, which tells sqrt(N) times more of each than one at a time would
    at the same noise. Masked ones stay off.

    Raises SceneError for numbers that are not above 0 and an array whose transducers are all masked.

    >>> import midair
    >>> midair.calibration_drives(midair.Array.grid(16, 16, 10e-3)).shape
    (256, 256)
    """
    array = array.array if isinstance(array, Scene) else array
    if not isinstance(array, Array):
        raise refused("array", array, "give a midair.Array or a midair.Scene")
    wanted = number("readings_per_transducer", readings_per_transducer, above=0)
    listening, seed = whole("microphones", microphones, least=1), whole("seed", seed, least=0)
    played = np.flatnonzero(array.mask)
    if not len(played):
        raise SceneError("array is masked as a whole: unmask the transducers to be measured")
    count = int(np.ceil(wanted * len(played) / listening))
    if count * len(array) > MOST:
        cure = f"that makes {count} drives of {len(array)} transducers, give less"
        raise refused("readings_per_transducer", readings_per_transducer, cure)
    quantization = array.quantization or {}
    phases = int(quantization.get("phases") or PHASES)
    drives = np.zeros((count, len(array)), np.complex64)
    codes = np.random.default_rng(seed).integers(0, phases, (count, len(played)))
    drives[:, played] = np.exp(2j * np.pi * codes / phases)
    return drives
