"""The scene of a command: from a file, from standard input, or from a preset and points."""

import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from .. import Array, Scene
from .._midair import scene_files, stated
from .._support import output
from .._support.arguments import refused

#: File name that means standard input or output.
STANDARD = Path("-")

#: One byte more than the core accepts (64 MB), so that the core reports the error.
_MOST_BYTES = (64 << 20) + 1


class SceneFile:
    """A scene file, or standard input for "-", as TOML or JSON. Files that it names are in its folder."""

    def __init__(self, path: Path) -> None:
        self.path = path
        # A pipe can be read only once.
        self._text: bytes | None = None
        if path == STANDARD:
            self._text = sys.stdin.buffer.read(_MOST_BYTES)
        elif not path.is_file():
            with path.open("rb") as pipe:
                self._text = pipe.read(_MOST_BYTES)

    def scene(self) -> Scene:
        """Return the scene."""
        if self._text is None:
            return Scene.load(self.path)
        name = "standard input" if self.path == STANDARD else str(self.path)
        return Scene.parse(self._text, name=name, folder=self.path.parent)

    def check_outputs(self, *outputs: tuple[Path | None, tuple[str, ...]]) -> None:
        """Reject output files that cannot be written, are used by the scene, or are given twice."""
        if any(path is not None for path, _ in outputs):
            check_outputs(*outputs, taken=scene_files(self.path, self._text))


def typed_scene(
    preset: str | None, tiles: str | None, at: Sequence[str] | None, pressure: str | None
) -> Scene:
    """Return a scene without a file: an array by its preset, and points one by one."""
    example = "--preset autd3 --at 0,0,0.15"
    if preset is None and not at:
        raise stated(
            "scene", "is left out", f"give a scene file (midair new writes one), or {example}", code="missing"
        )
    if preset is None:
        cure = f"say which array, as in {example}; midair presets lists them"
        raise stated("--preset", "is left out", cure, code="missing")
    if not at:
        raise stated(
            "--at", "is left out", f"give the points, as in {example} --at 0.02,0,0.15", code="missing"
        )
    points = [numbers("--at", point, 3, "three numbers in m, such as --at 0,0,0.15") for point in at]
    pressures = None
    if pressure is not None:
        each = f", or {len(points)} with commas between, one a point" if len(points) > 1 else ""
        cure = f"one pressure in Pa{each}"
        pressures = numbers("--pressure", pressure, (1, len(points)), cure)
    boards = numbers("--tiles", tiles or "1,1", 2, "boards along x and y, such as --tiles 2,2")
    if not all(number.is_integer() for number in boards):
        raise stated("--tiles", f"is {tiles}", "give whole numbers, such as --tiles 2,2")
    array = Array.preset(preset, (int(boards[0]), int(boards[1])))
    return Scene(array, points, pressures[0] if pressures and len(pressures) == 1 else pressures)


def numbers(name: str, text: str, count: int | tuple[int, ...], cure: str) -> list[float]:
    """Return finite numbers that are separated by commas; `cure` describes them in an error."""
    try:
        numbers = [float(number) for number in text.strip("[]() ").split(",")]
    except ValueError:
        numbers = []
    counts = (count,) if isinstance(count, int) else count
    if len(numbers) not in counts or not all(map(math.isfinite, numbers)):
        raise refused(name, text, f"give {cure}")
    return numbers


def check_outputs(*outputs: tuple[Path | None, tuple[str, ...]], taken: Iterable[Path] = ()) -> None:
    """Reject output files that cannot be written, are in `taken`, or are given twice."""
    others = list(taken)
    for path, endings in outputs:
        if path is not None and path != STANDARD:
            output.check(path, endings, others)
            others.append(path)
