"""Computes drives from square waves, for the models of boards that make them."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.int64]
Levels = NDArray[np.bool]
Ticks = tuple[int, ...]
Complex = NDArray[np.complex128]


def edges(ticks: int | Ticks) -> Complex:
    """Returns e^{j phase} at the start of each tick of a period, and at the end of the last tick;
    `ticks` is the number of ticks or a list of their lengths.
    """
    lengths = np.ones(ticks) if isinstance(ticks, int) else np.array(ticks)
    return np.exp(2j * np.pi * np.r_[0, np.cumsum(lengths)] / lengths.sum())


def harmonic(levels: Levels, ticks: Ticks | None = None) -> Complex:
    """Returns the drive of each channel from its pin's levels (ticks, channels) over a period.

    An output s(t) = Re q e^{-jwt} has q = (2/T) integral of s e^{jwt}; the scale makes a half-period pulse
    1.
    """
    return np.diff(edges(ticks or len(levels))) / 2j @ levels


def pulses(starts: Codes, widths: Codes, ticks: int | Ticks) -> Complex:
    """Returns the drives of pulses that start at tick `starts` and last `widths` ticks of a period."""
    return _pulses(ticks)[np.ravel(starts), np.ravel(widths)]


@cache
def _pulses(ticks: int | Ticks) -> Complex:
    begins = edges(ticks)[:-1]
    every = np.arange(len(begins))
    return (begins[(every[:, None] + every) % len(begins)] - begins[:, None]) / 2j
