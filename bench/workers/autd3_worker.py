"""Times autd3: "call" reuses foci and buffers, "full" makes them from NumPy arrays; both return bytes."""

from importlib.metadata import version
from typing import Any

import autd3_core as core
import autd3_pattern as pattern
import autd3_pattern_holo as holo
import numpy as np
from serve import Prepared, serve

#: autd3's defaults: 100 steps, clamped amplitudes, 16 phases. `parallel` would run only the last step in
#: several threads.
OPTIONS = {
    "naive": holo.NaiveOption(parallel=False),
    "gs": holo.GsOption(parallel=False),
    "gspat": holo.GspatOption(parallel=False),
    "greedy 16 phases": holo.GreedyOption(),
}
FULL = core.Intensity.MAX


def boards(tiles: list[int]) -> core.Geometry:
    """Returns the boards, x fastest, as in midair's preset: the middle of all transducers is the origin."""
    size = (core.Autd3.DEVICE_WIDTH, core.Autd3.DEVICE_HEIGHT)
    sites = (core.Autd3.GRID_X, core.Autd3.GRID_Y)

    def corner(axis: int, tile: int) -> float:
        span = (tiles[axis] - 1) * size[axis] + (sites[axis] - 1) * core.Autd3.PITCH_MM
        return tile * size[axis] - span / 2

    places = [(x, y) for y in range(tiles[1]) for x in range(tiles[0])]
    return core.Geometry([core.Autd3([corner(0, x), corner(1, y), 0.0]) for x, y in places])


def prepare(task: dict[str, Any]) -> Prepared:
    geometry = boards(task["tiles"])
    wavelength = pattern.wavelength(core.Velocity.from_m_s(task["sound_speed"]))
    points, pressures = task["points"] * 1e3, task["pressures"]
    name, options = task["method"].split()[0], OPTIONS[task["method"]]
    method, fixed = getattr(holo, name), (FULL, options) if name == "greedy" else (options,)

    def foci() -> list[holo.AmplitudeTarget]:
        # Arithmetic on Python floats is faster here than on rows of NumPy arrays.
        requested = zip(points.tolist(), pressures.tolist(), strict=True)
        return [holo.AmplitudeTarget(point, pressure * holo.Pa) for point, pressure in requested]

    def buffers() -> list[Any]:
        """Returns a buffer of phases, and one of amplitudes if the method does not fix them."""
        phases = geometry.phase_buffer()
        return [phases] if name == "greedy" else [phases, geometry.intensity_buffer()]

    def call(foci: list[holo.AmplitudeTarget], buffers: list[Any]) -> list[Any]:
        method(geometry, foci, wavelength, *fixed, *buffers)
        return buffers

    def full() -> list[np.ndarray]:
        return [buffer.to_numpy() for buffer in call(foci(), buffers())]

    def answer(result: list[Any]) -> dict[str, Any]:
        phases, *rest = (np.asarray(x if task["form"] == "full" else x.to_numpy()).ravel() for x in result)
        amplitudes = rest[0] / 255 if rest else 1.0
        positions = np.concatenate([device.positions() for device in geometry]) * 1e-3
        return {"drive": amplitudes * np.exp(2j * np.pi * phases / 256), "positions": positions}

    if task["form"] == "full":
        return full, answer
    ready = (foci(), buffers())
    return lambda: call(*ready), answer


serve(version("autd3-pattern-holo"), tuple(OPTIONS), ("call", "full"), prepare)
