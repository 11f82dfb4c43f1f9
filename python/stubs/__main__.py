"""Writes the type stubs of the package and of its extension: `python stubs FOLDER`.

Those of the extension are made from its Rust source and docstrings. The build script calls this program;
maturin puts the files beside the extension, in wheels and after `maturin develop`.
"""

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from textwrap import indent

import source
from keywords import keywords, solvers
from kinds import Kinds, entries
from source import Argument, Class, Function

CRATE = Path(__file__).resolve().parents[1]
TOOLBOX = CRATE / "midair" / "_toolbox.py"

HEAD = '''"""The compiled core. Made by python/stubs at each build."""

import pathlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypeAlias, Unpack, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _keywords as k\n'''

#: Classes to which Python adds properties, from the core's tables, with the stubs of these.
BASES = {"Array": "(k.Radiating)", "Scene": "(k.Numbers)"}

#: Types of `**name`.
OTHERS = {"parts": "Unpack[k.Parts]", "keys": "Unpack[k.Keys]", "changes": "Unpack[k.Changes]"}

#: Parameters that decide which of two types a function returns: the first without them, the second with them.
DECIDING = ("out", "points")

#: Methods that need no stub.
HIDDEN = ("_restore", "__reduce__", "__repr__", "__eq__")

#: Default values of Rust in Python; others are not shown.
DEFAULTS = {"true": "True", "false": "False", "None": "None"}


class Stub:
    """The text of the stub file. Here the kind of an argument is its type in Python."""

    def __init__(self) -> None:
        self.exported = source.read(CRATE)
        self.kinds = Kinds(self.exported)
        self.attached = attached(TOOLBOX.read_text(encoding="utf-8"))
        #: The types of a solver's name, and the keywords that go with it.
        self.solvers = {f'Literal["{name.lower()}"]': name for name, *_ in solvers()}
        self.solvers |= {"None": "Every", "str": ""}

    def lines(self) -> Iterator[str]:
        """Yields parts of the file."""
        yield HEAD
        for methods in self.attached.values():
            for home, function in methods.values():
                # A function of the extension is imported from the package, not from this file.
                place = "." if home == "_midair" else f".{home}"
                yield f"from {place} import {function} as {local(home, function)}\n"
        functions, constants = self.exported.functions, self.exported.constants
        names = [functions[name].name if name in functions else name for name in self.exported.names]
        names += [constant.name for constant in constants]
        listed = ", ".join(f'"{name}"' for name in sorted(names))
        yield f"\n__all__ = [{listed}]\n\n_Parts: TypeAlias = k.Parts\n\n"
        for constant in constants:
            kind = self.kinds.result(constant.kind, "", "")
            yield f'{constant.name}: Final[{kind}]\n"""{constant.doc}"""\n'
        for name in self.exported.names:
            if owner := self.exported.classes.get(name):
                yield from self.class_(name, owner)
            elif exception := self.exported.exceptions.get(name):
                base, doc = exception
                yield f"\nclass {name}({base}):{ended(doc, 1)}"
                for attribute, kind in entries(doc, "Attributes").items():
                    yield f"    {attribute}: {kind or 'Any'}\n"
            else:
                yield from self.function(functions[name], "")

    def class_(self, name: str, owner: Class) -> Iterator[str]:
        """Yields the parts of a class."""
        doc = owner.doc.replace("{medium}\n{parts}", "**keys").replace("{parts}", "**parts")
        yield f"\n@final\nclass {name}{BASES.get(name, '')}:{ended(doc, 1)}"
        for each in owner.properties:
            kind = self.kinds.result(each.kind, "", name)
            yield f"    @property\n    def {each.name}(self) -> {kind}:{ended(each.doc, 2)}"
        for method in owner.methods:
            if method.name == "_new":
                method = replace(method, name="__new__", doc=owner.doc, first="cls", returns="Self")
            if method.name not in HIDDEN:
                yield from self.function(method, name)
        if any(method.name == "__and__" for method in owner.methods):
            # Python's slot for & has both sides.
            yield "    def __rand__(self, value: Any, /) -> Any: ...\n"
        if re.search(r"\beq\b", owner.options) or any(method.name == "__eq__" for method in owner.methods):
            yield "    def __eq__(self, other: object, /) -> bool: ...\n"
        if re.search(r"\bhash\b", owner.options):
            yield "    def __hash__(self) -> int: ...\n"
        for method_name, (home, function) in self.attached.get(name, {}).items():
            yield f"    {method_name} = {local(home, function)}\n"

    def function(self, function: Function, owner: str) -> Iterator[str]:
        """Yields a function or a method, with overloads where its arguments decide."""
        # `**others` are mistyped keywords, which the function refuses.
        stated = (each for each in function.arguments if each.name != "others")
        arguments = [self.argument(each, function, owner) for each in stated]
        returns = self.kinds.result(function.returns, function.doc, owner)
        overloads = list(self.overloads(arguments, returns))
        name, margin = function.name, "    " * bool(owner)
        for k, (taken, made) in enumerate(overloads):
            before = ["@overload\n"] * (len(overloads) > 1)
            before += ["@staticmethod\n"] * (bool(owner) and not function.first)
            parameters = listed(function.first, taken)
            if name.startswith("__") and name not in ("__new__", "__call__"):
                parameters += ", /"
            doc = function.doc if k == 0 and name != "__new__" else ""
            yield "" if owner else "\n"
            yield from (f"{margin}{line}" for line in before)
            yield f"{margin}def {name}({parameters}) -> {made}:{ended(doc, 1 + bool(owner))}"

    def argument(self, argument: Argument, function: Function, owner: str) -> Argument:
        """Returns an argument in Python."""
        kind = argument.by == "**" and OTHERS.get(argument.name)
        kind = kind or self.kinds.argument(argument.name, argument.kind, function.doc, owner)
        if argument.default == "None" and kind != "Any" and not kind.endswith(" | None"):
            kind += " | None"
        default = argument.default
        if default is not None and not re.match(r"""["'(\-\d]""", default):
            default = DEFAULTS.get(default, "...")
        return replace(argument, kind=kind, default=default)

    def overloads(self, arguments: list[Argument], returns: str) -> Iterator[tuple[list[Argument], str]]:
        """Yields the arguments and the result of each overload."""
        place = {each.name: k for k, each in enumerate(arguments)}
        without, _, with_ = returns.partition(" | ")
        deciding = next((place[name] for name in DECIDING if name in place), None)
        if deciding is not None and with_ not in ("", "None"):
            one = arguments[deciding]
            kind = one.kind.replace(" | None", "")
            yield changed(arguments, deciding, replace(one, kind="None", default="None")), without
            yield changed(arguments, deciding, replace(one, kind=kind, default=None)), with_
            return
        if "solver" not in place or "options" not in place:
            yield arguments, returns
            return
        solver, options = place["solver"], place["options"]
        callables = {"Callable[..., ArrayLike]": ""} if "Callable" in arguments[solver].kind else {}
        # Keywords that `Solver` and `solve_batch` take as options have parameters of their own in `solve`.
        setting = "" if "positions" in place else "Setting"
        for kind, own in (self.solvers | callables).items():
            default = "None" if kind == "None" else None
            named = changed(arguments, solver, replace(arguments[solver], kind=kind, default=default))
            if kind == "str" and not setting:
                del named[options]
            else:
                typed = f"Unpack[k.{setting}{own}]" if setting or own else "Any"
                named[options] = replace(named[options], kind=typed)
            before = named[:solver]
            if default is None and any(each.default for each in before):
                # By position, if all before it are given; else by keyword.
                yield [*(replace(each, default=None) for each in before), *named[solver:]], returns
                named[solver:] = [replace(each, by=each.by or "*") for each in named[solver:]]
            yield named, returns


def changed(arguments: list[Argument], place: int, argument: Argument) -> list[Argument]:
    """Returns the arguments with another one at a place."""
    return [*arguments[:place], argument, *arguments[place + 1 :]]


def listed(first: str, arguments: list[Argument]) -> str:
    """Returns a function's parameters as text."""
    parts, by = [first] if first else [], ""
    for each in arguments:
        if each.by == "*" and not by:
            parts.append("*")
        by = each.by
        default = "" if each.default is None else f" = {each.default}"
        parts.append(f"{'**' if by == '**' else ''}{each.name}: {each.kind}{default}")
    return ", ".join(parts)


def ended(doc: str, depth: int) -> str:
    """Returns the end of a definition, with its docstring."""
    if not doc:
        return " ...\n"
    margin = "    " * depth
    end, raw = f"\n{margin}" * ("\n" in doc), "r" * ("\\" in doc)
    return f'\n{margin}{raw}"""{indent(doc, margin).strip()}{end}"""\n'


def local(home: str, function: str) -> str:
    """Returns the name in the stub of a function of the package."""
    return f"_{home.lstrip('_').replace('.', '')}_{function}"


def attached(toolbox: str) -> dict[str, dict[str, tuple[str, str]]]:
    """Returns the methods that `_toolbox.METHODS` adds to classes: home and name of each function."""
    table = assigned(toolbox, "METHODS")
    return {
        ast.unparse(owner): {
            name.value: tuple(word.value for word in call.args)
            for name, call in zip(methods.keys, methods.values, strict=True)
        }
        for owner, methods in zip(table.keys, table.values, strict=True)
    }


def assigned(toolbox: str, name: str) -> ast.Dict:
    """Returns the table of this name in `_toolbox`."""
    values = (
        node.value
        for node in ast.parse(toolbox).body
        if isinstance(node, ast.Assign | ast.AnnAssign) and re.match(rf"{name}\b", ast.unparse(node))
    )
    return next(value for value in values if isinstance(value, ast.Dict))


def package(toolbox: str) -> Iterator[str]:
    """Yields the lines of the package's stub: its public names, which are loaded at their first use.

    The package's own modules import it: mypy reads such a circle in a good order only if these imports stand
    under TYPE_CHECKING.
    """
    yield "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n"
    for home, names in ast.literal_eval(assigned(toolbox, "HOMES")).items():
        listed = ", ".join(f"{name} as {name}" for name in names.split() or [home])
        yield f"    from .{home if names else ''} import {listed}\n"
    yield "\n__version__: str\n"


if __name__ == "__main__":
    stubs = {
        "_midair.pyi": Stub().lines(),
        "_keywords.pyi": keywords(),
        "__init__.pyi": package(TOOLBOX.read_text(encoding="utf-8")),
    }
    for name, lines in stubs.items():
        Path(sys.argv[1], name).write_text("".join(lines), encoding="utf-8")
