"""Drives of square waves, for the models of boards that make them."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.int64]
Levels = NDArray[np.bool]
Complex = NDArray[np.complex128]


def harmonic(levels: Levels) -> Complex:
    """The drive of each channel from its pin's levels (ticks, channels) over a period.

    An output s(t) = Re q e^{-jwt} has q = (2/T) integral of s e^{jwt}; a square wave of half a period is 1.
    """
    ticks = len(levels)
    middles = np.exp(2j * np.pi * (np.arange(ticks) + 0.5) / ticks)
    return np.sin(np.pi / ticks) * (middles @ levels)


def pulses(starts: Codes, widths: Codes, ticks: int) -> Complex:
    """The drive of pulses that go high at tick `start` for `width` ticks of a period."""
    return _pulses(ticks)[np.ravel(starts), np.ravel(widths)]


@cache
def _pulses(ticks: int) -> Complex:
    from_zero = harmonic(np.tri(ticks, k=-1, dtype=bool).T)
    return np.exp(2j * np.pi * np.arange(ticks)[:, None] / ticks) * from_zero
