"""What came of tuning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

#: How tuning ended: to its end, out of readings, stopped by Ctrl-C or progress, or by an error of the reader.
Status = Literal["done", "out_of_readings", "stopped", "failed"]


@dataclass(frozen=True, eq=False)
class Tuning:
    """The best drive that `midair.tune` found, and what is read with it.

    drive : (N,), complex of |q| <= 1
    pressures : (M,) |p| with it, as read or as three readings determine it
    value : how far it is from what was asked: the residual of eq. (7) over silence's;
        feedback: 1 - uniformity
    readings : how often was read
    status : "done", "stopped", "out_of_readings" or "failed"
    error : what the reader raised, if it did
    trace : the value after each turn, step or reading
    """

    drive: NDArray[np.complex64]
    pressures: NDArray[np.float64]
    value: float
    readings: int
    status: Status
    error: Exception | None
    trace: NDArray[np.float64]
