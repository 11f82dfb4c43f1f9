"""Sequences: frames that follow one another, their solution, metrics, pictures and files."""

from .felt import Felt
from .judged import SequenceMetrics
from .sequence import Sequence
from .solve import sequence, stream

__all__ = ["Felt", "Sequence", "SequenceMetrics", "sequence", "stream"]
