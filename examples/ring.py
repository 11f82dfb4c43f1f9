"""Six foci on a circle: the left plot shows the largest phase change from frame to frame. Frames are solved
separately, or by `glide`.

A jump of a phase is an audible click and a dip under the hand. `midair.sequence` limits the change of every
phase.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"
RATE, FRAMES, RADIUS = 1000, 150, 0.015

scene = midair.Scene.load(SCENES / "ring.json")
angle = 2 * np.pi * 0.5 * np.arange(FRAMES) / RATE  # half a turn a second
around = RADIUS * np.stack([np.cos(angle) - 1, np.sin(angle), 0 * angle], axis=-1)
points = scene.points + around[:, None]

air = {"temperature": 25}
gentle = midair.sequence(scene.array, points, rate=RATE, change=np.pi / 16, **air)
alone = midair.solve_batch(scene, points, solver="uniform")
jumping = midair.Sequence(scene.array, points, gentle.targets, alone.drives, rate=RATE, **air)

figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
for sequence, name in ((jumping, "uniform, frame by frame"), (gentle, "glide")):
    label = f"{name}: noise {sequence.metrics.noise:.0f} dB"
    axes[0].semilogy(1e3 * sequence.times[1:], sequence.changes[1:], label=label)
axes[0].axhline(np.pi / 16, color="grey", linestyle=":")
axes[0].set(xlabel="time / ms", ylabel="largest phase change / rad", ylim=(0.02, 20))
axes[0].legend(title="dotted: the bound", loc="upper right")
midair.plot(gentle.field(0, midair.Plane(z=0.18, size=0.12)), axes[1])
axes[1].set_title("the first frame")
figure.savefig("ring.png")
