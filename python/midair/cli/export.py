"""`midair export`: drives from one file into another, of any two formats."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..files import ControlPoints, read, write
from ..files.writing import ENDINGS
from .scene import check_outputs
from .tables import print_written


def export_command(
    drives: Path,
    output: Path,
    *,
    board: str | None = None,
    layout: str | None = None,
    modulate: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
) -> int:
    """Write the drives of a file in another format.

    Parameters
    ----------
    drives
        What midair solve, midair motion or another program wrote: .npz, .json, .csv, .holo or .bin.
    output
        Where they go, by the ending: .npz, .csv, .holo (AcousTools) or .bin (frames of a board).
    board
        The board whose frames a .bin holds: a name, such as sonicsurface, or a .pat file.
    layout
        Of a .csv: drive, acoustools, ultraino or points.
    modulate
        Of points, the frequency in Hz at which the device is to modulate them.
    """
    check_outputs((output, ENDINGS), taken=[drives])
    found = read(drives, board=board)
    if isinstance(found, ControlPoints) and layout is None:
        layout = "points"
    write(output, found, board=board, layout=layout, modulate=modulate)
    print_written(output)
    return 0
