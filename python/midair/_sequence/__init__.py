"""Sequences: frames that follow one another, their solution, metrics, pictures and files."""

from .felt import Felt
from .judged import SequenceMetrics
from .multiplex import multiplex
from .sequence import Sequence
from .solve import sequence, stream

__all__ = ["Felt", "Sequence", "SequenceMetrics", "multiplex", "sequence", "stream"]
