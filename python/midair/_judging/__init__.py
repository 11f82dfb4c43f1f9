"""`midair.tolerate`: what is left of a solution when array and air are not as the scene says."""

from .tolerance import Kept, Tolerance
from .tolerate import Trials, tolerate

__all__ = ["Kept", "Tolerance", "Trials", "tolerate"]
