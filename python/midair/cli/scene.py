"""The scene that a command is about: a file, standard input, or a preset and points as typed."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from .. import Array, Scene, SceneError, output
from .._midair import scene_files

#: In place of a file: standard input, or standard output.
STANDARD = Path("-")

#: More than the core reads (64 MB), so that it is the core that refuses.
_MOST_BYTES = (64 << 20) + 1


def read_scene(path: Path) -> Scene:
    """A scene file, or standard input for -: TOML or JSON as it looks, its files in this folder."""
    if path != STANDARD:
        return Scene.load(path)
    return Scene.parse(sys.stdin.buffer.read(_MOST_BYTES), name="standard input", folder=".")


def typed_scene(
    preset: str | None, tiles: str | None, at: Sequence[str] | None, pressure: str | None
) -> Scene:
    """A scene without a file: an array by its name, and its points one by one."""
    example = "--preset autd3 --at 0,0,0.15"
    if preset is None and not at:
        raise SceneError(f"scene is left out: give a scene file (midair new writes one), or {example}")
    if preset is None:
        raise SceneError(f"--preset is left out: say which array, as in {example}; midair presets lists them")
    if not at:
        raise SceneError(f"--at is left out: give the points, as in {example} --at 0.02,0,0.15")
    points = [_numbers("--at", point, 3, "three numbers in m, such as --at 0,0,0.15") for point in at]
    pressures = None
    if pressure is not None:
        each = f", or {len(points)} with commas between, one a point" if len(points) > 1 else ""
        cure = f"one pressure in Pa{each}"
        pressures = _numbers("--pressure", pressure, (1, len(points)), cure)
    boards = _numbers("--tiles", tiles or "1,1", 2, "boards along x and y, such as --tiles 2,2")
    if not all(number.is_integer() for number in boards):
        raise SceneError(f"--tiles is {tiles}: give whole numbers, such as --tiles 2,2")
    array = Array.preset(preset, (int(boards[0]), int(boards[1])))
    return Scene(array, points, pressures[0] if pressures and len(pressures) == 1 else pressures)


def _numbers(name: str, text: str, count: int | tuple[int, ...], cure: str) -> list[float]:
    try:
        numbers = [float(number) for number in text.strip("[]() ").split(",")]
    except ValueError:
        numbers = []
    counts = (count,) if isinstance(count, int) else count
    if len(numbers) not in counts or not all(map(math.isfinite, numbers)):
        raise SceneError(f'{name} is "{text}": give {cure}')
    return numbers


def check_outputs(scene: Path | None, outputs: Iterable[tuple[Path | None, tuple[str, ...]]]) -> None:
    """Refuse outputs that cannot be written, or that are files the scene is read from, or one another."""
    asked = [(path, endings) for path, endings in outputs if path is not None and path != STANDARD]
    # A pipe can be read only once, and has no file to be protected.
    taken = scene_files(scene) if asked and scene is not None and scene.is_file() else []
    for path, endings in asked:
        output.check(path, endings, taken)
        taken.append(path)
