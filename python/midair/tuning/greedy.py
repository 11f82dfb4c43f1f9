"""The paper's greedy search with readings in place of a simulation."""

from __future__ import annotations

import numpy as np

from .player import Complex, Indices, Player

#: A later candidate wins only if it is better by more than rounding, as in `greedy` (docs/conventions.md).
ROUNDING = 1e-7


def greedy(player: Player, drive: Complex, order: Indices, phases: int, tries: bool) -> None:
    """One transducer after another takes the phase whose pressures come nearest, all others as they are.

    At any place |p|^2 of a transducer's phase phi is a + b cos phi + c sin phi: three readings determine
    it at every phase. `tries` reads each of the L phases instead, as the paper has it.
    """
    turns = 2 * np.pi * np.arange(phases) / phases
    heard = np.arange(phases) if tries or phases <= 3 else np.round(np.arange(3) * phases / 3).astype(int)
    waves = np.stack([np.ones(phases), np.cos(turns), np.sin(turns)], axis=1)
    # From the phases heard to all of them.
    spread = np.eye(phases) if len(heard) == phases else waves @ np.linalg.inv(waves[heard])
    drive = drive.copy()
    for index in order:
        powers = []
        for phase in heard:
            drive[index] = np.exp(1j * turns[phase])
            powers.append(player(drive) ** 2)
        pressures = np.sqrt(np.maximum(spread @ np.array(powers), 0.0))
        values = np.array([player.value(each) for each in pressures])
        chosen = int(np.flatnonzero(values <= values.min() + ROUNDING * max(values.max(), 1.0))[0])
        drive[index] = np.exp(1j * turns[chosen])
        player.offer(drive, pressures[chosen])
        player.trace.append(float(values[chosen]))
