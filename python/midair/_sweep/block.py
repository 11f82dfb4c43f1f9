"""Solves one block of a sweep: problems with the same array, number of points, solver and options."""

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _midair
from .._midair import Array, Scene, SceneError, restated, solvers
from .._support.arguments import without_warnings
from .._support.cache import Arrays
from .._support.output import METRICS
from .engine import Stopped, go_on

#: Results of each problem. beyond, weak: whether targets exceed the array's reach, or are too weak, for
#: warnings.
REPORTED = (*METRICS, "status", "beyond", "weak")

#: Settings of a block, all as JSON, except a solver that is a function. "array", "medium": the tables of a scene
#: file. "count": M. "region" [[x0,
#: x1], [y0, y1], [z0, z1]] in m for random points, or "points" [[x, y, z], ...] for fixed ones. "pressure"
#: [low, high] in Pa for random targets, or "pressures" [...] for fixed ones, or neither. "weights". "solver",
#: "options" (with balance and aim). "seed" of the sweep; "seeds" of the trials, None for 0, 1, ...; "drives":
#: whether to return them.
Settings = Mapping[str, Any]


def solve_block(settings: Settings, start: int, stop: int) -> Arrays:
    """Solve trials start to stop of a block.

    Returns REPORTED, each (B,). If requested, also drive (B, N), scale (B,), points (B, M, 3), the resulting
    pressures (B, M), and targets (B, M) if the block has any.
    """
    array, medium = array_and_medium(settings)
    trials = [trial_seed(settings, index) for index in range(start, stop)]
    points, targets = points_and_targets(settings, trials)
    solved = _solve(array, medium, points, targets, settings, trials)
    if not settings["drives"]:
        return {name: solved[name] for name in REPORTED}
    solved["points"] = points
    if targets is not None:
        solved["targets"] = targets
    return solved


def trial_seed(settings: Settings, index: int) -> int:
    """Return the seed of a trial."""
    seeds = settings["seeds"]
    return index if seeds is None else int(seeds[index])


def array_and_medium(settings: Settings) -> tuple[Array, dict[str, Any]]:
    """Return the array and the arguments of the medium. Rejects invalid values; only `first_scene` warns."""
    # A scene file needs a point; any point would do.
    fixed = settings.get("points")
    point = fixed[0] if fixed else [(low + high) / 2 for low, high in settings["region"]]
    request = {"array": settings["array"], "medium": settings["medium"], "points": [{"position": point}]}
    return _read(json.dumps(request, sort_keys=True))


@lru_cache(maxsize=16)
def _read(text: str) -> tuple[Array, dict[str, Any]]:
    with without_warnings():
        scene = Scene.parse(text)
    return scene.array, scene.medium


def first_scene(settings: Settings) -> Scene:
    """Return the scene of the first trial, with the errors and warnings that concern all trials."""
    array, medium = array_and_medium(settings)
    points, targets = points_and_targets(settings, [trial_seed(settings, 0)])
    pressures = None if targets is None else targets[0]
    return Scene(array, points[0], pressures, weights=settings.get("weights"), **medium)


def _random(settings: Settings, trial: int) -> np.random.Generator:
    """Return the random generator of a trial: the same for every array and solver of the sweep."""
    return np.random.default_rng([settings["seed"], trial, settings["count"]])


def points_and_targets(settings: Settings, trials: list[int]) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return points (B, M, 3) and targets (B, M), or None for the balanced level."""
    count, whole = settings["count"], (len(trials), settings["count"])
    randoms = [_random(settings, trial) for trial in trials]
    if settings.get("points") is not None:
        points = np.broadcast_to(np.array(settings["points"], float), (*whole, 3))
    else:
        low, high = np.array(settings["region"], float).T
        points = np.array([low + (high - low) * random.random((count, 3)) for random in randoms])
    if settings.get("pressures") is not None:
        return points, np.broadcast_to(np.array(settings["pressures"], float), whole)
    if settings.get("pressure") is None:
        return points, None
    quiet, loud = settings["pressure"]
    return points, np.array([quiet + (loud - quiet) * random.random(count) for random in randoms])


def _solve(
    array: Array,
    medium: Mapping[str, Any],
    points: NDArray[np.float64],
    targets: NDArray[np.float64] | None,
    settings: Settings,
    trials: list[int],
) -> Arrays:
    """Solve all trials in one batch if they share a seed or need none, else one by one.

    Both ways give identical bits.
    """
    solver, weights = settings["solver"], settings.get("weights")
    options = {key: value for key, value in settings["options"].items() if value is not None}

    def batch(part: slice, **seed: int) -> _midair.Batch:
        requested = None if targets is None else targets[part]
        shares = None if weights is None else np.broadcast_to(weights, points[part].shape[:2])
        keywords = {**options, **seed, **medium, "weights": shares, "progress": _watch}
        try:
            # One thread: the jobs already use all processors.
            found = _midair.solve_batch(array, points[part], requested, solver, threads=1, **keywords)
        except SceneError as error:
            raise _of_the_trial(error, trials[part], points.shape[1]) from error
        if not go_on():
            raise Stopped
        return found

    if callable(solver) or "seed" in options or "seed" not in solvers()[solver].options:
        return _arrays([batch(slice(None))])
    seeds = [solver_seed(settings, trial) for trial in trials]
    return _arrays([batch(slice(index, index + 1), seed=seed) for index, seed in enumerate(seeds)])


def _of_the_trial(error: SceneError, trials: list[int], count: int) -> SceneError:
    """Return the error of a batch with the trial's seed instead of its index."""
    if error.index is None:
        return error
    return restated(error, place=f"seed {trials[error.index]}, {count} points")


def _arrays(found: list[_midair.Batch]) -> Arrays:
    """Return the results of batches as arrays, one batch after the other."""
    parts: list[Arrays] = [
        {
            "drive": one.drives,
            "pressures": one.pressures,
            **{name: np.asarray(getattr(one.metrics, name)) for name in METRICS},
            "scale": one.scale,
            "status": np.asarray(one.status, np.str_),
            "beyond": one.beyond,
            "weak": one.weak,
        }
        for one in found
    ]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _watch(done: int, problems: int, residual: float) -> bool:
    """Return False, which stops the batch, if the run is being stopped."""
    return go_on()


def solver_seed(settings: Settings, trial: int) -> int:
    """Return the solver's seed for a trial, below 2^63 so that files can store it."""
    random = np.random.SeedSequence([settings["seed"], trial, settings["count"]], spawn_key=(1,))
    return int(random.generate_state(1, np.uint64)[0] >> 1)
