"""Calls of functions with one argument each left open, for absurd values of it."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import midair

ARRAY = midair.Array.grid(6, 5, 0.01)
PAIR = midair.Array.preset("openmpd_pair", quantization={})
SCENE = midair.Scene(ARRAY, [[0, 0, 0.15]])
SOLUTION = midair.solve(SCENE)
LINE = [[-0.02, 0, 0.15], [0.02, 0, 0.15]]
FRAMES = np.array([LINE, LINE])
DRIVE = np.ones(len(ARRAY))
TRAPS = midair.sequence(PAIR, np.zeros((2, 1, 3)), rate=500, signature="trap", closed=True, ahead="all")
ANGLE = np.linspace(0, 2 * np.pi, 24, endpoint=False)
RING = 5e-3 * np.stack([np.cos(ANGLE), np.sin(ANGLE), 0 * ANGLE], axis=1)

FOLDER = Path(tempfile.mkdtemp())
(FOLDER / "g").write_text("G0 X-10 Y0 Z150\nG1 X10 F6000\nG2 X0 Y10 I-10 J0\n", "utf-8")
(FOLDER / "l").write_text("L0 0 0 0 3.14 L1 0.001 0 0 3.14 L0\n", "utf-8")
(FOLDER / "s").write_text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L9 0 L9 9 Z"/></svg>', "utf-8")

PAIR_OF_FOCI = midair.Scene(ARRAY, LINE, pressures=100.0)
REQUEST: dict[str, Any] = {
    "array": {"grid": [3, 2, 0.01]},
    "solver": {"name": "fast"},
    "seeds": 2,
    "points": {"count": [1], "x": [-0.01, 0.01], "y": [0, 0], "z": [0.1, 0.15]},
}

Call = Callable[[Any], Any]


def keywords(call: Callable[..., Any], *names: str) -> dict[str, Call]:
    """Returns a call for each argument of a function, by its name."""
    return {name: lambda bad, name=name: call(**{name: bad}) for name in names}


def grad(quantity: str) -> Callable[..., Any]:
    known = {"scene": ARRAY, "drive": DRIVE, "points": [[0, 0, 0.15]]}
    return lambda **bad: getattr(midair.grad, quantity)(**(known | bad))


def haptic(**bad: Any) -> Any:
    return midair.haptic(**({"shape": LINE, "array": ARRAY, "rate": 40.0} | bad))


def doctor(**bad: Any) -> Any:
    known = {"board": ARRAY, "read": lambda _: [1.0], "microphones": [[0, 0, 0.2]], "seconds": 1.0}
    return midair.doctor(**(known | bad))


def simulated(bad: Any) -> Any:
    return midair.doctor(ARRAY, lambda _: bad, microphones=[[0, 0, 0.2]], seconds=20.0)


def sequence(**bad: Any) -> Any:
    return midair.sequence(**({"array": ARRAY, "path": FRAMES, "rate": 1e3} | bad))


def dataset(name: str, bad: Any) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        return midair.dataset(REQUEST | {name: bad}, folder)


GROUPS: dict[str, dict[str, Call]] = {
    "haptic": keywords(
        haptic,
        *("shape", "array", "rate", "aim", "change", "beside", "ears", "limit", "loss", "tau", "quiet", "techniques"),
    ),
    "recipes": {"place": midair.recipes},
    "skin": keywords(
        lambda **bad: midair.skin(**({"sequence": TRAPS} | bad)),
        *("sequence", "hand", "speed", "loss", "mass", "reach", "tau"),
    ),
    "felt": {"points": TRAPS.felt},
    "fly": keywords(
        lambda **bad: midair.fly(**({"sequence": TRAPS, "duration": 0.01} | bad)),
        *("sequence", "beads", "speeds", "duration", "tau", "hold", "bead"),
    ),
    "fastest": keywords(
        lambda **bad: midair.path.fastest(**({"points": RING, "array": PAIR, "margin": 0.3} | bad)),
        *("points", "array", "margin", "closed", "bead", "temperature"),
    ),
    "pressure": keywords(grad("pressure"), "scene", "drive", "points", "cotangent"),
    "force": keywords(grad("force"), "scene", "drive", "points", "cotangent", "bead"),
    "stiffness": keywords(grad("stiffness"), "drive", "points", "cotangent", "bead"),
    "rest": {
        "points": lambda bad: midair.rest(SCENE, DRIVE, bad),
        "bead": lambda bad: midair.rest(SCENE, DRIVE, bead=bad),
    },
    "tolerate": keywords(
        lambda **bad: midair.tolerate(**({"scene": SCENE, "trials": 2, "drive": SOLUTION} | bad)),
        *("phase", "gain", "dead", "temperature", "tilt", "position", "seed"),
    ),
    "doctor": keywords(
        doctor,
        "board",
        "microphones",
        "seconds",
        "settle",
        "boards",
        "temperature",
        "microphones_error",
        "seed",
    )
    | {"read": simulated},
    "calibrate": {
        "drives": lambda bad: midair.calibrate(ARRAY, bad, [[1.0]], microphones=[[0, 0, 0.2]]),
        "readings": lambda bad: midair.calibrate(ARRAY, np.ones((120, 30)), bad, microphones=[[0, 0, 0.2]]),
        "readings_per_transducer": lambda bad: midair.calibration_drives(ARRAY, bad),
    },
    "tune": {
        "read": lambda bad: midair.tune(lambda _: bad, SCENE),
        "budget": lambda bad: midair.tune(lambda _: [1.0], SCENE, budget=bad),
    },
    "sequence": keywords(
        sequence, "path", "rate", "change", "change_rate", "tau", "ahead", "signature", "pressures", "closed"
    ),
    "modulated": {"frequency": SOLUTION.modulated},
    "beam": keywords(
        lambda **bad: midair.beam(ARRAY, **({"direction": [0, 0, 1]} | bad)), "direction", "apex", "angle"
    ),
    "ear": keywords(lambda **bad: midair.ear(**({"position": [0, 0, 1]} | bad)), "position", "size", "step"),
    "still": keywords(
        lambda **bad: midair.path.still(**({"places": [0, 0, 0], "duration": 1} | bad)), "places", "duration"
    ),
    "streaming": {
        "plane": lambda bad: midair.streaming(SCENE, DRIVE, bad),
        "absorption": lambda bad: midair.streaming(SCENE, DRIVE, [[0, 0, 0.1]], absorption=bad),
    },
    "multiplex": keywords(
        lambda **bad: midair.multiplex(**({"scene": PAIR_OF_FOCI, "frames": 2, "rate": 1e3, "rounds": 1} | bad)),
        *("scene", "frames", "solver", "rate", "rounds", "phases", "steps"),
    )
    | {
        "pressures": lambda bad: midair.multiplex(PAIR_OF_FOCI.replace(pressures=bad), 2, rate=1e3),
        "weights": lambda bad: midair.multiplex(PAIR_OF_FOCI.replace(weights=bad), 2, rate=1e3),
    },
    "gcode": keywords(
        lambda **bad: midair.path.gcode(**({"path": FOLDER / "g", "speed": 0.1} | bad)),
        *("path", "origin", "speed", "frequency", "pressures"),
    ),
    "lcode": keywords(
        lambda **bad: midair.path.lcode(**({"path": FOLDER / "l"} | bad)),
        *("path", "origin", "rate", "closed", "pressures"),
    ),
    "svg": keywords(
        lambda **bad: midair.path.svg(**({"path": FOLDER / "s", "size": 0.04, "z": 0.15, "speed": 0.1} | bad)),
        *("path", "size", "z", "speed", "frequency", "pressures"),
    ),
    "shape.svg": keywords(
        lambda **bad: midair.shape.svg(**({"path": FOLDER / "s", "size": 0.04, "z": 0.15} | bad)),
        *("path", "size", "z", "step"),
    ),
    "text": keywords(
        lambda **bad: midair.shape.text(**({"string": "a", "height": 0.02, "z": 0.15} | bad)),
        *("string", "height", "z", "step", "font"),
    ),
    "join": {"arrays": midair.Array.join, "second": lambda bad: midair.Array.join([ARRAY, bad])},
    "moved": keywords(ARRAY.moved, "rotation", "translation"),
    "bead": keywords(midair.Bead, "radius", "density", "sound_speed", "gravity"),
    "dataset": {name: lambda bad, name=name: dataset(name, bad) for name in REQUEST}
    | {"point": lambda bad: dataset("points", REQUEST["points"] | {"z": bad})}
    | keywords(
        lambda **bad: midair.dataset(**({"request": REQUEST, "folder": FOLDER / "d"} | bad)),
        "folder",
        "threads",
    )
    | {"opened": lambda bad: midair.Dataset(bad).manifest},
    "exposure": {
        "places": lambda bad: midair.exposure(SCENE, DRIVE, bad),
        "audible": lambda bad: midair.exposure(TRAPS, [[0, 0, 0.3]], audible=bad),
        "limit": lambda bad: midair.exposure(SCENE, DRIVE, [[0, 0, 0.3]], limit=bad),
    },
}

CALLS = {f"{group}, {name}": call for group, calls in GROUPS.items() for name, call in calls.items()}
