"""Drives by readings in place of a model: a microphone or camera in the loop."""

from .result import Tuning
from .tune import tune

__all__ = ["Tuning", "tune"]
