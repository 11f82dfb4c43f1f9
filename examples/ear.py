"""An ear beside four loud foci: quiet points around it reduce the sound pressure level there by over 20 dB. The foci
stay as loud.

Nine points of 0 Pa fill a box of 4 mm. `uniform` keeps them at a thousandth of the loudest focus. Superposed
foci cannot do this.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"

scene = midair.Scene.load(SCENES / "ear.json")
quiet = scene.pressures == 0
box = scene.points[quiet]
ear = np.array([box.min(axis=0), box.max(axis=0)])

figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
for ax, solver in zip(axes, ("naive", "uniform"), strict=True):
    solution = midair.solve(scene, solver, balance=True)
    level = solution.exposure({"ear": ear})["ear"].spl
    midair.plot(solution.field(), ax, quantity="spl", vmax=165)
    ax.set_title(f"{solver}: {level:.0f} dB at the ear")
figure.savefig("ear.png")
