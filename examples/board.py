"""A SonicSurface's phases: the picture shows the phase of each of its 256 transducers, and the field.

The board has 32 phases, and each transducer is on or off. midair rounds every drive for its array to these
values. The program plays the drive on a simulated board; `sonicsurface:/dev/ttyUSB0` is a real one.
"""

import matplotlib.pyplot as plt
import numpy as np

import midair

board = midair.Board("sonicsurface")
points = [[0.02, 0, 0.12], [-0.02, 0, 0.12], [0, 0.03, 0.12]]
solution = midair.solve(midair.Scene(board.array, points))

with midair.connect("sonicsurface:loop") as surface:
    surface.send(solution)

# Values from -16 to 15; 16 steps are half a turn.
steps = (np.round(solution.phases / (2 * np.pi / 32)) + 16) % 32 - 16
figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
x, y = 1e3 * board.array.positions[:, 0], 1e3 * board.array.positions[:, 1]
midair.plot(solution, axes[1])
axes[1].set_title("three foci, 12 cm above")
# midair's cyclic colour map, which colour-blind people can read; midair.plot registers it.
discs = axes[0].scatter(x, y, c=steps, s=90, cmap="midair.phase", vmin=-16, vmax=16, ec="0.5", lw=0.4)
axes[0].set(aspect="equal", xlabel="x / mm", ylabel="y / mm", title="phase steps of 2 pi/32")
figure.colorbar(discs, ax=axes[0], ticks=[-16, -8, 0, 8, 16])
figure.savefig("board.png")
