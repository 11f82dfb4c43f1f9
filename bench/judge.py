"""The forward model and the metrics that judge all programs: point sources in f64, by NumPy only."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

SOUND_SPEED = 340.0  # m/s
WAVENUMBER = 2 * np.pi * 40e3 / SOUND_SPEED  # rad/m


def propagation(positions: ArrayLike, points: ArrayLike, source_pressure: float) -> Complex:
    """Returns G (M, N) in Pa: P0/r e^{jkr} from positions (N, 3) to points (M, 3), both in m."""
    r = np.linalg.norm(np.asarray(points, float)[:, None] - np.asarray(positions, float), axis=2)
    G: Complex = source_pressure / r * np.exp(1j * WAVENUMBER * r)
    return G


def metrics(G: Complex, drive: ArrayLike, targets: ArrayLike) -> dict[str, float]:
    """Returns accuracy, sigma and uniformity (docs/conventions.md) of a drive (N,).

    The targets (M,) are in Pa and above 0.
    """
    p, targets = np.abs(G @ np.asarray(drive, complex)), np.asarray(targets, float)
    x = p / targets
    relative = x / x.max()
    return {
        "accuracy": float(p.sum() / targets.sum()),
        "sigma": float(relative.std()),
        "uniformity": float(relative.min()),
    }
