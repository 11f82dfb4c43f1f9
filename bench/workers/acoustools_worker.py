"""Times AcousTools on one thread: "call" reuses its tensors, "full" converts from NumPy arrays and back.

AcousTools has its defaults: 200 steps, |q| = 1. It reads the argument -cpu itself. A board at z = 0 without
normals gets normals of 0, which makes its piston model a point source, as in all other programs here.
"""

from importlib.metadata import version
from typing import Any

import torch
from acoustools import Solvers
from serve import Prepared, serve

METHODS = ("naive", "wgs", "gspat")


def prepare(task: dict[str, Any]) -> Prepared:
    board = torch.tensor(task["positions"], dtype=torch.float32)
    # In AcousTools a point source's amplitude is 2 p_ref times the directivity at 0, which is 1/2.
    model = {"board": board, "k": task["wavenumber"], "p_ref": task["source_pressure"]}
    method = getattr(Solvers, task["method"])
    relative = task["pressures"][:, None] / task["pressures"].max()
    keyword = "activation" if task["method"] == "naive" else "b"

    def tensors() -> tuple[torch.Tensor, torch.Tensor]:
        points = torch.tensor(task["points"].T[None], dtype=torch.float32)
        return points, torch.tensor(relative, dtype=torch.complex64)

    def call(points: torch.Tensor, targets: torch.Tensor) -> torch.Tensor:
        return method(points, **{keyword: targets}, **model)

    def answer(result: Any) -> dict[str, Any]:
        return {"drive": torch.as_tensor(result).numpy().ravel(), "positions": task["positions"]}

    if task["form"] == "full":
        return lambda: call(*tensors()).numpy(), answer
    ready = tensors()
    return lambda: call(*ready), answer


torch.set_num_threads(1)
serve(f"{version('acoustools')}, torch {version('torch')}", METHODS, ("call", "full"), prepare)
