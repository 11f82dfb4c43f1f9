"""Adds the compiled core's docstrings and signatures to its stubs,
from which the reference pages are made.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from typing import Any

import griffe

from midair import _midair as compiled

#: Classes of keywords in `midair._keywords`, besides those of each solver.
KEYWORDS = ("Board", "Solve", "Setting", "Solver", "Batch")


class Docstrings(griffe.Extension):
    """Completes the stubs of `midair._midair` after the package is read and before its aliases are
    resolved.
    """

    def on_package(self, *, pkg: griffe.Module, loader: griffe.GriffeLoader, **_: Any) -> None:
        """Handles every name that the compiled core exports."""
        self.pkg, self.loader = pkg, loader
        for name in compiled.__all__:
            # A function that has only overloads in the stubs is not a member of the stub module.
            thing, found = getattr(compiled, name), pkg["_midair"].members.get(name)
            stubs = pkg[found.target_path.split(".")[1]] if found and found.is_alias else pkg["_midair"]
            if name not in stubs.members:
                stubs.set_member(name, self.joined(name, thing, stubs, stubs.overloads.get(name, [])))
            self.describe(stubs.members[name], thing)

    def describe(self, described: griffe.Object, thing: Any) -> None:
        """Adds the docstring that a class or function has at run time, also for a class's members."""
        text = getattr(thing, "__doc__", None)
        if text and described.docstring is None:
            parser, options = self.loader.docstring_parser, self.loader.docstring_options
            described.docstring = griffe.Docstring(
                text, parent=described, parser=parser, parser_options=options
            )
        if isinstance(described, griffe.Class):
            self.construct(described, thing)
            for name, member in list(described.members.items()):
                if not name.startswith("_"):
                    own = getattr(thing, name)
                    if isinstance(member, griffe.Attribute) and callable(own):
                        described.set_member(name, member := self.method(name, own, described))
                    self.describe(member, own)

    def method(self, name: str, thing: Any, parent: griffe.Class) -> griffe.Function:
        """Returns a function of the package as a method of a compiled class: its first argument becomes
        `self`.
        """
        written = inspect.unwrap(thing)
        home = self.pkg[written.__module__.removeprefix("midair.")]
        found = home.members[written.__name__]
        parameters = griffe.Parameters(*list(found.parameters)[1:])
        return griffe.Function(name, parameters=parameters, returns=found.returns, parent=parent)

    def construct(self, described: griffe.Class, thing: Any) -> None:
        """Adds `__init__` with the parameters of a class, because the reference pages show its parameters."""
        new = described.members.get("__new__")
        if isinstance(new, griffe.Function):
            init = griffe.Function("__init__", parameters=new.parameters, parent=described)
        elif "__new__" in described.overloads:
            init = self.joined("__init__", thing, described, described.overloads["__new__"])
            init.returns = None
        else:
            return
        described.members["__init__"] = init

    def joined(
        self, name: str, thing: Any, parent: griffe.Module | griffe.Class, overloads: list[griffe.Function]
    ) -> griffe.Function:
        """Returns one function for several overloads, with a signature that covers them all."""
        parameters = [
            griffe.Parameter(
                one.name,
                annotation=" | ".join(dict.fromkeys(self.kinds(one.name, overloads))) or None,
                kind=griffe.ParameterKind(one.kind.description),
                default=None if one.default is one.empty else repr(one.default),
            )
            for one in inspect.signature(thing).parameters.values()
        ]
        returns = " | ".join(dict.fromkeys(str(one.returns) for one in overloads)) or None
        return griffe.Function(
            name, parameters=griffe.Parameters(*parameters), returns=returns, parent=parent
        )

    def kinds(self, name: str, overloads: list[griffe.Function]) -> Iterator[str]:
        """Yields the types of a parameter in the overloads (str for a solver's name),
        or of a keyword in its classes.
        """
        for one in overloads:
            if name in one.parameters and name != "options":
                text = self.plain(one.parameters[name].annotation)
                yield "str" if text.startswith("Literal") else text
        if not any(name in one.parameters for one in overloads):
            for owner in KEYWORDS:
                keyword = self.pkg["_keywords"][owner].members.get(name)
                if keyword is not None:
                    yield self.plain(keyword.annotation)
                    return

    def plain(self, annotation: Any) -> str:
        """Returns a type with the stubs' private aliases replaced by their values."""
        text = str(annotation)
        for stubs in ("_calls", "_midair"):
            for name in re.findall(r"\b_[A-Z]\w+", text):
                alias = self.pkg[stubs].members.get(name)
                text = text.replace(name, str(alias.value)) if alias and not alias.is_alias else text
        return text
