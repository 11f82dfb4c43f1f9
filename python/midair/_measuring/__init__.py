"""Measuring: calibration of arrays by microphones, diagnosis of faults, and drives found by readings."""

from .calibrate import calibrate, calibration_drives
from .doctor import doctor
from .player import Fault, Report, Tuning
from .result import Calibration
from .tune import tune

__all__ = ["Calibration", "Fault", "Report", "Tuning", "calibrate", "calibration_drives", "doctor", "tune"]
