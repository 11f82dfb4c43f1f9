"""Arrays as they are: responses, sound speed and places from what microphones read."""

from .calibrate import calibrate
from .drives import calibration_drives
from .result import Calibration

__all__ = ["Calibration", "calibrate", "calibration_drives"]
