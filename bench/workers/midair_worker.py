"""midair: "solve" builds a Scene from NumPy arrays at each call, "Solver" owns its workspace and output."""

from importlib.metadata import version
from typing import Any

import numpy as np
from serve import Prepared, serve

import midair

FORMS = ("solve", "Solver") if hasattr(midair, "Solver") else ("solve",)


def prepare(task: dict[str, Any]) -> Prepared:
    array = midair.Array.preset(task["preset"], task["tiles"] and tuple(task["tiles"]), quantization={})
    method, points, pressures = task["method"], task["points"], task["pressures"]
    seeded = "seed" in midair.solvers()[method].options
    options = {"seed": task["seed"]} if seeded else {}

    def solve() -> midair.Solution:
        scene = midair.Scene(array, points, pressures, sound_speed=task["sound_speed"])
        return midair.solve(scene, method, **options)

    def answer(drive: Any) -> dict[str, Any]:
        metrics = solve().metrics
        told = {name: getattr(metrics, name) for name in ("accuracy", "sigma", "uniformity")}
        return {"drive": drive, "positions": array.positions, "metrics": told}

    if task["form"] == "solve":
        return lambda: solve().drive, answer
    solver = midair.Solver(array, method, points=len(points), **options)
    out = np.empty(len(array), np.complex64)

    def follow() -> Any:
        solver(points, pressures, out=out)
        return out

    return follow, answer


serve(version("midair"), tuple(midair.solvers()), FORMS, prepare)
