"""Tracks over a whole sequence, found by the core, and the amplitudes that bring them down to the targets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, tracks
from ..shape.arguments import refused
from .drives import Drives
from .propagation import pressures
from .request import Request

#: Phases where the board has any.
PHASES = 256

#: Rounds of tracks, point phases and weights: after ten the level grows by less than a thousandth a round.
ROUNDS = 10


def whole(
    asked: Request, solver: str, progress: Callable[[int, int], object] | None
) -> tuple[NDArray[Any], dict[str, Any]]:
    """Codes (T, N) of the best tracks within the bound, or drives of them, and the board that they are of."""
    if solver != "glide":
        raise refused("solver", solver, 'with ahead="all" the tracks are found by themselves, leave it out')
    if unknown := asked.options.keys() - {"quantization"}:
        name = min(unknown)
        raise refused(name, asked.options[name], 'ahead="all" has no such option, leave it out')
    board = asked.board
    scene = Scene(asked.array, asked.points[0], **asked.air)
    codes = tracks(
        scene,
        asked.points,
        asked.targets,
        change=asked.change,
        phases=board.get("phases") or PHASES,
        closed=asked.closed,
        rounds=ROUNDS,
        progress=None if progress is None else lambda step, steps, _: progress(step, steps),
    )
    board["phases"] = board.get("phases") or PHASES
    if asked.aim == "max":
        return codes, board
    live = (
        asked.array.mask if asked.array.response is None else asked.array.mask & (asked.array.response != 0)
    )
    full = Drives(codes, live, board["phases"])
    got = pressures(scene, asked.points, full)
    with np.errstate(divide="ignore", invalid="ignore"):
        over = np.where(asked.targets > 0, got / asked.targets, 0).max(axis=1)
    lower = np.minimum(1.0, 1.0 / np.maximum(over, 1e-12)) * (asked.targets > 0).any(axis=1)
    if board.get("amplitudes") is not None:
        table = np.asarray(board["amplitudes"])
        lower = np.r_[0.0, table][np.searchsorted(table, lower * (1 + 1e-9), side="right")]
    return full[:] * lower[:, None].astype(np.float32), board
