"""Measurements as checked arrays. Errors state name, value and cure."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import numbers, stated
from .._support.arguments import SMALLEST, refused, sized
from .model import Complex, Real

#: Readings are rejected as clipped if at least 4 readings of a microphone, and 1 % of all, equal its maximum.
CLIPPED, CLIPPED_PART = 4, 0.01


def drives_of(value: Any, transducers: int) -> Complex:
    """Return drives (K, N) as complex128; rejects |q| > 1."""
    cure = f"give drives (K, {transducers}), as midair.calibration_drives makes them"
    found = numbers("drives", value, [(-1, transducers)], cure, kinds="iufc", most=1 + 1e-5)
    if not found.any():
        raise stated("drives", "are all 0", "nothing was played, give what was")
    return found.astype(np.complex128)


def readings_of(value: Any, drives: int, microphones: int, phased: bool | None) -> Real | Complex:
    """Check readings (K, M) in Pa: moduli, or complex if `phased`; None decides by their type."""
    shapes = [(drives, microphones), (drives,)][: 2 if microphones == 1 else 1]
    cure = f"give |p| or p ({drives}, {microphones}), a row for each drive and a column for each microphone"
    found = sized("readings", numbers("readings", value, shapes, cure, kinds="iufc")).reshape(
        drives, microphones
    )
    if phased and not np.iscomplexobj(found):
        cure = "give complex ones, or leave complex out"
        raise stated("readings", "are real, but complex=True", cure, code="conflict")
    if phased is False:
        found = np.abs(found)
    if not np.iscomplexobj(found) and found.min() < 0:
        k, at = np.unravel_index(int(found.argmin()), found.shape)
        cure = "|p| is never negative, give moduli or complex ones"
        raise stated(f"readings[{k}, {at}]", f"is {found[k, at]:.4g}", cure)
    for m, received in enumerate(found.T):
        if np.abs(received).max() < SMALLEST:
            raise stated(
                f"readings[:, {m}]", "are all 0", f"microphone {m} hears nothing, mend it or leave it out"
            )
        _not_clipped(received, m)
    return found


def _not_clipped(received: NDArray[Any], m: int) -> None:
    parts = (received.real, received.imag) if np.iscomplexobj(received) else (received,)
    for part in parts:
        top = np.abs(part).max()
        many = int(np.sum(np.abs(part) > top * (1 - 1e-6)))
        if many >= max(CLIPPED, CLIPPED_PART * len(part)):
            reason = f"{many} of {len(part)} are {top:.4g} Pa, the largest value"
            cure = f"{reason}; measure at a lower intensity or farther away"
            raise stated(f"readings[:, {m}]", "are clipped", cure)


def indices_of(value: Any, transducers: int) -> NDArray[np.intp]:
    """Check the second board's transducers (a slice, indices or a mask); return their indices."""
    if value is None:
        return np.zeros(0, np.intp)
    cure = f"give a slice, indices below {transducers} or a mask ({transducers},) of some of the transducers"
    try:
        if not isinstance(value, slice):
            value = numbers("second_board", value, [(-1,)], cure, kinds="iub", copy=False)
        found = np.arange(transducers)[value]
    except (IndexError, TypeError):
        raise refused("second_board", value, cure) from None
    found = np.unique(found)
    if not 3 <= len(found) < transducers:
        raise refused("second_board", value, cure)
    return found
