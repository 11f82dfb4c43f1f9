"""Arguments of a sequence: each function converts one to arrays and numbers, or rejects it."""

from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, SceneError, numbers, restated, stated
from .._support.arguments import number, refused, warn, whole
from .envelope import Hold

#: Largest plausible time constant in s; transducers of 40 kHz have 0.1 to 1 ms.
SLOWEST = 20e-3


def points(given: Any) -> NDArray[np.float64]:
    """Return points (T, M, 3) in m: M points in each of T frames."""
    return numbers("points", given, [(-1, -1, 3)], "give (T, M, 3) in m, M places in each of T frames")


def instants(given: Any) -> NDArray[np.float64]:
    """Return times (T,) in s."""
    return numbers("times", given, [(-1,), (0,)], "give a list of finite times in s")


def targets(given: Any, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Return targets (T, M) in Pa. A single number or (M,) values apply to all frames."""
    cure = f"give {shape} in Pa like the points, ({shape[1]},) or one number, 0 for not there"
    found = numbers("targets", given, [shape, shape[1:], ()], cure, least=0)
    if not found.any():
        raise stated("targets", "are 0 everywhere", "give a pressure above 0 in at least one frame")
    return np.broadcast_to(found, shape)


def frames(what: str, count: int, expected: int) -> None:
    """Reject an array with another number of frames than the points have."""
    if count != expected:
        raise refused(f"{what}.shape[0]", count, f"points have {expected} frames, give as many")


def quantization(given: Any, array: Array) -> dict[str, Any] | None:
    """Return a board's quantization in the form of `Array.quantization`: the given one, else the array's."""
    if given is None:
        return array.quantization
    try:
        return Array.grid(1, 1, 0.01, quantization=given).quantization
    except SceneError as error:
        raise restated(error, item=error.item.removeprefix("array.")) from None


def time_constant(given: Any) -> float:
    """Return a time constant tau in s; 0 means that transducers follow their drives at once."""
    tau = number("tau", given, least=0)
    if tau > SLOWEST:
        warn(f"tau is {tau:g} s, longer than of any transducer: give {tau * 1e-3:g} if ms are meant")
    return tau


def hold(given: Any) -> Hold:
    """Return how a board changes its phases between frames: "hold" or "linear"."""
    if not isinstance(given, str) or given not in get_args(Hold):
        raise refused("hold", given, 'give "hold" or "linear"')
    return "hold" if given == "hold" else "linear"


def substeps(given: Any) -> int:
    """Return the number of sub-steps per frame."""
    return whole("substeps", given, least=1)


def places(given: Any) -> NDArray[np.float64]:
    """Return one place (3,) or the places (K, 3) of a patch, in m, as (K, 3)."""
    return numbers("place", given, [(3,), (-1, 3)], "give (3,) in m, or (K, 3) for a patch").reshape(-1, 3)


def bands(given: Any) -> tuple[tuple[float, float], ...]:
    """Return frequency bands as pairs (low, high) in Hz."""
    try:
        found = [(band[0], band[1]) for band in given if len(band) == 2]
        whole = len(found) == len(given)
    except TypeError:
        found, whole = [], False
    if not whole:
        raise refused("bands", given, "give pairs (low, high) in Hz")
    read = []
    for k, (low, high) in enumerate(found):
        low, high = number(f"bands[{k}][0]", low, above=0), number(f"bands[{k}][1]", high, above=0)
        if not low < high:
            raise refused(f"bands[{k}]", (low, high), "give low < high, in Hz")
        read.append((low, high))
    return tuple(read)
