"""Foci in front of a wall, solved with and without the wall, for docs/obstacles.md.

Prints the table and draws the picture. All numbers are judged by a sum of image sources in f64, which this
file computes itself.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import midair

SOLVERS = ("naive", "fast", "greedy", "uniform")
#: Distance in m of a wall beside the points from the array's axis.
SIDE = 0.045
POINTS = np.array([[-0.03, 0, 0.15], [-0.01, 0, 0.15], [0.01, 0, 0.15], [0.03, 0, 0.15]])


def received(
    array: midair.Array, points: NDArray[np.float64], drive: NDArray[np.complex64]
) -> NDArray[np.float64]:
    """Returns |p| at points (P, 3) in f64: eq. (5) for point sources and their images in the rigid wall."""
    k, found = 2 * np.pi * 40e3 / 340, np.zeros(len(points), complex)
    for places in (array.positions, array.positions * [-1, 1, 1] + [2 * SIDE, 0, 0]):
        r = np.linalg.norm(points[:, None] - places, axis=2)
        found += (array.source_pressure * np.exp(1j * k * r) / r) @ drive
    return np.abs(found)


def main() -> None:
    """Prints the table and draws the picture."""
    # The last column of the array is 5 mm from the wall.
    array = midair.Array.grid(9, 16, 10e-3)
    scene = midair.Scene(array, POINTS)
    wall = midair.Wall([SIDE, 0, 0], [-1, 0, 0])
    behind = scene.replace(obstacles=[wall])
    print("| method | wall ignored: mean Pa, min/max | wall in the scene: mean Pa, min/max |")
    print("|---|---|---|")
    plane = midair.Plane(axis="y", at=0, size=0.12, pixels=240, center=(0, 0.12))
    figure, axes = plt.subplots(1, 2, figsize=(9, 4), layout="constrained", sharey=True)
    for solver in SOLVERS:
        cells = []
        for ax, requested in zip(axes, (scene, behind), strict=True):
            solution = midair.solve(requested, solver)
            p = received(array, POINTS, solution.drive)
            cells.append(f"{p.mean():.0f}, {p.min() / p.max():.3f}")
            if solver == "uniform":
                midair.plot(midair.field(behind, solution.drive, plane), ax, vmax=4000)
        print(f"| `{solver}` | {cells[0]} | {cells[1]} |")
    axes[0].set_title("solved without the wall", fontsize="medium")
    axes[1].set_title("solved with the wall", fontsize="medium")
    figure.savefig(Path(__file__).parent.parent / "docs" / "obstacles.png", dpi=90)


if __name__ == "__main__":
    main()
