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
    """The best drive (N,) that `midair.tune` found, and what is read with it."""

    drive: NDArray[np.complex64]
    #: |p| (M,) with it, as read or as three readings determine it.
    pressures: NDArray[np.float64]
    #: How far it is from what was asked: the residual of eq. (7) over silence's; feedback: 1 - uniformity.
    value: float
    #: How often was read.
    readings: int
    status: Status
    #: What the reader raised, if it did.
    error: Exception | None
    #: The value after each turn, step or reading.
    trace: NDArray[np.float64]
