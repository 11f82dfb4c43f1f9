"""Three beads between two boards: the force that brings each of them back, by how far it has strayed.

`signature="trap"` turns foci into acoustic traps. The dotted line is the weight of a bead of polystyrene 2 mm
across, 1.2 µN, hardly above zero: it hangs some micrometres below the middle of its trap.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"
WEIGHT = 29 * 4 / 3 * np.pi * 1e-3**3 * 9.81  # N: density times volume times g

scene = midair.Scene.load(SCENES / "traps.json")
solution = midair.solve(scene)
away = np.linspace(-4e-3, 4e-3, 81)

figure, axes = plt.subplots(1, 3, figsize=(10, 3.4), sharey=True, layout="constrained")
for k, (ax, point) in enumerate(zip(axes, scene.points, strict=True)):
    for axis, name in enumerate("xyz"):
        places = point + away[:, None] * np.eye(3)[axis]
        force = midair.gorkov(scene, solution, places).force[:, axis]
        ax.plot(1e3 * away, 1e6 * force, label=f"along {name}")
    ax.axhline(1e6 * WEIGHT, color="grey", linestyle=":")
    ax.set(title=f"bead {k + 1}", xlabel="away from the trap, mm")
axes[0].set_ylabel("force in µN")
figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper")
figure.savefig("traps.png")
