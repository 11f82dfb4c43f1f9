"""Pressures inside the frames: points on their way, transducers that take their time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene
from .blocks import blocks
from .envelope import Envelope
from .propagation import moduli, rows


class Between(NamedTuple):
    """Pressures inside the frames: `times` (S,) in s and |p| `pressures` (S, M) in Pa, S = T substeps."""

    times: NDArray[np.float64]
    pressures: NDArray[np.float64]


def between(
    scene: Scene,
    points: NDArray[np.float64],
    targets: NDArray[np.float64],
    envelope: Envelope,
    substeps: int,
) -> Between:
    """|p_j| = |sum_i G_ji y_i| at the times (t + k/substeps)/rate, points on straight lines between frames.

    A point stays where it is while it is not there in the next frame; so do all after an open end.
    """
    frames, count, _ = points.shape
    found = np.empty((frames, substeps, count))
    following = np.roll(points, -1, axis=0)
    gone = np.roll(targets, -1, axis=0) == 0
    if not envelope.closed:
        gone[-1] = True
    step = np.where(gone[..., None], 0.0, following - points)
    for part, steps, y in envelope.inside(substeps):
        shares = np.arange(steps.start, steps.stop) / substeps
        places = points[part, None] + shares[:, None, None] * step[part, None]
        # Rows of G are `count` times as many numbers as drives.
        for some in blocks(len(y), y[0].size * count):
            matrices = rows(scene, places[some], first=part.start + some.start)
            found[part.start + some.start : part.start + some.stop, steps] = moduli(matrices, y[some])
    times = np.arange(frames * substeps) / (substeps * envelope.rate)
    return Between(times, found.reshape(-1, count))
