"""Scenes that several tests use, and their exact propagation matrices."""

import numpy as np

import midair
import oracle

#: Largest relative error of an element of G in f32, up to a distance of 1 m. This distance, 118 wavelengths,
#: is stored in steps of 7.6e-6 wavelengths; three roundings of that size are a phase of 1.4e-4 rad.
GAIN = 2e-4

METRICS = ("accuracy", "sigma", "uniformity", "level", "residual", "leak")

#: Four points about a focal width apart, none on an axis of symmetry.
POINTS = [[-0.021, 0.004, 0.15], [0.019, 0.013, 0.15], [0.003, -0.022, 0.152], [0.031, 0.031, 0.149]]


def small(**scene) -> midair.Scene:
    """Returns a scene of 8 x 8 transducers, with the points POINTS unless others are given."""
    array = scene.pop("array", None) or midair.Array.grid(8, 8, pitch=0.01)
    return midair.Scene(array, scene.pop("points", POINTS), **scene)


def exact(scene: midair.Scene) -> oracle.Complex:
    """Returns G (M, N) of a scene in double precision."""
    array, directivity = scene.array, scene.array.directivity
    return oracle.propagation(
        array.positions,
        scene.points,
        normals=array.normals,
        response=array.response,
        source_pressure=array.source_pressure,
        directivity=directivity if isinstance(directivity, str) else next(iter(directivity.items())),
        frequency=scene.frequency,
        sound_speed=scene.sound_speed,
        absorption=scene.absorption,
    )


def numbers(metrics: midair.Metrics) -> dict[str, float]:
    """Returns metrics as a dictionary, like `oracle.metrics`."""
    return {name: getattr(metrics, name) for name in METRICS}


def same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    """Returns whether two arrays are equal to the last bit, the sign of zeros included."""
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def usable(solution: midair.Solution) -> bool:
    """Returns whether every number of a solution is finite and every |drive| at most 1."""
    within = bool((np.abs(solution.drive.astype(complex)) <= 1 + 1e-6).all())
    parts = [solution.drive, solution.pressures, solution.radiation, solution.phases, solution.amplitudes]
    parts.append(list(numbers(solution.metrics).values()))
    return within and all(bool(np.isfinite(part).all()) for part in parts)
