"""Strength of traps between two OpenMPD boards, by signature: prints the table of docs/traps.md, as Markdown.

There are ten scenes each of 1, 2, 4 and 8 random points, at least 20 mm apart, up to 50 mm from the axis
along x and y and 20 mm along z. A scene's figure is the least stiffness over its points and axes, relative
to the best of two L-BFGS searches over all phases (python/tests/traps.py). "trapped" counts the scenes in
which every stiffness is above 0. It takes about a minute; OMP_NUM_THREADS=1 helps on few cores.
"""

import sys
from pathlib import Path

import numpy as np

import midair

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "tests"))

import traps

SCENES = 10


def main() -> None:
    """Solves the scenes and prints the table."""
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals)
    methods = ["trap", "trap, equal foci", "twin", "vortex"]
    print("| | " + " | ".join(f"M = {count}" for count in (1, 2, 4, 8)) + " |", "|---" * 5 + "|", sep="\n")
    rows = {method: [] for method in methods}
    for count in (1, 2, 4, 8):
        parts = {method: [] for method in methods}
        for seed in range(SCENES):
            points = traps.scattered(count, [0.05, 0.05, 0.02], 0.02, seed)
            scene = midair.Scene(array, points, signature="trap")
            solved = midair.solve(scene)
            start = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(positions))
            best = traps.least(scene, traps.direct(positions, points, [np.angle(solved.drive), start])).min()
            foci = midair.solve(scene, pressures=1000, aim="max")
            drives = {"trap": solved, "trap, equal foci": foci}
            for name in ("twin", "vortex"):
                drives[name] = midair.solve(scene.replace(signature=name))
            for method, drive in drives.items():
                parts[method].append(traps.least(scene, drive).min() / best)
        for method, found in parts.items():
            kept = sum(part > 0 for part in found)
            rows[method].append(f"{np.mean(found):.2f} ({min(found):.2f}), {kept} of {SCENES} trapped")
    for method, cells in rows.items():
        print(f"| {method} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
