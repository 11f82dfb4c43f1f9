"""Writes the type stubs of keywords that the core declares: `make generated`.

For each solver there is a TypedDict of its options: editors complete the options, and type checkers reject
options that the solver does not have. `__main__.py` makes the other stubs at each build.
"""

from __future__ import annotations

import inspect
from pathlib import Path

import midair

STUB = Path(__file__).parents[1] / "midair" / "_keywords.pyi"

KEYWORDS = '''"""Keywords that the core declares: of the air, of arrays, of scenes and of each solver.
Made by `make generated`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._midair import Array, Bead, Plane

_Directivity: TypeAlias = str | dict[str, float]
_Quantization: TypeAlias = dict[str, int | ArrayLike | None]

{air}
{parts}
class _Request(Keys, total=False):
    signature: str | ArrayLike | Sequence[str | None] | None
    bead: Bead | Mapping[str, Any] | None
    obstacles: Iterable[Any] | None

class Changes(_Request, total=False):
    array: Array | None
    points: ArrayLike | None
    pressures: ArrayLike | None
    weights: ArrayLike | None
    plane: Plane | None

class Setting(_Request, total=False):
    positions: ArrayLike | None
    balance: bool | None
    aim: Literal["target", "max"] | None
'''


def kind(name: str, option: midair.OptionInfo) -> list[str]:
    """Returns the types that an option takes."""
    words = ", ".join(f'"{word}"' for word in option.words)
    own = f"Literal[{words}]" if words else type(option.default).__name__
    if name == "objective":
        # As its objective, `solve` also accepts a function.
        return [own, "Callable[[NDArray[np.complex64], NDArray[np.float64], NDArray[np.float64]], ArrayLike]"]
    return [own, "Sequence[int]", "NDArray[np.integer]"] if option.list else [own]


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
        text += [f"class Setting{name}(Setting, {name}): ...\n"]
    return "\n".join(text)


if __name__ == "__main__":
    STUB.write_text(keywords(), encoding="utf-8")
