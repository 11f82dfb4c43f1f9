"""How well moving traps hold: figures of docs/traps.md, as Markdown.

One, two and four beads on a circle of 18 mm across two OpenMPD boards, from rest to a speed in 50 ms and once
round at 10,000 frames a second, no phase changing by more than pi/16. The first figure is the least
eigenvalue of the stiffness in the worst frame, as a part of that of a solve of the frame alone; in brackets
is the mean. The second is the largest distance of beads from the path, which python/tests/beads.py simulates.
It takes some minutes.
"""

import sys
from pathlib import Path

import numpy as np

import midair

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "tests"))

import beads
import traps

RATE, CHANGE = 10e3, np.pi / 16
#: The board's transducers, in Pa m.
SOURCE = 2.3
#: Frames between two that are solved alone.
APART = 40


def main() -> None:
    """Solve the sequences, fly the beads and print the table."""
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


if __name__ == "__main__":
    main()
