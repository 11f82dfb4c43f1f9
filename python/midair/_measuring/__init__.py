"""Measuring: calibration of an array by microphone readings, fault diagnosis, and drives optimised by
readings.
"""

from .calibrate import calibrate, calibration_drives
from .doctor import doctor
from .player import Fault, Report, Tuning
from .result import Calibration
from .tune import tune

__all__ = ["Calibration", "Fault", "Report", "Tuning", "calibrate", "calibration_drives", "doctor", "tune"]
