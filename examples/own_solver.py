"""A method of your own: a Python function of the propagation matrix, targets and weights computes a drive. It
is compared with methods of midair.

The function repeats back-propagation with random phases and keeps the trial whose weakest point is the
strongest.
"""

import numpy as np
from numpy.typing import NDArray

import midair

Real, Complex = NDArray[np.float64], NDArray[np.complex64]


def best_of_many(propagation: Complex, targets: Real, weights: Real, tries: int = 1000) -> Complex:
    """Returns the best of many superpositions of foci with random phases, scaled to full amplitude."""
    rng = np.random.default_rng(1)
    phases = np.exp(2j * np.pi * rng.random((tries, len(targets))))
    drives = (phases * targets) @ propagation.conj()
    drives /= np.abs(drives)
    weakest = (np.abs(drives @ propagation.T) / targets).min(axis=1)
    return drives[weakest.argmax()].astype(np.complex64)


array = midair.Array.preset("paper20")
scene = midair.Scene(array, midair.shape.circle([0, 0, 0.15], 0.03, step=0.02))
table = midair.compare(scene, ["naive", best_of_many, "uniform"])
print(table)
table.plot().savefig("own_solver.png")
