"""Arguments of a wrong type: a path that is not a path, a `progress` that cannot be called."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(4, 4, 10e-3)
SCENE = midair.Scene(ARRAY, [[0, 0, 0.1]])
SOLUTION = midair.solve(SCENE)
PATH = np.array([[[1e-4 * t, 0, 0.1]] for t in range(3)])
SEQUENCE = midair.sequence(ARRAY, PATH, rate=1000)
PLAYED = midair.calibration_drives(ARRAY, 4, microphones=1)
RECEIVED = np.abs(PLAYED @ SCENE.propagation().T)
SWEEP = {"array": {"preset": "paper20"}, "points": {"count": 2, "x": [0, 1], "y": [0, 1], "z": 1.0}}

Call = Callable[[Any], Any]

TAKE_A_PATH: dict[str, Call] = {
    "Array.from_file": midair.Array.from_file,
    "read": midair.read,
    "write": lambda path: midair.write(path, SOLUTION.drive),
    "write a sequence": lambda path: midair.write(path, SEQUENCE),
    "Solution.save": SOLUTION.save,
    "Solution.load": midair.Solution.load,
    "Sequence.save": SEQUENCE.save,
    "Sequence.load": midair.Sequence.load,
    "Sequence.animate": SEQUENCE.animate,
    "Calibration.load": midair.Calibration.load,
    "Mesh.from_file": midair.Mesh.from_file,
}

TAKE_PROGRESS: dict[str, Call] = {
    "tune": lambda call: midair.tune(lambda _: np.ones(1), SCENE, progress=call),
    "calibrate": lambda call: midair.calibrate(SCENE, PLAYED, RECEIVED, progress=call),
    "tolerate": lambda call: midair.tolerate(SCENE, phase=1, trials=1, progress=call),
    "sequence": lambda call: midair.sequence(ARRAY, PATH, rate=1000, progress=call),
    "animate": lambda call: SEQUENCE.animate("never.gif", progress=call),
    "sweep": lambda call: midair.sweep({**SWEEP, "solver": {"name": "naive"}}, progress=call),
}


@pytest.mark.parametrize("name", TAKE_A_PATH)
@pytest.mark.parametrize("bad", [None, 0, 1.5, b"x.npz", [], {"a": 1}])
def test_a_path_is_text(name: str, bad: Any) -> None:
    with pytest.raises(midair.SceneError, match=r"^path is .*: give the name of a file$"):
        TAKE_A_PATH[name](bad)


@pytest.mark.parametrize("name", TAKE_PROGRESS)
@pytest.mark.parametrize("bad", [5, 0, "bar", []])
def test_progress_can_be_called(name: str, bad: Any) -> None:
    with pytest.raises(midair.SceneError, match=r"^progress is .*: give a function of \(\w+.*, .*\w+\)$"):
        TAKE_PROGRESS[name](bad)


def test_each_is_named() -> None:
    for call, reported in [
        (lambda: midair.sequence(ARRAY, PATH, rate=1000, resume=5), "resume is 5: give the name of a file"),
        (lambda: midair.sweep(5), "request is 5: give a sweep file or a mapping of its keys"),
        (
            lambda: midair.sweep({**SWEEP, "solver": {"name": "naive"}}, 5),
            "output is 5: give the name of a file",
        ),
        (lambda: midair.tune(lambda _: np.ones(1), SCENE, seed="a"), 'seed is "a": give a whole number'),
        (lambda: midair.tune(lambda _: np.ones(1), SCENE, "feedback", solver=5), "solver is 5: give text"),
    ]:
        with pytest.raises(midair.SceneError, match=f"^{reported}"):
            call()
    for call in (midair.compare, lambda bad: midair.tolerate(bad, phase=1)):
        with pytest.raises(TypeError, match=r"expected a midair\.Scene"):
            call(5)
