"""What commands are given: common keywords, those of a function of the library, the scene, and outputs."""

import math
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from inspect import Parameter as Argument, signature, unwrap
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast, get_type_hints

from cyclopts import Parameter
from docstring_parser import parse

from .. import Array, Scene
from .._midair import scene_files, stated
from .._support import output
from .._support.arguments import refused

Command = TypeVar("Command", bound=Callable[..., int])

Json = Annotated[bool, Parameter(negative=(), help="Print one JSON document instead of the table.", show_default=False)]
OutputFile = Annotated[Path | None, Parameter(name=["--output", "-o"])]
#: Numbers with commas, which may begin with a minus.
Numbers = Annotated[str | None, Parameter(allow_leading_hyphen=True)]
#: An option that may be given several times, each time with numbers.
Places = Annotated[list[str] | None, Parameter(allow_leading_hyphen=True, negative=())]
SceneName = Annotated[Path, Parameter(help="Scene file, TOML or JSON, or - for standard input.")]
SolverName = Annotated[str | None, Parameter(help="Name of the solver; by default the scene file's, else uniform.")]


def of(function: Callable[..., Any], names: str) -> Callable[[Command], Command]:
    """Give a command some keywords of a library's function, with its types, defaults and explanations.

    The command takes them as its last argument, `**keywords`. In its help they come before its own keywords.
    """
    taken, hints = signature(function).parameters, get_type_hints(unwrap(function))
    explained = {
        name: entry.description for entry in parse(function.__doc__ or "").params for name in entry.arg_name.split(", ")
    }

    def give(command: Command) -> Command:
        @wraps(command)
        def full(*arguments: Any, **keywords: Any) -> int:
            # The parser passes only what was typed.
            return command(*arguments, **{name: taken[name].default for name in names.split()} | keywords)

        own = [each for each in signature(command).parameters.values() if each.kind is not Argument.VAR_KEYWORD]
        places = [each for each in own if each.kind is not Argument.KEYWORD_ONLY]
        given = [
            taken[name].replace(annotation=Annotated[hints[name], Parameter(help=explained[name])])
            for name in names.split()
        ]
        parameters = [*places, *given, *own[len(places) :]]
        cast(Any, full).__signature__ = signature(command).replace(parameters=parameters)
        return cast(Command, full)

    return give


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


def typed(preset: str | None, tiles: str | None, at: Sequence[str] | None, pressure: str | None) -> Scene:
    """Return a scene without a file: an array by its preset, and points one by one."""
    example = "--preset autd3 --at 0,0,0.15"
    if preset is None and not at:
        cure = f"give a scene file (midair new writes one), or {example}"
        raise stated("scene", "is left out", cure, code="missing")
    if preset is None:
        cure = f"say which array, as in {example}; midair presets lists them"
        raise stated("--preset", "is left out", cure, code="missing")
    if not at:
        cure = f"give the points, as in {example} --at 0.02,0,0.15"
        raise stated("--at", "is left out", cure, code="missing")
    points = [numbers("--at", point, 3, "three numbers in m, such as --at 0,0,0.15") for point in at]
    pressures = None
    if pressure is not None:
        each = f", or {len(points)} with commas between, one a point" if len(points) > 1 else ""
        cure = f"one pressure in Pa{each}"
        pressures = numbers("--pressure", pressure, (1, len(points)), cure)
    boards = numbers("--tiles", (tiles or "1,1").replace("x", ","), 2, "boards along x and y, such as --tiles 2,2")
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
