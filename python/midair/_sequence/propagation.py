"""Propagation to moving points: rows of G, |p| of each frame's drive at its points and between frames."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, SceneError, restated
from .._support.arguments import without_warnings
from .drives import Drives, blocks
from .envelope import Envelope

#: Largest number of entries of G in one block behind obstacles or with a signature, where the core stores
#: them in double precision.
MOST_KEPT = 1 << 17


def rows(
    scene: Scene, points: NDArray[np.float64], name: str = "points", first: int = 0
) -> NDArray[np.complex64]:
    """Return rows of G (..., N) at points (..., 3) in a scene. Errors number the points from `first`."""
    shape, flat = points.shape[:-1], points.reshape(-1, 3)
    kept = scene.obstacles or scene.signature is not None
    part = max(MOST_KEPT // len(scene.array), 1) if kept else len(flat)
    # A list of signatures has one entry for each point of a frame.
    names = scene.signature if isinstance(scene.signature, list) else None
    blocks = []
    with without_warnings():
        # The scene itself has already warned of probable mistakes.
        for start in range(0, len(flat), part):
            try:
                changes: dict[str, Any] = {"points": flat[start : start + part]}
                if names is not None:
                    order = range(start, start + len(changes["points"]))
                    changes["signature"] = [names[k % len(names)] for k in order]
                blocks.append(scene.replace(**changes).propagation())
            except SceneError as error:
                if error.index is None or not error.item.startswith("points"):
                    raise
                index = [int(k) for k in np.unravel_index(start + error.index, shape)]
                index[0] += first
                rest = error.item.removeprefix(f"points[{error.index}]")
                raise restated(error, item=f"{name}{index}{rest}", index=index[0]) from None
    return np.concatenate(blocks).reshape(*shape, -1)


def pressures(scene: Scene, points: NDArray[np.float64], drives: Drives) -> NDArray[np.float64]:
    """Return |p| (T, M) in Pa: p_j(t) = sum_i G_ji(t) q_i(t)."""
    frames, count, _ = points.shape
    found = np.empty((frames, count))
    for part in blocks(frames, count * len(scene.array)):
        found[part] = moduli(rows(scene, points[part], first=part.start), drives[part])
    return found


def moduli(matrices: NDArray[np.complex64], drives: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Return |p| (..., M) for matrices G (..., M, N) and drives (..., N)."""
    found: NDArray[np.float32] = np.abs(np.matmul(matrices, drives[..., None])[..., 0])
    return found


class Between(NamedTuple):
    """Pressures between frames: `times` (S,) in s and |p| `pressures` (S, M) in Pa, S = T substeps."""

    times: NDArray[np.float64]
    pressures: NDArray[np.float64]


def between(
    scene: Scene, points: NDArray[np.float64], targets: NDArray[np.float64], envelope: Envelope, substeps: int
) -> Between:
    """Return |p_j| = |sum_i G_ji y_i| at (t + k/substeps)/rate; points move linearly between frames.

    A point that is absent in the next frame does not move. Neither do the points after the end of an open
    sequence.
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
        # G has `count` times as many numbers as the drives, so it is computed in smaller blocks.
        for some in blocks(len(y), y[0].size * count):
            matrices = rows(scene, places[some], first=part.start + some.start)
            found[part.start + some.start : part.start + some.stop, steps] = moduli(matrices, y[some])
    times = np.arange(frames * substeps) / (substeps * envelope.rate)
    return Between(times, found.reshape(-1, count))
