"""Allowed imports within the package: from lower layers only, without cycles;
lazy and type-checking imports count.
"""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import midair
from midair._toolbox import HOMES

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

#: The modules of fewer than 40 lines, each with the reason why it is not merged into another one.
SHORT = {
    "midair.__main__": "python -m midair",
    "midair._boards.start": "the guard's process begins here, before it imports what a board needs",
    "midair._studio.widget": "imports anywidget, an extra",
}

#: Public modules, which have public names only.
PUBLIC = ("midair", "midair.grad", "midair.jax", "midair.torch", "midair.path", "midair.shape")


def imported(text: str, package: str) -> Iterator[str]:
    """Yields the dotted names that a module imports anywhere in its file."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")
            above = parts[: len(parts) + 1 - node.level] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            yield from (f"{origin}.{alias.name}" for alias in node.names)


def graph(texts: dict[str, str]) -> dict[str, set[str]]:
    """Returns the modules that each module imports, by dotted names; `a.b.__init__` is the package a.b."""
    known = {name.removesuffix(".__init__") for name in texts} | {"midair._midair"}

    def longest(name: str) -> str | None:
        parts = name.split(".")
        return next((part for n in range(len(parts), 0, -1) if (part := ".".join(parts[:n])) in known), None)

    uses = {}
    for name, text in texts.items():
        module, package = name.removesuffix(".__init__"), name.rpartition(".")[0]
        uses[module] = {used for inner in imported(text, package) if (used := longest(inner))} - {module}
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
        ".".join(("midair", *file.relative_to(PACKAGE).with_suffix("").parts)): file.read_text(
            encoding="utf-8"
        )
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
        ("midair._sweep.axes", "import midair"),
    ],
)
def test_an_import_of_a_higher_layer_is_seen(module: str, line: str) -> None:
    texts = sources()
    texts[module] += f"\n{line}\n"
    assert len(upward(graph(texts))) == 1


def test_a_circle_is_seen_through_a_type_checking_import() -> None:
    texts = sources()
    texts["midair._sweep.axes"] += "\nif TYPE_CHECKING:\n    from .block import Block\n"
    texts["midair._sweep.block"] += "\nfrom .axes import plain\n"
    assert set(circle(graph(texts))) == {"midair._sweep.axes", "midair._sweep.block"}


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
    (block, *_) = (
        node
        for node in ast.parse(sources()["midair.__init__"]).body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    seen = {
        node.module: {alias.name for alias in node.names}
        for node in block.body
        if isinstance(node, ast.ImportFrom) and node.module
    }
    assert seen == {home: set(names.split()) for home, names in HOMES.items() if names}
    later = {name for names in HOMES.values() for name in names.split()}
    assert later | {home for home, names in HOMES.items() if not names} <= set(midair.__all__)


def test_the_extension_imports_no_module_of_the_package() -> None:
    sources = Path(__file__).parents[1].joinpath("src").glob("*.rs")
    assert [file.name for file in sources if re.search(r'"midair\.(?!_midair")[a-z_]', code_of(file))] == []


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
