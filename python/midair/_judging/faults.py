"""Faults of array and air: how large they are, and one draw of them as a scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._boards.layout import changed
from .._midair import Scene
from .._support.arguments import number, refused

#: Sound speed at 0 degrees C in m/s and that temperature in K: docs/conventions.md.
SPEED, ZERO = 331.3, 273.15

Responses: TypeAlias = NDArray[np.complex128]


def sizes(**asked: float) -> dict[str, float]:
    """The faults above 0, in their order."""
    read = {name: number(name, asked[name], least=0) for name in FAULTS}
    for name, size in read.items():
        if size > FAULTS[name].most:
            raise refused(name, size, f"give at most {FAULTS[name].most:g}")
    return {name: size for name, size in read.items() if size > 0}


def faulty(scene: Scene, faults: Mapping[str, float], seed: int, trial: int) -> Scene:
    """The scene with faults as a trial draws them: each the same, whichever others there are."""
    for index, (name, fault) in enumerate(FAULTS.items()):
        if name in faults:
            random = np.random.default_rng([seed, trial, index])
            scene = fault.draw(scene, faults[name], random)
    return scene


def _responses(scene: Scene, factors: NDArray[np.float64] | Responses) -> Scene:
    array = scene.array
    own = 1.0 if array.response is None else array.response
    return _changed(scene, response=np.asarray(own * factors, complex))


def _changed(scene: Scene, **parts: Any) -> Scene:
    return scene.replace(array=changed(scene.array, quantization=None, **parts))


def _phase(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    angles = np.radians(size) * random.standard_normal(len(scene.array))
    return _responses(scene, np.exp(1j * angles))


def _gain(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    return _responses(scene, np.maximum(1 + size * random.standard_normal(len(scene.array)), 0))


def _dead(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    return _responses(scene, np.where(random.random(len(scene.array)) < size, 0.0, 1.0))


def _reversed(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    return _responses(scene, np.where(random.random(len(scene.array)) < size, -1.0, 1.0))


def _temperature(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    # Of the absolute temperature, which goes with the square of the sound speed.
    believed = ZERO * (scene.sound_speed / SPEED) ** 2
    real = max(believed + size * random.standard_normal(), ZERO / 4)
    return scene.replace(sound_speed=SPEED * math.sqrt(real / ZERO))


def _tilt(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    array = scene.array
    axis, angle = random.standard_normal(3), np.radians(size) * random.standard_normal()
    forward = array.normals.mean(axis=0)
    if (length := np.linalg.norm(forward)) > 0.1:
        # A board turned in its own plane is not tilted; boards that face each other have no such plane.
        axis -= axis @ forward * forward / length**2
    turn = _rotation(axis / np.linalg.norm(axis), float(angle))
    middle = array.positions.mean(axis=0)
    positions = middle + (array.positions - middle) @ turn.T
    return _changed(scene, positions=positions, normals=array.normals @ turn.T)


def _rotation(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """The matrix (3, 3) of a turn about an axis of length 1, by Rodrigues."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn: NDArray[np.float64] = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return turn


def _position(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    array = scene.array
    moved = array.positions + size * random.standard_normal(array.positions.shape)
    return _changed(scene, positions=moved)


class Fault(NamedTuple):
    """How a fault is drawn, the largest that is answered, in its unit, and how one of it is written."""

    draw: Callable[[Scene, float, np.random.Generator], Scene]
    most: float
    unit: str


#: The order is part of the seed.
FAULTS = {
    "phase": Fault(_phase, 180.0, "sd {:g} degrees"),
    "gain": Fault(_gain, 1.0, "sd {:g}"),
    "dead": Fault(_dead, 1.0, "{:g} of all"),
    "reversed": Fault(_reversed, 1.0, "{:g} of all"),
    "temperature": Fault(_temperature, 50.0, "sd {:g} K"),
    "tilt": Fault(_tilt, 45.0, "sd {:g} degrees"),
    "position": Fault(_position, 0.01, "sd {:g} m"),
}
