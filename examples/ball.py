"""A hard ball in the way: three foci lie behind it. The left drive was solved without the ball, the right one with it.

Both drives are played with the ball. It weakens the foci by a sixth; a solve that includes the
scattered waves recovers half of this. `midair.Sphere` computes these waves exactly, by their series.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"

scene = midair.Scene.load(SCENES / "ball.json")
drives = {
    "solved for open air": midair.solve(scene.replace(obstacles=None)).drive,
    "solved beside the ball": midair.solve(scene).drive,
}
upright = midair.Plane(axis="y", at=0, size=0.2, center=(0, 0.15))

figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
for ax, (name, drive) in zip(axes, drives.items(), strict=True):
    midair.plot(midair.field(scene, drive, upright), ax, vmax=9000)
    foci = abs(midair.field(scene, drive, scene.points).pressure)
    ax.set_title(f"{name}: foci of {foci.mean() / 1e3:.1f} kPa")
figure.savefig("ball.png")
