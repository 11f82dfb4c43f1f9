"""Allowed imports within the package: from lower layers only, without cycles;
lazy and type-checking imports count, and so do modules that a text names.
"""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import midair

PACKAGE = Path(midair.__file__).parent

#: Packages and single modules from the lowest layer up; each may import those before it, and itself.
LAYERS = (
    "_midair",
    "_support",
    "shape",
    "path",
    "grad",
    "torch",
    "jax",
    "_points",
    "_pictures",
    "_sequence",
    "_flight",
    "_boards",
    "_serve",
    "_files",
    "_sweep",
    "_measuring",
    "_judging",
    "_touch",
    "_studio",
    "_reproduce",
    "_toolbox",
    "midair",
    "_cli",
    "__main__",
)

#: Imports upward, each with its reason.
UPWARD = {
    ("midair._sequence.sequence", "midair._judging.exposure"): "a method, loaded at its first use",
    ("midair.path._optimal", "midair._flight.fly"): "it simulates the fastest run, loaded at its first use",
    ("midair.path._optimal", "midair._sequence.frames"): "as `_flight.fly`",
    ("midair.path._optimal", "midair._sequence.solve"): "as `_flight.fly`",
}

#: Modules that import by a name that they compute, each with the reason.
COMPUTED = {
    "midair._boards.transport": "a kind of transport is loaded by its name in TRANSPORTS",
    "midair._support.slips": "the name stands where a method is declared by Later",
    "midair._toolbox": "HOMES, METHODS and CALLED list the names",
}

#: The modules of fewer than 40 lines, each with the reason why it is not merged into another one.
SHORT = {
    "midair.__main__": "python -m midair",
    "midair._boards.start": "the guard's process begins here, before it imports what a board needs",
    "midair._studio.widget": "imports anywidget, an extra",
}

#: Public modules, which have public names only.
PUBLIC = ("midair", "midair.grad", "midair.jax", "midair.torch", "midair.path", "midair.shape")


parsed = cache(ast.parse)


def imported(text: str, package: str) -> Iterator[str]:
    """Yields the dotted names that a module imports anywhere in its file."""
    for node in ast.walk(parsed(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")
            above = parts[: len(parts) + 1 - node.level] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            yield from (f"{origin}.{alias.name}" for alias in node.names)


def named(text: str, package: str) -> Iterator[str]:
    """Yields the texts that may name a module: `midair.x`, `_x` for `midair._x`, `.x` beside the module."""
    for node in ast.walk(parsed(text)):
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str):
            continue
        name = node.value.lstrip(".")
        if above := len(node.value) - len(name):
            yield ".".join([*package.split(".")[: 1 - above or None], name])
        elif name.startswith("midair."):
            yield name
        elif name.startswith("_") and name != "__main__":
            yield f"midair.{name}"


@cache
def mentioned(text: str, package: str) -> tuple[list[str], list[str]]:
    """Returns the names of `imported` and `named`; most tests change the text of one module only."""
    return list(imported(text, package)), list(named(text, package))


def computes(text: str) -> bool:
    """Returns whether a module imports by a name that is no plain text."""
    nodes = list(ast.walk(parsed(text)))
    importers = {"__import__"} | {
        alias.asname or alias.name
        for node in nodes
        if isinstance(node, ast.ImportFrom) and node.module == "importlib"
        for alias in node.names
    }
    return any(
        isinstance(node, ast.Call)
        and (ast.unparse(node.func) in importers or ast.unparse(node.func).endswith(".import_module"))
        and not (node.args and isinstance(node.args[0], ast.Constant))
        for node in nodes
    )


def graph(texts: dict[str, str]) -> dict[str, set[str]]:
    """Returns the modules that each module imports, by dotted names; `a.b.__init__` is the package a.b."""
    known = {name.removesuffix(".__init__") for name in texts} | {"midair._midair"}

    def longest(name: str) -> str | None:
        parts = name.split(".")
        return next((part for n in range(len(parts), 0, -1) if (part := ".".join(parts[:n])) in known), None)

    uses = {}
    for name, text in texts.items():
        module, package = name.removesuffix(".__init__"), name.rpartition(".")[0]
        imports, names = mentioned(text, package)
        own = {used for inner in imports if (used := longest(inner))} | known.intersection(names)
        uses[module] = {used for used in own if (module, used) not in UPWARD} - {module}
    return uses


def layer(module: str) -> int:
    """Returns the layer of a module: that of its package in midair, or of the module itself."""
    parts = module.split(".")
    name = parts[1] if len(parts) > 1 else parts[0]
    assert name in LAYERS, f"{name} is in no layer: list it"
    return LAYERS.index(name)


def upward(uses: dict[str, set[str]]) -> list[str]:
    return [f"{a} imports {b}" for a in uses for b in sorted(uses[a]) if layer(b) > layer(a)]


def circle(uses: dict[str, set[str]]) -> list[str]:
    """Returns the modules of one import cycle, empty without a cycle."""
    try:
        TopologicalSorter(uses).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def sources() -> dict[str, str]:
    files = sorted(PACKAGE.rglob("*.py"))
    return {
        ".".join(("midair", *file.relative_to(PACKAGE).with_suffix("").parts)): file.read_text(encoding="utf-8")
        for file in files
    }


def test_imports_run_downwards_and_in_no_circle() -> None:
    uses = graph(sources())
    assert upward(uses) == []
    assert circle(uses) == []


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("midair._support.text", "from .._sequence.sequence import Sequence"),
        ("midair._points.ear", "def later():\n    from .. import _boards"),
        ("midair._sweep.engine", "import midair"),
        ("midair._support.text", "import importlib\nimportlib.import_module('midair._boards.guard')"),
        ("midair._support.text", "from importlib import import_module as load\nload('midair._boards')"),
        ("midair._support.text", "import importlib as i\ni.import_module('.._boards', __package__)"),
        ("midair._support.text", "__import__('midair._boards.guard')"),
        ("midair._sequence.drives", "plot = Later('_files', 'read')"),
        ("midair._sequence.drives", "HOMES = {'_files': 'read write'}"),
        ("midair._sequence.drives", "def later() -> None:\n    from .._judging.exposure import exposure"),
    ],
)
def test_an_import_of_a_higher_layer_is_seen(module: str, line: str) -> None:
    texts = sources()
    texts[module] += f"\n{line}\n"
    assert len(upward(graph(texts))) == 1


def test_a_circle_is_seen_through_a_type_checking_import() -> None:
    texts = sources()
    texts["midair._sweep.engine"] += "\nif TYPE_CHECKING:\n    from .block import Block\n"
    texts["midair._sweep.block"] += "\nfrom .engine import pieces\n"
    assert set(circle(graph(texts))) == {"midair._sweep.engine", "midair._sweep.block"}


def test_a_circle_is_seen_through_a_text() -> None:
    texts = sources()
    texts["midair._sweep.engine"] += "\nBLOCK = import_module('.block', __package__)\n"
    texts["midair._sweep.block"] += "\nfrom .engine import pieces\n"
    assert set(circle(graph(texts))) == {"midair._sweep.engine", "midair._sweep.block"}


def test_a_module_that_imports_by_a_computed_name_has_its_reason() -> None:
    assert {name for name, text in sources().items() if computes(text)} == set(COMPUTED)


@pytest.mark.parametrize(
    "line",
    [
        "from importlib import import_module as load\nload(f'midair.{name}')",
        "import importlib\nimportlib.import_module(name)",
        "__import__(name)",
    ],
)
def test_a_computed_name_is_seen(line: str) -> None:
    assert computes(line)


def test_the_package_has_few_modules_and_a_short_one_has_its_reason() -> None:
    texts = {name: text for name, text in sources().items() if not name.endswith(".__init__")}
    assert len(sources()) <= 160
    assert {name for name, text in texts.items() if text.count("\n") < 40} == set(SHORT)


@pytest.mark.parametrize("name", PUBLIC)
def test_public_modules_show_public_names_only(name: str) -> None:
    module = importlib.import_module(name)
    shown = {inner for inner in dir(module) if not inner.startswith("_")}
    assert shown == set(module.__all__) - {"__version__"}


def test_names_that_are_loaded_later_are_those_that_type_checkers_see() -> None:
    stub = parsed(PACKAGE.joinpath("__init__.pyi").read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(stub) if isinstance(node, ast.ImportFrom) and node.level]
    seen = {alias.asname for node in imports for alias in node.names}
    assert seen | {"__version__"} == set(midair.__all__) | {"__version__"}


def test_the_extension_imports_no_module_of_the_package() -> None:
    sources = Path(__file__).parents[1].joinpath("src").glob("*.rs")
    # The module that a class says it is in is not imported.
    other = r'(?<!module = )"midair\.(?!_midair")[a-z_]'
    assert [file.name for file in sources if re.search(other, code_of(file))] == []


def code_of(file: Path) -> str:
    """Returns the lines of a Rust file without comments."""
    lines = file.read_text(encoding="utf-8").splitlines()
    return "\n".join(line for line in lines if not line.lstrip().startswith("//"))


#: A program that checks that `import midair` loads only NumPy and the extension.
LOADED = """
import sys, midair
own = {name for name in sys.modules if name.startswith("midair")}
assert own == {"midair", "midair._midair", "midair._support", "midair._support.slips", "midair._toolbox"}, own
for heavy in ("matplotlib", "rich", "cyclopts", "importlib.metadata", "asyncio", "email", "json"):
    assert heavy not in sys.modules, heavy
assert midair.solve(midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]])).tolerate
midair.read, midair.Sequence, midair.__version__, midair.path.circle, midair.path.Path
"""


@pytest.mark.slow
def test_importing_midair_loads_the_extension_alone() -> None:
    subprocess.run([sys.executable, "-c", LOADED], check=True)


#: A program that checks that `midair --help` loads no command's module.
LISTED = """
import sys
from midair._cli.app import COMMANDS, app, explain
app(["--help"], result_action="return_value")
loaded = {name for name in sys.modules if name.startswith("midair._cli.")}
assert loaded == {"midair._cli.app", "midair._cli.progress"}, loaded
for heavy in ("markdown_it", "pygments", "matplotlib", "asyncio"):
    assert heavy not in sys.modules, heavy
assert all(callable(app[name].default_command) for name in COMMANDS)
explain("exposure")
assert "--at 0,0.1,0.5" in app["exposure"].help
assert all(len(line) <= 62 for _, line in COMMANDS.values())
"""


@pytest.mark.slow
def test_the_list_of_commands_loads_none_and_each_is_there() -> None:
    subprocess.run([sys.executable, "-c", LISTED], check=True)
