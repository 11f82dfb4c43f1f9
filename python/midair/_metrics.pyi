"""How good answers are: part of the compiled core."""

from typing import Final, final

import numpy as np
from numpy.typing import NDArray

@final
class Metrics:
    accuracy: Final[float]
    sigma: Final[float]
    uniformity: Final[float]
    level: Final[float]
    residual: Final[float]
    leak: Final[float]
    def asdict(self) -> dict[str, float]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class BatchMetrics:
    accuracy: Final[NDArray[np.float64]]
    sigma: Final[NDArray[np.float64]]
    uniformity: Final[NDArray[np.float64]]
    level: Final[NDArray[np.float64]]
    residual: Final[NDArray[np.float64]]
    leak: Final[NDArray[np.float64]]
    def asdict(self) -> dict[str, NDArray[np.float64]]: ...
    def __eq__(self, other: object, /) -> bool: ...
