"""Measuring: calibration of arrays by microphones, diagnosis of faults, and drives found by readings."""
