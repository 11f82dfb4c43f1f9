"""How well moving traps keep beads: prints a table of docs/traps.md, as Markdown.

One, two and four beads move on a circle of 18 mm radius between two OpenMPD boards: from rest to a speed
in 50 ms and once around, at 10,000 frames per second, with phase changes of at most pi/16. The first figure
is the least eigenvalue of the stiffness in the worst frame, relative to that of the frame solved alone;
the mean is in brackets. The second is the beads' largest distance from the path, simulated by
python/tests/beads.py. It takes some minutes.

`python bench/moving_traps.py laps` prints the table of closed laps in place of that: by ahead="all" and
ahead=0 the same ratios, the largest change at the seam, and the largest distance by midair.fly. It takes
half an hour.
"""

import sys
from pathlib import Path

import numpy as np

import midair

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "tests"))

import beads
import traps

RATE, CHANGE = 10e3, np.pi / 16
#: The source pressure of the board's transducers, in Pa m.
SOURCE = 2.3
#: Distance, in frames, between the frames that are also solved alone, for comparison.
APART = 40


def main() -> None:
    """Solves the sequences, simulates the beads and prints the table."""
    positions, normals = traps.openmpd()
    array, air = midair.Array(positions, normals, source_pressure=SOURCE), beads.Air(positions, SOURCE)
    print("| | 0.3 m/s | 0.8 m/s |", "|---|---|---|", sep="\n")
    for count in (1, 2, 4):
        cells = []
        for speed in (0.3, 0.8):
            points = beads.circle(count, speed, RATE)
            moved = midair.sequence(array, points, rate=RATE, change=CHANGE, signature="trap")
            assert moved.metrics.largest_change < CHANGE * (1 + 1e-6)
            parts = []
            for t in range(0, len(points), APART):
                scene = midair.Scene(array, points[t], signature="trap")
                alone, bounded = (
                    np.linalg.eigvalsh(midair.gorkov(scene, drive).hessian).min()
                    for drive in (midair.solve(scene).drive, moved.drives[t])
                )
                parts.append(bounded / alone)
            begin = midair.rest(midair.Scene(array, points[0]), moved.drives[0]).place
            stray = air.stray(moved.drives, points, begin, RATE)
            cells.append(f"{min(parts):.2f} ({np.mean(parts):.2f}), {1e3 * stray.max():.2f} mm")
        print(f"| M = {count} | " + " | ".join(cells) + " |", flush=True)


def laps() -> None:
    """Solves closed laps with all frames known in advance, and frame by frame, and prints the table."""
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals, source_pressure=SOURCE)
    for count in (1, 2, 4):
        cells = []
        for speed in (0.3, 0.8):
            frames = round(RATE * 2 * np.pi * beads.RADIUS / speed)
            ring = midair.path.circle(
                [0, 0, 0], beads.RADIUS, frequency=RATE / frames, points=count, normal=(0, 1, 0)
            )
            for ahead in ("all", 0):
                moved = midair.sequence(array, ring, rate=RATE, change=CHANGE, signature="trap", ahead=ahead)
                parts = []
                for t in range(0, frames, 2 * APART):
                    scene = midair.Scene(array, moved.points[t], signature="trap")
                    alone, bounded = (
                        np.linalg.eigvalsh(midair.gorkov(scene, drive).hessian).min()
                        for drive in (midair.solve(scene).drive, moved.drives[t])
                    )
                    parts.append(bounded / alone)
                far = 1e3 * midair.fly(moved, duration=0.6).farthest.max()
                seam = abs(np.angle(moved.drives[0] * moved.drives[frames - 1].conj())).max()
                cells.append(f"{min(parts):.2f} ({np.mean(parts):.2f}), {seam:.2f}, {far:.2f} mm")
        print(f"| M = {count} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    laps() if sys.argv[1:] == ["laps"] else main()
