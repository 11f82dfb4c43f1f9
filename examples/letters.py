"""Letters as strokes of foci 5 mm apart: the picture shows the strength of each focus, by three methods.

A finger that follows the strokes finds a gap at a weak focus. The metric `uniformity` measures this: it is
the weakest focus over the strongest.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"

scene = midair.Scene.load(SCENES / "letters.json")
table = midair.compare(scene, ["naive", "gspat", "uniform"])

figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), sharey=True, layout="constrained")
top = max(abs(solution.pressures).max() for solution in table)
for ax, solution in zip(axes, table, strict=True):
    x, y = 1e3 * scene.points[:, 0], 1e3 * scene.points[:, 1]
    dots = ax.scatter(x, y, c=abs(solution.pressures), s=60, vmin=0, vmax=top, cmap="magma")
    ax.set(title=f"{solution.solver}: uniformity {solution.metrics.uniformity:.2f}", xlabel="x / mm")
    ax.set(aspect="equal", facecolor="black")
axes[0].set_ylabel("y / mm")
figure.colorbar(dots, label="|p| / Pa")
figure.savefig("letters.png")
