"""Foci beside a ball: solved without the ball, with its exact series and with a mesh of it.

Prints a table and draws a picture for docs/obstacles.md. All numbers are judged by the exact series in f64 of
python/tests/sphere_series.py.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import trimesh

import midair

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "tests"))
from sphere_series import total

SOLVERS = ("naive", "fast", "greedy", "uniform")
CENTER = np.array([0, 0, 0.1])
RADIUS = 0.02
#: One point in the ball's shadow, three beside it.
POINTS = np.array([[0, 0, 0.145], [0.035, 0, 0.1], [-0.035, 0, 0.1], [0, 0.035, 0.1]])


def main() -> None:
    """Prints the table and draws the picture."""
    array = midair.Array.grid(16, 16, 10e-3)
    ball = trimesh.creation.icosphere(3, RADIUS)
    scene = midair.Scene(array, POINTS)
    begin = time.process_time()
    meshed = scene.replace(obstacles=[midair.Mesh(ball.vertices + CENTER, ball.faces)])
    seconds = time.process_time() - begin
    behind = scene.replace(obstacles=[midair.Sphere(CENTER, RADIUS)])
    k = 2 * np.pi * scene.frequency / scene.sound_speed
    received = array.source_pressure * total(POINTS, array.positions, CENTER, RADIUS, k, "rigid").T
    off = np.abs(meshed.propagation() - behind.propagation()).max() / np.abs(received).max()
    print(f"{len(ball.faces)} faces: {seconds:.2f} s of CPU, off by {off:.4f} of the largest |p|")
    print("| method | ball ignored: mean Pa, min/max | as a mesh | by its series |")
    print("|---|---|---|---|")
    plane = midair.Plane(axis="y", at=0, size=0.14, pixels=200, center=(0, 0.1))
    figure, axes = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained", sharey=True)
    for solver in SOLVERS:
        cells = []
        for ax, requested in zip((axes[0], None, axes[1]), (scene, meshed, behind), strict=True):
            solution = midair.solve(requested, solver)
            p = np.abs(received @ solution.drive)
            cells.append(f"{p.mean():.0f}, {p.min() / p.max():.3f}")
            if ax is not None and solver == "uniform":
                played = midair.field(behind.replace(plane=plane), solution.drive)
                midair.plot(played, ax=ax, vmax=4000)
        print(f"| `{solver}` | {' | '.join(cells)} |")
    axes[0].set_title("solved without the ball", fontsize="medium")
    axes[1].set_title("solved with the ball", fontsize="medium")
    figure.savefig(Path(__file__).parent.parent / "docs" / "bodies.png", dpi=90)


if __name__ == "__main__":
    main()
