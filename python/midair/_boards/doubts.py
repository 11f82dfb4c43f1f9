"""Doubts: what is sent and hardly meant, as real drives, rates that are too high and sequences left open."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .._motion import Sequence
from .._support.arguments import refused, warn
from .board import Board

#: Bounds and rates are compared to rounding.
ROUNDING = 1e-6


def refuse_real(drive: Any) -> None:
    """Refuse real numbers but -1, 0 and 1, which are plainly drives: others may be phases or codes."""
    given = np.asarray(drive)
    if given.dtype.kind in "iuf" and not np.isin(given, (-1, 0, 1)).all():
        cure = "give np.exp(1j * phases) of phases in rad, amplitudes + 0j where all phases are 0"
        raise refused("drive", given, f"real numbers are no drive: {cure}")


def warn_of_rate(rate: float, board: Board, skips: bool) -> None:
    """Warn of what a rate leaves out of a stream, and of a board that emits less while it receives."""
    steady = board.limits["steady_frames_per_second"]
    if rate > steady * (1 + ROUNDING) and steady < board.rate:
        warn(
            f"rate is {rate:g} frames/s: bytes stop the pins of {board.name}, which emits less above "
            f"{steady:.3g} frames/s, half of the amplitude at its full rate (docs/boards.md)"
        )
    if skips and rate > board.rate * (1 + ROUNDING):
        warn(
            f"rate is {rate:g} frames/s, {board.name} takes {board.rate:.4g}: {1 - board.rate / rate:.0%} "
            f'of the frames are left out; solve for at most {math.floor(board.rate)}, or give late="wait"'
        )


def warn_of_seam(sequence: Sequence) -> None:
    """Warn where phases jump beyond the bound between the last frame and the first."""
    drives = [sequence.drive(frame) for frame in (0, len(sequence) - 1)]
    jump = float(np.abs(np.angle(drives[0] * drives[1].conj())).max())
    bound = 0.0 if sequence.change is None else sequence.change
    if jump > bound * (1 + ROUNDING) and (sequence.change is not None or not sequence.closed):
        warn(
            f"sequence begins anew with a jump of {jump:.3g} rad each time: solve a closed path with "
            'ahead="all", or use stream'
        )
