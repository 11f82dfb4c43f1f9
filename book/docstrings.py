"""The compiled core's docstrings and signatures, which its stubs lack, for pages written from the stubs."""

from __future__ import annotations

import inspect
from typing import Any

import griffe

from midair import _midair as compiled


def signature(name: str, thing: Any, parent: griffe.Module | griffe.Class) -> griffe.Function:
    """A function that the stubs know only by its overloads, as one: the signature that covers them all."""
    given = inspect.signature(thing).parameters.values()
    parameters = [
        griffe.Parameter(
            one.name,
            kind=griffe.ParameterKind(one.kind.description),
            default=None if one.default is one.empty else repr(one.default),
        )
        for one in given
    ]
    return griffe.Function(name, parameters=griffe.Parameters(*parameters), parent=parent)


def construct(described: griffe.Class, thing: Any) -> None:
    """Gives a class the parameters that it is called with, which pages look for in `__init__`."""
    new = described.members.get("__new__")
    if isinstance(new, griffe.Function):
        init = griffe.Function("__init__", parameters=new.parameters, parent=described)
    elif "__new__" in described.overloads:
        init = signature("__init__", thing, described)
    else:
        return
    described.members["__init__"] = init


def describe(described: griffe.Object, thing: Any) -> None:
    """Gives a class or function the docstring that it has when it runs, and so for a class's members."""
    text = getattr(thing, "__doc__", None)
    if text and described.docstring is None:
        described.docstring = griffe.Docstring(text, parent=described)
    if isinstance(described, griffe.Class):
        construct(described, thing)
        for name, member in described.members.items():
            if not name.startswith("_"):
                describe(member, getattr(thing, name))


class Docstrings(griffe.Extension):
    """Fills the stubs of `midair._midair` once the package is read and before its names are followed."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Look at every name that the compiled core exports."""
        for name in compiled.__all__:
            # A function with overloads only is no member.
            thing, found = getattr(compiled, name), pkg["_midair"].members.get(name)
            stubs = pkg[found.target_path.split(".")[1]] if found and found.is_alias else pkg["_midair"]
            if name not in stubs.members:
                stubs.set_member(name, signature(name, thing, stubs))
            describe(stubs.members[name], thing)
