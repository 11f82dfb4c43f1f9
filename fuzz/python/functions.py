"""Arguments of motion, touch, measuring and gradients: unusual values give one line of error or an answer."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from typing import Any

import numpy as np

from guided import REFUSALS, Data, fuzz, midair, refused
from values import laid_out, odd

ARRAY = midair.Array.grid(6, 5, 0.01)
SCENE = midair.Scene(ARRAY, [[0.0, 0.0, 0.1]])
SOLUTION = midair.solve(SCENE)
FRAMES = np.array([[[0.0, 0.0, 0.1]], [[1e-3, 0.0, 0.1]], [[2e-3, 0.0, 0.1]]])
TRAPS = midair.sequence(ARRAY, FRAMES, rate=500.0, signature="trap", closed=True, ahead="all")
PLACES = np.array([[0.0, 0.01, 0.2], [0.02, 0.0, 0.25]])
LINE = FRAMES[[0, 2], 0]
DRIVES = midair.calibration_drives(ARRAY, 4.0, microphones=2)
READINGS = np.abs(DRIVES @ midair.Scene(ARRAY, PLACES).propagation().T)
REQUEST = {
    "array": {"preset": "sonicsurface"},
    "points": {"count": 2, "x": [-0.04, 0.04], "y": [-0.04, 0.04], "z": 0.1},
    "solver": {"name": "naive"},
    "seeds": 4,
}

#: Arguments whose cost grows with their value, each with its largest value here.
COSTS = {
    "trials": 3,
    "rate": 60.0,
    "duration": 0.02,
    "budget": 50,
    "seconds": 3.0,
    "steps": 3,
    "readings_per_transducer": 5,
}


def dataset(**given: Any) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        return midair.dataset(REQUEST | given, folder)


def gradient(quantity: str) -> Callable[..., Any]:
    return getattr(midair.grad, quantity)


GRADIENT = {"scene": SCENE, "drive": SOLUTION.drive, "points": LINE, "cotangent": 1.0}
#: Functions and their arguments. Each may be replaced by an unusual value.
FUNCTIONS: list[tuple[Callable[..., Any], dict[str, Any]]] = [
    *((gradient(name), GRADIENT) for name in ("pressure", "amplitude", "radiation")),
    *((gradient(name), {**GRADIENT, "bead": None}) for name in ("gorkov", "force", "stiffness")),
    (
        midair.fly,
        {
            "sequence": TRAPS,
            "beads": LINE,
            "speeds": 0 * LINE,
            "duration": 0.01,
            "tau": 2e-4,
            "hold": "hold",
            "bead": None,
        },
    ),
    (midair.path.fastest, {"points": LINE, "array": SCENE, "closed": False, "margin": 0.3, "bead": None}),
    (midair.path.still, {"places": [0, 0, 0.1], "duration": 0.01, "pressures": 1e3}),
    (
        midair.skin,
        {"sequence": TRAPS, "hand": None, "speed": 6.0, "loss": 0.4, "mass": 6.4, "reach": 2e-3, "tau": 0.0},
    ),
    (TRAPS.felt, {"points": LINE}),
    (
        midair.haptic,
        {
            "shape": LINE,
            "array": ARRAY,
            "rate": 40.0,
            "aim": "strong",
            "change": None,
            "closed": False,
            "beside": 0.0,
            "ears": None,
            "limit": 100.0,
        },
    ),
    (
        midair.sequence,
        {
            "array": ARRAY,
            "path": FRAMES,
            "rate": 50.0,
            "change": 0.1,
            "tau": None,
            "closed": None,
            "ahead": 1,
            "pressures": None,
            "signature": None,
        },
    ),
    (SOLUTION.modulated, {"frequency": 200.0, "rate": 40.0}),
    (midair.rest, {"scene": SCENE, "drive": SOLUTION, "points": LINE, "bead": None}),
    (
        midair.tolerate,
        {
            "scene": SCENE,
            "phase": 1.0,
            "gain": 1.0,
            "dead": 0.1,
            "temperature": 1.0,
            "tilt": 1.0,
            "position": 1e-3,
            "trials": 2,
            "seed": 0,
        },
    ),
    (
        midair.calibrate,
        {
            "scene_or_array": ARRAY,
            "drives": DRIVES,
            "readings": READINGS,
            "microphones": PLACES,
            "noise": None,
            "prior": None,
            "sound_speed_error": 10.0,
        },
    ),
    (
        midair.calibration_drives,
        {"array": ARRAY, "readings_per_transducer": 4.0, "microphones": 2, "seed": 0},
    ),
    (
        midair.doctor,
        {
            "board": ARRAY,
            "read": lambda _: [1.0, 2.0],
            "microphones": PLACES,
            "seconds": 3.0,
            "settle": 0.005,
            "boards": None,
            "temperature": None,
        },
    ),
    (
        midair.tune,
        {
            "read": lambda _: [1.0],
            "array_or_scene": SCENE,
            "method": "greedy",
            "targets": None,
            "start": None,
            "phases": 4,
            "budget": 50,
        },
    ),
    (midair.exposure, {"scene": SCENE, "drive": SOLUTION, "places": {"ear": PLACES}, "limit": "howard"}),
    (midair.streaming, {"scene": SCENE, "drive": SOLUTION, "plane": LINE, "absorption": None}),
    (midair.ear, {"position": [0, 0, 0.3], "size": 0.01, "step": 0.005}),
    (
        dataset,
        {"seeds": 2, "points": REQUEST["points"], "solver": REQUEST["solver"], "array": REQUEST["array"]},
    ),
]


def cheap(name: str, value: Any) -> Any:
    """Returns the value, or the largest cheap one if it costs more."""
    most = COSTS.get(name)
    return (
        most
        if most is not None and isinstance(value, int | float) and not value > 1e90 and value > most
        else value
    )


def test(content: bytes) -> None:
    data = Data(content)
    function, usual = data.PickValueInList(FUNCTIONS)
    given = dict(usual)
    for name in given:
        if data.ConsumeIntInRange(0, 3) == 3:
            given[name] = cheap(name, odd(data))
        elif isinstance(given[name], np.ndarray):
            given[name] = laid_out(data, given[name])
    if function is midair.tune or function is midair.doctor:
        received = given["read"]
        given["read"] = received if callable(received) else lambda _: received
    try:
        function(**given)
    except (*REFUSALS, MemoryError) as error:
        refused(error)


fuzz(test)
