"""Motion: sequences of frames in time, and what the points and a hand get of them."""

from .felt import Felt
from .judged import SequenceMetrics
from .sequence import Sequence
from .skin import Skin, skin
from .solve import sequence, stream

__all__ = ["Felt", "Sequence", "SequenceMetrics", "Skin", "sequence", "skin", "stream"]
