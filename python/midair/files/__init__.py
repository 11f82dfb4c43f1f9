"""Files of other programs and of boards: arrays and drives, each format a file here; docs/boards.md."""

from .arrays import read_array

__all__ = ["read_array"]
