"""Descriptions of sweeps that several tests use."""

from copy import deepcopy
from typing import Any

import numpy as np

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60

REQUESTED: dict[str, Any] = {
    "seed": 3,
    "seeds": 5,
    "array": [{"preset": "paper20"}, {"grid": {"nx": 8, "ny": 8, "pitch": 0.01}}],
    "points": {"count": [2, 5], "x": [-0.04, 0.04], "y": [-0.04, 0.04], "z": 0.15, "pressure": [1.0, 2.0]},
    "solver": [{"name": "greedy", "phases": [8, 16], "balance": True}, {"name": "naive", "balance": True}],
}

SCENE = """
[array]
grid = { nx = 8, ny = 6, pitch = 0.01 }
[[points]]
position = [-0.02, 0.0, 0.1]
pressure = 1900.0
[[points]]
position = [0.015, 0.01, 0.1]
pressure = 1700.0
weight = 0.5
"""

TOML = """
seeds = 3
[array]
preset = "paper20"
[points]
count = [2, 4]
x = [-0.05, 0.05]
y = [-0.05, 0.05]
z = 0.15
[[solver]]
name = "greedy"
[[solver]]
name = "gspat"
limit = ["clamp", "full"]
"""


def changed(**tables: Any) -> dict[str, Any]:
    """Returns a copy of REQUESTED with these tables replaced, or removed if given as None."""
    return {key: value for key, value in {**deepcopy(REQUESTED), **tables}.items() if value is not None}


def equal(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> bool:
    return list(a) == list(b) and all(np.array_equal(a[name], b[name]) for name in a)
