"""Measuring: calibration of an array by readings, and drives that readings improve."""

from .calibrate import calibrate, calibration_drives
from .doctor import Fault, Report, doctor
from .player import Tuning
from .result import Calibration
from .tune import tune

__all__ = ["Calibration", "Fault", "Report", "Tuning", "calibrate", "calibration_drives", "doctor", "tune"]
