"""Faults of array and air: how much pressure and uniformity remain with wrong phases, dead transducers,
other air or a tilted array.

`midair.tolerate` plays one drive in a hundred trials of each fault, and of all faults together.
"""

import numpy as np

import midair

points = np.c_[np.random.default_rng(1).uniform(-0.05, 0.05, (8, 2)), np.full(8, 0.15)]
scene = midair.Scene(midair.Array.grid(16, 16, 10e-3), points)
table = midair.tolerate(scene, "uniform", phase=20, dead=0.05, temperature=5, tilt=1, trials=100)
print(table)
table.plot().savefig("faults.png")
