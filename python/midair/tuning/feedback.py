"""Targets corrected by what is read, the model solved again."""

from __future__ import annotations

import warnings
from typing import Literal

import numpy as np

from .._midair import Scene, SceneWarning, solve, solver_name, solvers
from ..shape.arguments import word
from .player import Player, Real

#: How much of a deviation is corrected at once.
POWER = 0.7
#: Quieter than this part of the mean, a place would be corrected without end.
QUIETEST = 0.1


def feedback(player: Player, scene: Scene, targets: Real, solver: str, steps: int) -> None:
    """t_j <- t_j (mean x / x_j)^0.7 with x_j = |p_j| / target_j as read, the scene solved for t.

    The camera feedback of slmsuite. It evens out and gains no level: the model stays as it is.
    """
    # Ratios are what is corrected: those that can aim give their loudest at them.
    aim: Literal["max"] | None = "max" if solvers()[solver_name(word("solver", solver))].uses_aim else None
    wanted = targets.copy()
    asked = targets > 0
    for step in range(steps):
        with warnings.catch_warnings():
            if step:
                # What nobody asked for is nothing to warn of.
                warnings.simplefilter("ignore", SceneWarning)
            drive = solve(scene.replace(pressures=wanted), solver, aim=aim).drive
        pressures = player(drive)
        player.trace.append(player.value(pressures))
        x = pressures[asked] / targets[asked]
        mean = x.mean()
        if mean == 0:
            return
        wanted[asked] *= (mean / np.maximum(x, QUIETEST * mean)) ** POWER
        wanted[asked] *= targets[asked].mean() / wanted[asked].mean()
