"""Solving of one block: problems of one array, one number of points and one solver with its options."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Scene, SceneError, solvers
from .engine import Arrays

METRICS = ("accuracy", "sigma", "uniformity", "level", "residual", "leak")

#: Settings of a block, all that JSON can hold. "array", "medium": the tables of a scene file.
#: "count", "region" [[x0, x1], [y0, y1], [z0, z1]] in m, "pressure" [low, high] in Pa or None: random points;
#: or "points" [[x, y, z], ...], "pressures", "weights": fixed ones. "solver", "options": with balance and
#: aim. "seed": of all; "seeds": of each trial, None for 0, 1, ...; "drives": whether they are wanted.
Settings = Mapping[str, Any]


def solve_block(settings: Settings, start: int, stop: int) -> Arrays:
    """Trials start to stop of a block.

    Returns the six metrics (B,), status (B,) and, if asked for, drive (B, N), points (B, M, 3), pressures
    (B, M) as attained and targets (B, M) where the block has them.
    """
    array, medium = _array(json.dumps([settings["array"], settings["medium"]], sort_keys=True))
    trials = [trial_seed(settings, index) for index in range(start, stop)]
    points, targets = _points(settings, trials)
    weights = settings.get("weights")
    solved = _solve(array, medium, points, targets, weights, settings, trials)
    if not settings["drives"]:
        return {name: solved[name] for name in (*METRICS, "status")}
    solved["points"] = points
    if targets is not None:
        solved["targets"] = targets
    return solved


def trial_seed(settings: Settings, index: int) -> int:
    """The seed of a trial."""
    seeds = settings["seeds"]
    return index if seeds is None else int(seeds[index])


@lru_cache(maxsize=16)
def _array(tables: str) -> tuple[Array, dict[str, Any]]:
    """The array and the medium's keywords from a scene file's tables, by the one reader of scene files."""
    array, medium = json.loads(tables)
    # Any point will do: it only makes the tables a whole scene file.
    request = {"array": array, "medium": medium, "points": [{"position": [0.0, 0.0, 1.0]}]}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "array.json")
        path.write_text(json.dumps(request))
        scene = Scene.load(path)
    names = ("frequency", "sound_speed", "absorption", "density")
    return scene.array, {name: getattr(scene, name) for name in names}


def count_of(array: Mapping[str, Any], medium: Mapping[str, Any]) -> int:
    """Number of transducers of an array given as in a scene file; refuses what a scene file would."""
    return len(_array(json.dumps([array, medium], sort_keys=True))[0])


def _random(settings: Settings, trial: int) -> np.random.Generator:
    """Randomness of a trial: the same for every array and solver, whatever else is in the sweep."""
    return np.random.default_rng([settings["seed"], trial, settings["count"]])


def _points(settings: Settings, trials: list[int]) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Points (B, M, 3) and targets (B, M), or None for the balanced level."""
    if settings.get("points") is not None:
        points = np.array(settings["points"], float)
        targets = settings["pressures"]
        whole = (len(trials), *points.shape)
        asked = None if targets is None else np.broadcast_to(np.array(targets, float), whole[:2])
        return np.broadcast_to(points, whole), asked
    count = settings["count"]
    low, high = np.array(settings["region"], float).T
    randoms = [_random(settings, trial) for trial in trials]
    points = np.array([low + (high - low) * random.random((count, 3)) for random in randoms])
    if settings["pressure"] is None:
        return points, None
    quiet, loud = settings["pressure"]
    return points, np.array([quiet + (loud - quiet) * random.random(count) for random in randoms])


def _solve(
    array: Array,
    medium: Mapping[str, Any],
    points: NDArray[np.float64],
    targets: NDArray[np.float64] | None,
    weights: Any,
    settings: Settings,
    trials: list[int],
) -> Arrays:
    """By the batch solver where all share a seed or need none, else one by one: the same bits either way."""
    solver, options = settings["solver"], dict(settings["options"])
    fresh = "seed" in solvers()[solver].options and "seed" not in options
    if not fresh:
        shares = None if weights is None else np.broadcast_to(weights, points.shape[:2])
        # The jobs are spread over the processors already.
        found = _midair.solve_batch(
            array, points, targets, solver, weights=shares, threads=1, **options, **medium
        )
        solved = {name: np.asarray(getattr(found.metrics, name)) for name in METRICS}
        status = np.broadcast_to(np.asarray(found.status, np.str_), len(trials))
        return {"drive": found.drives, "pressures": found.pressures, **solved, "status": status}
    solutions = []
    for index, trial in enumerate(trials):
        pressures = None if targets is None else targets[index]
        scene = Scene(array, points[index], pressures, weights=weights, **medium)
        if fresh:
            options["seed"] = solver_seed(settings, trial)
        try:
            solutions.append(_midair.solve(scene, solver, **options))
        except SceneError as error:
            raise SceneError(f"seed {trial}, {len(points[index])} points: {error}") from error
    return {
        "drive": np.array([solution.drive for solution in solutions]),
        "pressures": np.array([solution.pressures for solution in solutions]),
        **{name: np.array([getattr(solution.metrics, name) for solution in solutions]) for name in METRICS},
        "status": np.array([solution.status for solution in solutions]),
    }


def solver_seed(settings: Settings, trial: int) -> int:
    """A seed of its own for the solver of a trial, below 2^63 so that files can hold it."""
    random = np.random.SeedSequence([settings["seed"], trial, settings["count"]], spawn_key=(1,))
    return int(random.generate_state(1, np.uint64)[0] >> 1)
