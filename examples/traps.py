"""Three beads between two boards: the picture shows the field that traps them, and the force that returns
one of them to its place.

`signature="trap"` turns foci into acoustic traps: each is a dark place in strong sound. The dotted line is
the weight of a bead of polystyrene 2 mm across, 1.2 µN, hardly above zero: the bead rests some micrometres
below the middle of its trap.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"
WEIGHT = 29 * 4 / 3 * np.pi * 1e-3**3 * 9.81  # N: density times volume times g

scene = midair.Scene.load(SCENES / "traps.json")
solution = midair.solve(scene)
bead = scene.points[0]
away = np.linspace(-4e-3, 4e-3, 81)

figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained")
loud = scene.replace(points=scene.points + np.array([0, 0, scene.wavelength / 4]))
midair.plot(midair.field(loud, solution.drive, midair.Plane(z=loud.points[0, 2], size=0.09)), axes[0])
axes[0].set_title("a quarter wavelength higher")
beside = midair.Plane(axis="y", at=bead[1], size=0.04, center=(bead[0], bead[2]))
midair.plot(solution.field(beside), axes[1])
axes[1].set_title("one from the side")
for axis, (name, style) in enumerate((("x", "-"), ("y", "--"), ("z", "-"))):
    places = bead + away[:, None] * np.eye(3)[axis]
    force = solution.gorkov(places).force[:, axis]
    axes[2].plot(1e3 * away, 1e6 * force, style, label=f"along {name}")
axes[2].axhline(1e6 * WEIGHT, color="grey", linestyle=":")
axes[2].set(title="its force", ylim=(-290, 420), xlabel="away from the trap / mm", ylabel="force / µN")
axes[2].legend(loc="upper left", fontsize="small")
figure.savefig("traps.png")
