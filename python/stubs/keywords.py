"""Type stubs of the keywords that the core declares, from its Rust source.

For each solver there is a TypedDict of its options: editors complete the options, and type checkers reject
options that the solver does not have.
"""

import re
from collections.abc import Iterator
from pathlib import Path

CORE = Path(__file__).resolve().parents[2] / "core" / "src"

#: Doc comments before a declaration.
ABOUT = r"((?:^ *///[^\n]*\n)+) *"

NUMBER = re.compile(ABOUT + r"(\w+)( = [^\n]*)?, such as", re.MULTILINE)
PART = re.compile(ABOUT + r"(\w+), such as .*?: (\w+)\(", re.MULTILINE)
SOLVER = re.compile(r"^options! \{\n(?: *///[^\n]*\n)*    pub struct (\w+) \{\n(.*?)^    \}", re.MULTILINE | re.DOTALL)
OPTION = re.compile(ABOUT + r"pub (\w+): (\w+) =", re.MULTILINE)
SUMMARY = r'^impl Method for {} .*?Info::new\(\s*"[^"]*",\s*"([^"]*)"'
WORDS = re.compile(r"words!\((\w+): (.*)\);")
LIST = re.compile(r"impl OptionValue for (\w+) \{\s*const WORDS: [^=]*= &\[(.*)\];\s*const LIST: bool = true;")

KEYWORDS = '''"""Keywords that the core declares: of the air, of arrays, of scenes and of each solver.
Made by python/stubs at each build.
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

#: Types in Python.
TYPES = {"u32": "int", "u64": "int", "f64": "float", "bool": "bool"}

#: For each kind of an array's parts: the type of its keyword, and the type of its property.
KINDS = {
    "Real": ("float", "float"),
    "Directivity": ("_Directivity", "_Directivity"),
    "Complexes": ("ArrayLike", "NDArray[np.complex128] | None"),
    "Flags": ("ArrayLike", "NDArray[np.bool_]"),
    "Indices": ("ArrayLike", "NDArray[np.int64] | None"),
    "Quantization": ("_Quantization", "dict[str, int | NDArray[np.float64] | None] | None"),
}


def text(*names: str) -> str:
    """Returns a file of the core."""
    return CORE.joinpath(*names).read_text(encoding="utf-8")


def said(about: str) -> str:
    """Returns doc comments as one line."""
    return " ".join(re.findall(r"/// (.*)", about))


def getter(name: str, kind: str, about: str) -> list[str]:
    """Returns the lines of a property."""
    return ["    @property", f"    def {name}(self) -> {kind}:", f'        """{about}"""']


def air() -> str:
    """Returns two stubs: the keywords of the air, and a scene's properties that return these numbers."""
    keys, numbers = ["class Air(TypedDict, total=False):"], ["", "class Numbers:"]
    for about, name, default in NUMBER.findall(text("scene", "medium.rs")):
        keys += [f"    {name}: float | None", f'    """{said(about)}"""']
        numbers += getter(name, "float", said(about)) if default else []
    return "\n".join(keys + numbers) + "\n"


def parts() -> str:
    """Returns the stubs of an array's parts: their keywords, alone and together with the air's keywords,
    and the array's properties.
    """
    keys, properties = ["class Parts(TypedDict, total=False):"], ["", "class Radiating:"]
    for about, name, kind in PART.findall(text("scene", "part.rs")):
        taken, given = KINDS[kind]
        keys += [f"    {name}: {taken} | None", f'    """{said(about)}"""']
        properties += getter(name, given, said(about))
    return "\n".join([*keys, "", "class Keys(Air, Parts, total=False): ...", *properties]) + "\n"


def solvers() -> Iterator[tuple[str, str, list[tuple[str, list[str], str]]]]:
    """Yields each solver, in the order of the registry: its name, its summary, and name, types and meaning of
    its options.
    """
    source = "\n".join(path.read_text(encoding="utf-8") for path in sorted(CORE.glob("solvers/**/*.rs")))
    types = {name: [kind] for name, kind in TYPES.items()}
    for found, more in ((WORDS, []), (LIST, ["Sequence[int]", "NDArray[np.integer]"])):
        for name, words in found.findall(source):
            listed = ", ".join(re.findall(r'"\w+"', words))
            types[name] = [f"Literal[{listed}]", *more]
    # As its objective, `solve` also accepts a function.
    numbers = ", ".join(["NDArray[np.complex64]", *["NDArray[np.float64]"] * 2])
    types["Objective"].append(f"Callable[[{numbers}], ArrayLike]")
    declared = dict(SOLVER.findall(source))
    for name in re.findall(r"Entry::of::<(\w+)>\(\),", source):
        summary = re.search(SUMMARY.format(name), source, re.MULTILINE | re.DOTALL)
        assert summary, name
        options = OPTION.findall(declared[name])
        yield name, summary[1], [(option, types[kind], said(about)) for about, option, kind in options]


def keywords() -> str:
    """Returns the stub file of keywords: a class of options for each solver,
    and classes that add the keywords of each call.
    """
    classes: dict[str, list[str]] = {}
    every: dict[str, list[str]] = {}
    for name, summary, options in solvers():
        classes[name] = fields = [f'"""{summary}."""']
        for option, kinds, about in options:
            # `lambda` is a reserved word of Python.
            key = "lambda_" if option == "lambda" else option
            every[key] = list(dict.fromkeys([*every.get(key, []), *kinds]))
            fields += [f"{key}: {' | '.join(kinds)} | None", f'"""{about}"""']
    fields = [f"{key}: {' | '.join(kinds)} | None" for key, kinds in every.items()]
    classes["Every"] = ['"""Options of all solvers, for the one that a scene file names."""', *fields]
    made = [KEYWORDS.format(air=air(), parts=parts())]
    for name, lines in classes.items():
        made += ["\n".join([f"class {name}(TypedDict, total=False):", *(f"    {line}" for line in lines)])]
        made += [f"class Setting{name}(Setting, {name}): ...\n"]
    return "\n".join(made)
