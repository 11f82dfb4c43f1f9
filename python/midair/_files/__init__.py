"""Files of other programs and of boards: arrays and drives. Each module here reads or writes one format."""

from .control_points import ControlPoints
from .reading import read, read_array
from .writing import write

__all__ = ["ControlPoints", "read", "read_array", "write"]
