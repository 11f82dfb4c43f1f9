"""Motion: sequences of frames, and their effect on moving points, on skin and on levitated beads."""

from .felt import Felt
from .fly import fly
from .judged import SequenceMetrics
from .sequence import Flight, Sequence
from .skin import Skin, skin
from .solve import sequence, stream

__all__ = ["Felt", "Flight", "Sequence", "SequenceMetrics", "Skin", "fly", "sequence", "skin", "stream"]
