"""docs/traps.md: the strength of traps by signature, and how well moving traps keep beads (40 min).

Random scenes have 1, 2, 4 and 8 points between two OpenMPD boards, at least 20 mm apart, up to 50 mm from the
axis along x and y and 20 mm along z. A scene's figure is the least stiffness over its points and axes,
relative to the best of two L-BFGS searches over all phases (python/tests/traps.py). "trapped" counts the
scenes in which every stiffness is above 0.

Moving beads are on a circle of 18 mm radius, at 10,000 frames per second, with phase changes of at most
pi/16. The first figure is the least eigenvalue of the stiffness in the worst frame, relative to that of the
frame solved alone; the mean is in brackets. The last one is the beads' largest distance from the path.
OMP_NUM_THREADS=1 helps on few cores.
"""

import numpy as np
from numpy.typing import NDArray

import beads
import midair
import traps
from pictures import DOCS, INK, figure, head, line

SCENES = 10
RATE, CHANGE = 10e3, np.pi / 16
#: The source pressure of the board's transducers, in Pa m.
SOURCE = 2.3
#: Distance, in frames, between the frames that are also solved alone, for comparison.
APART = 40


def strengths() -> None:
    """Prints the strength of each signature's traps in random scenes."""
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals)
    head("", *(f"M = {count}" for count in (1, 2, 4, 8)))
    rows: dict[str, list[str]] = {"trap": [], "trap, equal foci": [], "twin": [], "vortex": []}
    for count in (1, 2, 4, 8):
        parts: dict[str, list[float]] = {method: [] for method in rows}
        for seed in range(SCENES):
            points = traps.scattered(count, [0.05, 0.05, 0.02], 0.02, seed)
            scene = midair.Scene(array, points, signature="trap")
            solved = midair.solve(scene)
            start = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(positions))
            best = traps.least(scene, traps.direct(positions, points, [np.angle(solved.drive), start])).min()
            drives = {"trap": solved, "trap, equal foci": midair.solve(scene, pressures=1000, aim="max")}
            for name in ("twin", "vortex"):
                drives[name] = midair.solve(scene.replace(signature=name))
            for method, drive in drives.items():
                parts[method].append(traps.least(scene, drive).min() / best)
        for method, found in parts.items():
            kept = sum(part > 0 for part in found)
            rows[method].append(f"{np.mean(found):.2f} ({min(found):.2f}), {kept} of {SCENES} trapped")
    for method, cells in rows.items():
        line(method, *cells)


def kept(moved: midair.Sequence, apart: int) -> str:
    """Returns the stiffness in motion relative to that of frames solved alone: the least and the mean."""
    parts = []
    for t in range(0, len(moved), apart):
        scene = midair.Scene(moved.array, moved.points[t], signature="trap")
        drives = (midair.solve(scene).drive, moved.drives[t])
        alone, bounded = (np.linalg.eigvalsh(midair.gorkov(scene, drive).hessian).min() for drive in drives)
        parts.append(bounded / alone)
    return f"{min(parts):.2f} ({np.mean(parts):.2f})"


def started(array: midair.Array, count: int, speed: float) -> list[str]:
    """Returns the figures of beads that start from rest; python/tests/beads.py simulates them."""
    points = beads.circle(count, speed, RATE)
    moved = midair.sequence(array, points, rate=RATE, change=CHANGE, signature="trap")
    assert moved.metrics.largest_change < CHANGE * (1 + 1e-6)
    begin = midair.rest(midair.Scene(array, points[0]), moved.drives[0]).place
    stray = beads.Air(array.positions, SOURCE).stray(moved.drives, points, begin, RATE)
    return [f"{kept(moved, APART)}, {1e3 * stray.max():.2f} mm"]


def laps(array: midair.Array, count: int, speed: float) -> list[str]:
    """Returns the figures of closed laps, with all frames known in advance, and frame by frame.

    The second figure is the largest change at the seam. `midair.fly` simulates the beads.
    """
    frames = round(RATE * 2 * np.pi * beads.RADIUS / speed)
    ring = midair.path.circle(
        [0, 0, 0], beads.RADIUS, frequency=RATE / frames, points=count, normal=(0, 1, 0)
    )
    cells = []
    for ahead in ("all", 0):
        moved = midair.sequence(array, ring, rate=RATE, change=CHANGE, signature="trap", ahead=ahead)
        far = 1e3 * midair.fly(moved, duration=0.6).farthest.max()
        seam = abs(np.angle(moved.drives[0] * moved.drives[frames - 1].conj())).max()
        cells.append(f"{kept(moved, 2 * APART)}, {seam:.2f}, {far:.2f} mm")
    return cells


def draw() -> None:
    """Draws an upright slice through a trap in a TinyLev: |p|, the force, and the bead."""
    scene = midair.Scene(midair.Array.preset("tinylev"), [[0, 0, 0]], signature="trap")
    solution = midair.solve(scene)
    field = midair.field(scene, solution, midair.Plane(axis="y", at=0, size=0.034, pixels=260, center=(0, 0)))
    side = np.linspace(-0.012, 0.012, 13)
    x, z = (each.ravel() for each in np.meshgrid(side, side))
    force: NDArray[np.float64] = midair.gorkov(scene, solution, points=np.c_[x, 0 * x, z]).force
    length = np.linalg.norm(force, axis=1)
    arrows = force / length[:, None] * np.minimum(length / np.quantile(length, 0.8), 1)[:, None]
    drawn, (ax,) = figure(4.9)
    pressure = np.abs(field.pressure) / 1e3
    shown = ax.pcolormesh(1e3 * field.x, 1e3 * field.z, pressure, cmap="magma", rasterized=True)
    ax.quiver(1e3 * x, 1e3 * z, arrows[:, 0], arrows[:, 2], color="white", scale=16, width=0.005)
    ax.plot(0, 0, "o", ms=13, color="white", mec=INK)
    ax.set(xlabel="x / mm", ylabel="z / mm", aspect="equal")
    drawn.colorbar(shown, ax=ax, label="|p| / kPa")
    drawn.savefig(DOCS / "traps.webp", dpi=130, pil_kwargs={"quality": 85, "method": 6})


def main() -> None:
    """Draws the picture and prints the tables."""
    draw()
    strengths()
    array = midair.Array(*traps.openmpd(), source_pressure=SOURCE)
    for figures in (started, laps):
        head("", *(f"{speed} m/s" for speed in (0.3, 0.8) for _ in range(1 + (figures is laps))))
        for count in (1, 2, 4):
            cells = [cell for speed in (0.3, 0.8) for cell in figures(array, count, speed)]
            line(f"M = {count}", *cells)
