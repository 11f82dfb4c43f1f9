"""Metrics of a sequence: how loud, even and quiet it is, and how far the transducers turn."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

#: What each metric means, with its unit.
MEANINGS = {
    "level": "mean over the frames of the mean of |p| / target",
    "uniformity": "least over the frames of min / max of |p| / target",
    "uniformity_median": "median over the frames of the same",
    "largest_change": "largest phase change from a frame to the next, rad",
    "seam": "largest phase change from the last frame to the first, rad",
    "dip": "least |p| / target of a point over its mean",
    "noise": "A-weighted proxy, dB re amplitude modulation at 200 Hz",
}


@dataclass(frozen=True)
class SequenceMetrics:
    """How good a sequence is, over the points that are there, x_j(t) = |p_j(t)| / target_j(t).

    level : mean over time of mean_j x_j
    uniformity, uniformity_median : least and median over time of min_j x_j / max_j x_j
    largest_change : of the phase of any transducer from a frame to the next, in rad; the seam is not counted
    seam : largest change from the last frame to the first, in rad; None where the sequence is open
    dip : least over time and points of x_j over its mean over time
    noise : dB re full amplitude modulation at 200 Hz of the same array; -200 for silence
    """

    level: float
    uniformity: float
    uniformity_median: float
    largest_change: float
    seam: float | None
    dip: float
    noise: float

    def asdict(self) -> dict[str, float | None]:
        """The metrics by name."""
        return asdict(self)

    def __repr__(self) -> str:
        rows = self._rows()
        name, value = (max(len(row[k]) for row in rows) for k in (0, 1))
        return "\n".join(f"{row[0]:{name}}  {row[1]:>{value}}  {row[2]}" for row in rows)

    def _repr_html_(self) -> str:
        rows = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in self._rows())
        return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"

    def _rows(self) -> list[tuple[str, str, str]]:
        values = self.asdict()
        told = {name: "-" if value is None else f"{value:.4f}" for name, value in values.items()}
        told["noise"] = f"{self.noise:.1f}"
        return [(name, told[name], meaning) for name, meaning in MEANINGS.items()]


def measure(
    pressures: NDArray[np.float64],
    targets: NDArray[np.float64],
    changes: NDArray[np.float64],
    closed: bool,
    noise: float,
) -> SequenceMetrics:
    """Metrics of |p| (S, M) beside targets (S, M), 0 where a point is not there, and of changes (T,)."""
    there = targets > 0
    heard = there.any(axis=1)
    x = np.divide(pressures, targets, out=np.full(targets.shape, np.nan), where=there)[heard]
    largest = np.nanmax(x, axis=1)
    even = np.divide(np.nanmin(x, axis=1), largest, out=np.zeros(len(x)), where=largest > 0)
    # A point that is never there has no mean.
    own = x[:, there.any(axis=0)]
    mean = np.nanmean(own, axis=0)
    dips = np.divide(np.nanmin(own, axis=0), mean, out=np.zeros(len(mean)), where=mean > 0)
    return SequenceMetrics(
        level=float(np.nanmean(x, axis=1).mean()),
        uniformity=float(even.min()),
        uniformity_median=float(np.median(even)),
        largest_change=float(changes[1:].max(initial=0.0)),
        seam=float(changes[0]) if closed else None,
        dip=float(dips.min()),
        noise=noise,
    )
