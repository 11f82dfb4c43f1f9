"""Simultaneous perturbation: all phases nudged at once, two readings a step."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .player import Complex, Drive, Player, Real

#: Step (rad a unit of value) and nudge (rad) at first, and how they fall (Spall 1998, IEEE TAES 34, 817).
STEP, NUDGE = 4.0, 0.4
STEP_FALLS, NUDGE_FALLS, DELAY = 0.602, 0.101, 0.1


def spsa(player: Player, drive: Complex, steps: int, seed: int, on_board: Callable[[Real], Drive]) -> None:
    """Phi <- phi - a_k (f(phi + c_k d) - f(phi - c_k d)) / (2 c_k) d with signs d at random."""
    rng = np.random.default_rng(seed)
    phases = np.angle(drive).astype(np.float64)
    for k in range(steps):
        nudge = NUDGE / (k + 1) ** NUDGE_FALLS
        step = STEP / (k + 1 + DELAY * steps) ** STEP_FALLS * (DELAY * steps) ** STEP_FALLS
        signs = rng.choice([-1.0, 1.0], len(phases))
        values = [player.value(player(on_board(phases + sign * nudge * signs))) for sign in (1.0, -1.0)]
        phases -= step * (values[0] - values[1]) / (2 * nudge) * signs
        player.trace.append(min(values))
    player(on_board(phases))
