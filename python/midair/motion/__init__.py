"""Motion: sequences of frames in time, and what the points and a hand get of them."""

from .sequence import Sequence

__all__ = ["Sequence"]
