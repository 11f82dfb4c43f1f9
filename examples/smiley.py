"""A face of foci that a palm can feel: superposed single foci leave gaps. The method `uniform` makes all
points equal.

This is the studio's first scene, solved by three methods and drawn on the same scale. `compare` also prints
their metrics.
"""

from pathlib import Path

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"

scene = midair.Scene.load(SCENES / "smiley.json")
table = midair.compare(scene, ["naive", "greedy", "uniform"])
print(table)
table.plot().savefig("smiley.png")
