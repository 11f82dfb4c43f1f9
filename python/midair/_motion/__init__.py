"""Motion: sequences of frames in time, and their effect on points, hands and beads."""

from .felt import Felt
from .fly import fly
from .judged import SequenceMetrics
from .sequence import Flight, Sequence
from .skin import Skin, skin
from .solve import sequence, stream

__all__ = ["Felt", "Flight", "Sequence", "SequenceMetrics", "Skin", "fly", "sequence", "skin", "stream"]
