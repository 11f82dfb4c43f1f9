"""Motion: sequences of frames in time, and what the points, a hand and beads get of them."""

from .felt import Felt
from .fly import Flight, fly
from .judged import SequenceMetrics
from .sequence import Sequence
from .skin import Skin, skin
from .solve import sequence, stream

__all__ = ["Felt", "Flight", "Sequence", "SequenceMetrics", "Skin", "fly", "sequence", "skin", "stream"]
