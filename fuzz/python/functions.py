"""Arguments of motion, touch, measuring and gradients: unusual values give one line of error or an answer."""

import sys
from pathlib import Path
from typing import Any

from guided import REFUSALS, Data, fuzz, odd, refused

sys.path.append(str(Path(__file__).resolve().parents[2] / "python" / "tests"))
from absurd import CALLS

#: Arguments whose cost grows with their value, each with the largest value that is cheap.
COSTS = {"rate": 60, "temperature": 99, "duration": 0.02, "budget": 50, "seconds": 20, "readings_per_transducer": 5}


def cheap(name: str, value: Any) -> Any:
    """Returns the value, or the largest cheap one if it costs more."""
    most = COSTS.get(name.rpartition(", ")[2])
    return most if most and isinstance(value, int | float) and most < value < 1e90 else value


def test(content: bytes) -> None:
    data = Data(content)
    name = data.PickValueInList(list(CALLS))
    try:
        CALLS[name](cheap(name, odd(data)))
    except (*REFUSALS, MemoryError) as error:
        refused(error)


fuzz(test)
