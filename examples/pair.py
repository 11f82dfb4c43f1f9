"""Two boards face to face: the waves from both sides make layers half a wavelength apart, in which the
foci lie.

The picture shows the plane of the five foci, and an upright plane through one of them.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"

scene = midair.Scene.load(SCENES / "pair.json")
planes = midair.Plane(z=0, size=0.1), midair.Plane(axis="y", at=0, size=0.1, center=(0, 0))

solution = midair.solve(scene)
figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
for ax, plane in zip(axes, planes, strict=True):
    midair.plot(solution.field(plane), ax)
axes[0].set_title("the plane of the five foci")
axes[1].set_title("upright: a board below, a board above")
figure.savefig("pair.png")
