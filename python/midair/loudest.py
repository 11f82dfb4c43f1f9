"""The loudest place of a box: a grid that is fine enough, then a search about its loudest samples."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .shape.arguments import refused

Points: TypeAlias = NDArray[np.float64]
Levels: TypeAlias = Callable[[Points], NDArray[np.float64]]

#: Samples a wavelength. No part of p is shorter than that, so that at a distance d from its maximum P, |p| is
#: at least P cos(k d) (Duffin and Schaeffer 1938): half a cell's diagonal hides 2.2 dB, before the search.
FINE = 8

#: Points taken at once, so that Ctrl-C is heard between them, and most of a box.
BLOCK, MOST = 100_000, 20_000_000

#: Samples from which the search starts, how far apart in wavelengths, and how often it halves its step.
STARTS, APART, HALVINGS = 32, 0.25, 5

#: Loudest samples among which the starts are looked for: of one peak there are some 60.
SAMPLES = 4000


def loudest(name: str, low: Points, high: Points, wavelength: float, levels: Levels) -> tuple[Points, float]:
    """Where in a box between two corners `levels` of points (P, 3) is largest, and how large it is there."""
    step = wavelength / FINE
    counts = np.ceil((high - low) / step * (1 - 1e-9)).astype(int) + 1
    total = int(np.prod(counts, dtype=float))
    if total > MOST:
        sides = " x ".join(f"{side:.3g}" for side in high - low)
        cure = f"that is {total} points an eighth of a wavelength apart, give a box of at most {MOST}"
        raise refused(f'places["{name}"]', f"{sides} m", cure)
    axes = [np.linspace(*ends) for ends in zip(low, high, counts, strict=True)]
    starts, values = np.empty((0, 3)), np.empty(0)
    for first in range(0, total, BLOCK):
        cells = np.unravel_index(np.arange(first, min(first + BLOCK, total)), counts)
        points = np.stack([axis[cell] for axis, cell in zip(axes, cells, strict=True)], axis=1)
        points, found = np.r_[starts, points], np.r_[values, levels(points)]
        kept = _peaks(points, found, APART * wavelength)
        starts, values = points[kept], found[kept]
    around = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    for _ in range(HALVINGS):
        step /= 2
        tried = np.clip(starts[:, None] + step * around, low, high)
        found = levels(tried.reshape(-1, 3)).reshape(tried.shape[:2])
        best = found.argmax(axis=1)[:, None]
        starts = np.take_along_axis(tried, best[..., None], axis=1)[:, 0]
        values = np.take_along_axis(found, best, axis=1)[:, 0]
    first = int(values.argmax())
    return starts[first], float(values[first])


def _peaks(points: Points, values: NDArray[np.float64], apart: float) -> NDArray[np.int64]:
    """Indices of the loudest points, each so far from all louder ones that are taken."""
    left = np.argpartition(-values, SAMPLES)[:SAMPLES] if len(values) > SAMPLES else np.arange(len(values))
    left = left[np.argsort(-values[left], kind="stable")]
    taken: list[int] = []
    while len(left) and len(taken) < STARTS:
        taken.append(int(left[0]))
        left = left[np.linalg.norm(points[left] - points[left[0]], axis=1) > apart]
    return np.array(taken, dtype=np.int64)
