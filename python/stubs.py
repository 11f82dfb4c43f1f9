"""Writes the type stubs of calls that take a solver's options, from the solver table: `make stubs`.

For each solver there is a TypedDict of its options and an overload of `solve`, `Solver` and `solve_batch`:
editors complete the options, and type checkers reject options that the solver does not have.
"""

from __future__ import annotations

import inspect
from pathlib import Path

import midair

FOLDER = Path(__file__).parent / "midair"

KEYWORDS = '''"""Keywords by solver and call: its options, and what goes beside them. Made by `make stubs`."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._midair import Solution, _Directivity, _Obstacle, _Quantization

{air}
{parts}
class Board(TypedDict, total=False):
    quantization: _Quantization | None
    mask: ArrayLike | None
    positions: ArrayLike | None
    balance: bool | None
    aim: Literal["target", "max"] | None

class Solve(Board, total=False):
    pressures: ArrayLike | None
    weights: ArrayLike | None
    start: ArrayLike | Solution | None
    progress: Callable[[int, int, float], object] | None
    trace: bool

class Setting(Board, Keys, total=False):
    signature: str | ArrayLike | Sequence[str | None] | None
    bead: Mapping[str, Any] | None
    obstacles: Iterable[_Obstacle] | None

class Solver(Setting, total=False):
    points: int | None

class Batch(Setting, total=False):
    weights: ArrayLike | None
    start: ArrayLike | None
    out: NDArray[np.complex64] | None
    threads: int | None
    progress: Callable[[int, int, float], object] | None
'''

CALLS = '''"""The calls that take a solver's options, an overload for each solver. Made by `make stubs`.

Where the name is known only when the program runs, options are handed over as `**options`, a dict[str, Any].
"""

from collections.abc import Callable
from typing import Any, Final, Literal, TypeAlias, Unpack, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _keywords as k
from ._midair import Array, Batch, Metrics, Propagation, Scene, Solution, _Option

_Given: TypeAlias = Scene | Propagation
_Driven: TypeAlias = Scene | Array | Propagation
_Numbers: TypeAlias = ArrayLike | None

{solve}@overload
def solve(scene: _Given, solver: Callable[..., ArrayLike], **keywords: Any) -> Solution: ...

@final
class Solver:
{solver}    @overload
    def __call__(
        self,
        points: _Numbers = None,
        pressures: _Numbers = None,
        *,
        weights: _Numbers = None,
        start: ArrayLike | Solution | None = None,
        out: None = None,
    ) -> Solution: ...
    @overload
    def __call__(
        self,
        points: _Numbers = None,
        pressures: _Numbers = None,
        *,
        weights: _Numbers = None,
        start: ArrayLike | Solution | None = None,
        out: NDArray[np.complex64],
    ) -> Solver: ...
    def follow(
        self, points: ArrayLike, pressures: _Numbers = None, margin: int = 0
    ) -> NDArray[np.complex64]: ...
    def reset(self) -> None: ...
    def last(
        self,
    ) -> tuple[NDArray[np.complex64], NDArray[np.float32], float, NDArray[np.float64]] | None: ...
    def restore(
        self,
        drives: NDArray[np.complex64],
        weights: NDArray[np.float32],
        unevenness: float,
        motion: NDArray[np.float64],
    ) -> None: ...
    drive: Final[NDArray[np.complex64]]
    pressures: Final[NDArray[np.complex64]]
    metrics: Final[Metrics]
    complex_error: Final[float | None]
    status: Final[str]
    scale: Final[float]
    steps: Final[int]
    elapsed: Final[float]
    solver: Final[str]
    options: Final[dict[str, _Option]]

{batch}'''


def kind(name: str, option: midair.OptionInfo) -> list[str]:
    """Returns the types that an option takes."""
    words = ", ".join(f'"{word}"' for word in option.words)
    own = f"Literal[{words}]" if words else type(option.default).__name__
    if name == "objective":
        # As its objective, `solve` also accepts a function.
        return [own, "Callable[[NDArray[np.complex64], NDArray[np.float64], NDArray[np.float64]], ArrayLike]"]
    return [own, "Sequence[int]", "NDArray[np.integer]"] if option.list else [own]


BODY = """
@final
class {name}:
    def __new__(
        cls, {arguments}, kind: Literal["rigid", "soft"] = "rigid"
    ) -> {name}: ...
{parts}    kind: Final[Literal["rigid", "soft"]]
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
"""


def bodies() -> str:
    """Returns the stub file of obstacles (one class per kind) that a few numbers describe."""
    kinds = midair._midair.bodies()
    text = '"""Obstacles of a few numbers, from the core. Made by `make stubs`."""\n\n'
    text += "from typing import Final, Literal, TypeAlias, final\n\nfrom numpy.typing import ArrayLike\n\n"
    text += f"__all__ = {sorted(kinds)}\n".replace("'", '"')
    for name, parts in kinds.items():
        given = {part: "float" if count == 1 else "ArrayLike" for part, count in parts.items()}
        known = {
            part: "float" if count == 1 else f"tuple[{', '.join(['float'] * count)}]"
            for part, count in parts.items()
        }
        text += BODY.format(
            name=name,
            arguments=", ".join(f"{part}: {kind}" for part, kind in given.items()),
            parts="".join(f"    {part}: Final[{kind}]\n" for part, kind in known.items()),
        )
    return text + f"\nBody: TypeAlias = {' | '.join(kinds)}\n"


def getter(name: str, kind: str, owner: type) -> list[str]:
    """Returns the stub of a property: its lines, with the docstring that it has at run time."""
    about = inspect.getdoc(getattr(owner, name))
    return ["    @property", f"    def {name}(self) -> {kind}:", f'        """{about}"""']


def air() -> str:
    """Returns two stubs: the keywords of the air, and a scene's properties that return these numbers."""
    lines = ["class Air(TypedDict, total=False):"]
    for name, (_, about) in midair._midair.scene_keys()["medium"].items():
        lines += [f"    {name}: float | None", f'    """{about}"""']
    lines += ["", "class Numbers:"]
    for name in midair.Scene(midair.Array([[0, 0, 0]]), [[0, 0, 1]]).medium:
        lines += getter(name, "float", midair.Scene)
    return "\n".join(lines) + "\n"


#: For each kind of an array's parts: the type of its keyword, and the type of its property.
KINDS = {
    "real": ("float", "float"),
    "directivity": ("_Directivity", "_Directivity"),
    "complexes": ("ArrayLike", "NDArray[np.complex128] | None"),
    "flags": ("ArrayLike", "NDArray[np.bool_]"),
    "indices": ("ArrayLike", "NDArray[np.int64] | None"),
    "quantization": ("_Quantization", "dict[str, int | NDArray[np.float64] | None] | None"),
}


def parts() -> str:
    """Returns the stubs of an array's parts: their keywords, alone and together with the air's keywords,
    and the array's properties.
    """
    kinds = midair._midair.array_parts()
    lines = ["class Parts(TypedDict, total=False):"]
    for name, kind in kinds.items():
        about = midair._midair.scene_keys()["array"][name][1]
        lines += [f"    {name}: {KINDS[kind][0]} | None", f'    """{about}"""']
    lines += ["", "class Keys(Air, Parts, total=False): ...", "", "class Radiating:"]
    for name, kind in kinds.items():
        lines += getter(name, KINDS[kind][1], midair.Array)
    return "\n".join(lines) + "\n"


def keywords() -> str:
    """Returns the stub file of keywords: a class of options for each solver,
    and classes that add the keywords of each call.
    """
    classes: dict[str, list[str]] = {}
    every: dict[str, list[str]] = {}
    for name, info in midair.solvers().items():
        classes[name.title()] = fields = [f'"""{info.summary}."""']
        for option_name, option in info.options.items():
            # `lambda` is a reserved word of Python.
            key = "lambda_" if option_name == "lambda" else option_name
            every[key] = list(dict.fromkeys([*every.get(key, []), *kind(option_name, option)]))
            fields += [f"{key}: {' | '.join(kind(option_name, option))} | None", f'"""{option.doc}"""']
    fields = [f"{key}: {' | '.join(kinds)} | None" for key, kinds in every.items()]
    classes["Every"] = ['"""Options of all solvers, for the one that a scene file names."""', *fields]
    text = [KEYWORDS.format(air=air(), parts=parts())]
    for name, lines in classes.items():
        text += ["\n".join([f"class {name}(TypedDict, total=False):", *(f"    {line}" for line in lines)])]
        text += [
            "".join(f"class {call}{name}({call}, {name}): ...\n" for call in ("Solve", "Solver", "Batch"))
        ]
    return "\n".join(text)


def calls() -> str:
    """Returns the stub file of calls: overloads for each solver's name, for no name,
    and for a name that is not a literal.
    """
    solvers = [(f'Literal["{name}"]', name.title()) for name in midair.solvers()]
    solvers += [("None = None", "Every"), ("str", "")]

    def overload(call: str, arguments: str, keywords: str, result: str, indent: str = "") -> str:
        signature = f"def {call}({arguments}, **keywords: Unpack[k.{keywords}]) -> {result}: ..."
        return f"{indent}@overload\n{indent}{signature}\n"

    solve = solver = batch = ""
    first = "scene: _Driven, points: _Numbers, pressures: _Numbers, solver: "
    left_out = "scene: _Driven, points: _Numbers = None, pressures: _Numbers = None, "
    for name, title in solvers:
        solve += overload("solve", f"scene: _Given, solver: {name}", f"Solve{title}", "Solution")
        solver += overload(
            "__new__", f"cls, scene: _Driven, solver: {name}", f"Solver{title}", "Solver", "    "
        )
        # `solver` is the fourth argument, or a keyword if points or pressures are left out.
        if title != "Every":
            batch += overload("solve_batch", first + name, f"Batch{title}", "Batch")
        batch += overload("solve_batch", f"{left_out}*, solver: {name}", f"Batch{title}", "Batch")
    return CALLS.format(solve=solve, solver=solver, batch=batch)


if __name__ == "__main__":
    FOLDER.joinpath("_keywords.pyi").write_text(keywords(), encoding="utf-8")
    FOLDER.joinpath("_bodies.pyi").write_text(bodies(), encoding="utf-8")
    FOLDER.joinpath("_calls.pyi").write_text(calls(), encoding="utf-8")
