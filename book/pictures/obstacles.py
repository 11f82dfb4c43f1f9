"""docs/obstacles.md: foci beside a wall and beside a ball, solved with and without the obstacle (10 s)."""

import time

import matplotlib.pyplot as plt
import numpy as np
import trimesh
from numpy.typing import NDArray

import midair
import oracle
from pictures import DOCS, head, line
from sphere_series import total

SOLVERS = ("naive", "fast", "greedy", "uniform")
#: Distance in m of a wall beside the points from the array's axis.
SIDE = 0.045
CENTER, RADIUS = np.array([0, 0, 0.1]), 0.02


def compared(
    scenes: dict[str, midair.Scene], truth: NDArray[np.complex128], plane: midair.Plane, obstacle: str
) -> None:
    """Prints a row for each method, with the level and evenness of each scene's drive in the true field.

    Parameters
    ----------
    scenes
        The first one ignores the obstacle; the last one has it, and its field is drawn.
    truth
        The pressures (M, N) of the transducers, in f64.
    """
    head("method", *scenes)
    ignored, *_, behind = scenes.values()
    figure, axes = plt.subplots(1, 2, figsize=(9, 4), layout="constrained", sharey=True)
    for solver in SOLVERS:
        cells = []
        for scene in scenes.values():
            solution = midair.solve(scene, solver)
            p = np.abs(truth @ solution.drive)
            cells.append(f"{p.mean():.0f}, {p.min() / p.max():.3f}")
            if solver == "uniform" and (scene is ignored or scene is behind):
                ax, way = (axes[0], "without") if scene is ignored else (axes[1], "with")
                midair.plot(midair.field(behind, solution.drive, plane), ax, vmax=4000)
                ax.set_title(f"solved {way} the {obstacle}", fontsize="medium")
        line(f"`{solver}`", *cells)
    figure.savefig(DOCS / f"{'obstacles' if obstacle == 'wall' else 'bodies'}.png", dpi=90)


def wall() -> None:
    """Compares the methods in front of a wall; image sources are the truth."""
    # The last column of the array is 5 mm from the wall.
    array = midair.Array.grid(9, 16, 10e-3)
    points = np.array([[x, 0, 0.15] for x in (-0.03, -0.01, 0.01, 0.03)])
    scene = midair.Scene(array, points)
    walled = scene.replace(obstacles=[midair.Wall([SIDE, 0, 0], [-1, 0, 0])])
    scenes = {"wall ignored: mean Pa, min/max": scene, "wall in the scene: mean Pa, min/max": walled}
    images = array.positions * [-1, 1, 1] + [2 * SIDE, 0, 0]
    truth = oracle.propagation(array.positions, points) + oracle.propagation(images, points)
    plane = midair.Plane(axis="y", at=0, size=0.12, pixels=240, center=(0, 0.12))
    compared(scenes, truth, plane, "wall")


def ball() -> None:
    """Compares the methods beside a ball, as a mesh and by its exact series, which is the truth."""
    array, shape = midair.Array.grid(16, 16, 10e-3), trimesh.creation.icosphere(3, RADIUS)
    # One point in the ball's shadow, three beside it.
    points = np.array([[0, 0, 0.145], [0.035, 0, 0.1], [-0.035, 0, 0.1], [0, 0.035, 0.1]])
    scene = midair.Scene(array, points)
    begin = time.process_time()
    meshed = scene.replace(obstacles=[midair.Mesh(shape.vertices + CENTER, shape.faces)])
    seconds = time.process_time() - begin
    behind = scene.replace(obstacles=[midair.Sphere(CENTER, RADIUS)])
    k = 2 * np.pi * scene.frequency / scene.sound_speed
    truth = array.source_pressure * total(points, array.positions, CENTER, RADIUS, k, "rigid").T
    off = np.abs(meshed.propagation() - behind.propagation()).max() / np.abs(truth).max()
    print(f"{len(shape.faces)} faces: {seconds:.2f} s of CPU, off by {off:.4f} of the largest |p|")
    scenes = {"ball ignored: mean Pa, min/max": scene, "as a mesh": meshed, "by its series": behind}
    plane = midair.Plane(axis="y", at=0, size=0.14, pixels=200, center=(0, 0.1))
    compared(scenes, truth, plane, "ball")


def main() -> None:
    """Prints the tables and draws the pictures."""
    wall()
    ball()
