"""Times midair in two forms.

"solve" makes a Scene from NumPy arrays in each call. "Solver" uses its workspace and its output again.
"""

from importlib.metadata import version
from typing import Any

import numpy as np
from serve import Prepared, serve

import midair

#: Methods with options other than the defaults.
CHOICES = {
    "greedy 16 phases": ("greedy", {"phases": 16, "amplitudes": 1}),
    "greedy 256 x 16": ("greedy", {"phases": 256, "amplitudes": 16}),
}


def prepare(task: dict[str, Any]) -> Prepared:
    quantization = {"none": {}, "board": None}[task["grid"]]
    # Point sources in air without absorption, as in all programs.
    array = midair.Array.preset(
        task["preset"], task["tiles"] and tuple(task["tiles"]), directivity="point", quantization=quantization
    )
    air = {"sound_speed": task["sound_speed"], "absorption": 0.0}
    points, pressures = task["points"], task["pressures"]
    method, options = CHOICES.get(task["method"], (task["method"], {}))
    if "seed" in midair.solvers()[method].options:
        options = {**options, "seed": task["seed"]}

    def solve() -> midair.Solution:
        scene = midair.Scene(array, points, pressures, **air)
        return midair.solve(scene, method, **options)

    def answer(drive: Any) -> dict[str, Any]:
        solution = solve()
        reported = {name: getattr(solution.metrics, name) for name in ("accuracy", "sigma", "uniformity")}
        return {"drive": solution.scale * drive, "positions": array.positions, "metrics": reported}

    if task["form"] == "solve":
        return lambda: solve().drive, answer
    solver = midair.Solver(array, method, points=len(points), **air, **options)
    out = np.empty(len(array), np.complex64)

    def follow() -> Any:
        solver(points, pressures, out=out)
        return out

    return follow, answer


serve(version("midair"), (*midair.solvers(), *CHOICES), ("solve", "Solver"), prepare)
