"""Propagation to points that move: rows of G block by block, and |p| of each frame's drive at its points."""

from __future__ import annotations

import re
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, SceneError, SceneWarning
from .drives import Drives, blocks
from .envelope import Envelope

#: Entries of G at once behind obstacles, where it is kept in double precision.
MOST_KEPT = 1 << 17


def rows(
    scene: Scene, points: NDArray[np.float64], name: str = "points", first: int = 0
) -> NDArray[np.complex64]:
    """G (..., N) at points (..., 3) in a scene's air; an error names the point, the first being `first`."""
    shape, flat = points.shape[:-1], points.reshape(-1, 3)
    part = max(MOST_KEPT // len(scene.array), 1) if scene.obstacles else len(flat)
    blocks = []
    with warnings.catch_warnings():
        # The scene itself has reported probable mistakes.
        warnings.simplefilter("ignore", SceneWarning)
        for start in range(0, len(flat), part):
            try:
                blocks.append(scene.replace(points=flat[start : start + part]).propagation())
            except SceneError as error:
                found = re.match(r"points\[(\d+)\](.*)", str(error))
                if found is None:
                    raise
                index = list(np.unravel_index(start + int(found[1]), shape))
                index[0] += first
                raise SceneError(f"{name}[{', '.join(map(str, index))}]{found[2]}") from None
    return np.concatenate(blocks).reshape(*shape, -1)


def pressures(scene: Scene, points: NDArray[np.float64], drives: Drives) -> NDArray[np.float64]:
    """|p| (T, M) in Pa: p_j(t) = sum_i G_ji(t) q_i(t)."""
    frames, count, _ = points.shape
    found = np.empty((frames, count))
    for part in blocks(frames, count * len(scene.array)):
        found[part] = moduli(rows(scene, points[part], first=part.start), drives[part])
    return found


def moduli(matrices: NDArray[np.complex64], drives: NDArray[np.complex64]) -> NDArray[np.float32]:
    """|p| (..., M) by matrices (..., M, N) and drives (..., N)."""
    found: NDArray[np.float32] = np.abs(np.matmul(matrices, drives[..., None])[..., 0])
    return found


class Between(NamedTuple):
    """Pressures inside the frames: `times` (S,) in s and |p| `pressures` (S, M) in Pa, S = T substeps."""

    times: NDArray[np.float64]
    pressures: NDArray[np.float64]


def between(
    scene: Scene, points: NDArray[np.float64], targets: NDArray[np.float64], envelope: Envelope, substeps: int
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
