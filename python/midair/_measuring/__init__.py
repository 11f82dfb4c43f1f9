"""Measuring: an array as its readings have it, and drives that readings steer."""

from .calibrate import calibrate, calibration_drives
from .player import Tuning
from .result import Calibration
from .tune import tune

__all__ = ["Calibration", "Tuning", "calibrate", "calibration_drives", "tune"]
