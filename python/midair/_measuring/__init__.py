"""Measuring: an array as its readings have it, and drives that readings steer."""

from .calibrate import calibrate, calibration_drives
from .doctor import Fault, Report, doctor
from .player import Tuning
from .result import Calibration
from .tune import tune

__all__ = ["Calibration", "Fault", "Report", "Tuning", "calibrate", "calibration_drives", "doctor", "tune"]
