"""A weak focus: greedy search spreads sound over the whole plane. The option `balance` prevents this.

This is fig. 7 of Suzuki et al. 2021. `balance=True` solves at the level that the array can reach, and
then reduces the drives.
"""

import warnings
from pathlib import Path

import midair

SCENES = Path(__file__).parents[1] / "docs" / "scenes" / "gallery"

scene = midair.Scene.load(SCENES / "weak.json")
with warnings.catch_warnings(action="ignore"):  # without balancing, midair warns that such a focus is smeared
    table = midair.compare(scene, [("greedy", {"balance": False}), ("greedy", {"balance": True}), "fast"])

table.plot().savefig("weak.png")
