"""Measurements as checked arrays. Errors state name, value and cure."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from .._support.arguments import refused
from .model import Complex, Real

#: Readings are rejected as clipped if at least 4 readings of a microphone, and 1 % of all, equal its maximum.
CLIPPED, CLIPPED_PART = 4, 0.01


def drives_of(value: Any, transducers: int) -> Complex:
    """Return drives (K, N) as complex128; rejects |q| > 1."""
    found = _numbers(
        "drives", value, f"give drives (K, {transducers}), as midair.calibration_drives makes them"
    )
    if found.ndim != 2 or found.shape[1] != transducers or not len(found):
        raise SceneError(f"drives have shape {found.shape}: give (K, {transducers}), a row for each drive")
    if np.abs(found).max() > 1 + 1e-5:
        raise SceneError(f"drives reach {np.abs(found).max():.4g}: 1 is full drive, give what was played")
    if not np.abs(found).max():
        raise SceneError("drives are all 0: nothing was played, give what was")
    return found.astype(np.complex128)


def readings_of(value: Any, drives: int, microphones: int, phased: bool | None) -> Real | Complex:
    """Check readings (K, M) in Pa: moduli, or complex if `phased`; None decides by their type."""
    found = _numbers("readings", value, f"give |p| or p of {drives} drives at {microphones} microphones")
    if found.ndim == 1 and microphones == 1:
        found = found[:, None]
    if found.shape != (drives, microphones):
        raise SceneError(
            f"readings have shape {found.shape}: give ({drives}, {microphones}), "
            "a row for each drive and a column for each microphone"
        )
    if phased and not np.iscomplexobj(found):
        raise SceneError("readings are real, but complex=True: give complex ones, or leave complex out")
    if phased is False:
        found = np.abs(found)
    if not np.iscomplexobj(found) and found.min() < 0:
        k, at = np.unravel_index(int(found.argmin()), found.shape)
        raise SceneError(
            f"readings[{k}, {at}] is {found[k, at]:.4g}: |p| is never negative, give moduli or complex ones"
        )
    for m, received in enumerate(found.T):
        if not np.abs(received).max():
            raise SceneError(
                f"readings[:, {m}] are all 0: microphone {m} hears nothing, mend it or leave it out"
            )
        _not_clipped(received, m)
    return found.astype(np.complex128) if np.iscomplexobj(found) else found.astype(np.float64)


def _not_clipped(received: NDArray[Any], m: int) -> None:
    parts = (received.real, received.imag) if np.iscomplexobj(received) else (received,)
    for part in parts:
        top = np.abs(part).max()
        many = int(np.sum(np.abs(part) > top * (1 - 1e-6)))
        if many >= max(CLIPPED, CLIPPED_PART * len(part)):
            raise SceneError(
                f"readings[:, {m}] are clipped: {many} of {len(part)} are {top:.4g} Pa, the largest value; "
                "measure at a lower intensity or farther away"
            )


def indices_of(value: Any, transducers: int) -> NDArray[np.intp]:
    """Check the second board's transducers (a slice, indices or a mask); return their indices."""
    if value is None:
        return np.zeros(0, np.intp)
    cure = f"give a slice, indices below {transducers} or a mask ({transducers},) of some of the transducers"
    try:
        found = np.arange(transducers)[value if isinstance(value, slice) else np.asarray(value)]
    except (IndexError, TypeError, ValueError):
        raise refused("second_board", value, cure) from None
    found = np.unique(found)
    if not 3 <= len(found) < transducers:
        raise refused("second_board", value, cure)
    return found


def _numbers(item: str, value: Any, cure: str) -> NDArray[Any]:
    try:
        found = np.asarray(value)
    except ValueError:
        raise SceneError(f"{item} are no array: {cure}") from None
    if found.dtype.kind not in "iufc":
        raise SceneError(f"{item} are no numbers: {cure}")
    if np.ma.isMaskedArray(value) and np.ma.is_masked(value):
        raise SceneError(f"{item} hide entries under a mask: leave out the whole drive instead")
    if not np.isfinite(found).all():
        place = ", ".join(map(str, np.argwhere(~np.isfinite(found))[0]))
        value = found[~np.isfinite(found)][0]
        raise SceneError(f"{item}[{place}] is {value}: give finite numbers, or leave out that drive")
    return found
