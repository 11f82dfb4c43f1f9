"""Sequences: frames that follow one another, their solution, metrics, pictures and files."""

from .felt import Felt
from .frames import SequenceMetrics
from .sequence import Sequence
from .solve import multiplex, sequence, stream

__all__ = ["Felt", "Sequence", "SequenceMetrics", "multiplex", "sequence", "stream"]
