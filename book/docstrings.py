"""Completes the stubs of the compiled core for the reference pages, which show one signature a function."""

from typing import Any

import griffe

from midair import _midair as compiled


class Docstrings(griffe.Extension):
    """Completes the stubs of `midair._midair` after the package is read and before its aliases are
    resolved.
    """

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Handles every function that has overloads, and every class."""
        core = pkg["_midair"]
        complete(core)
        for name, owner in core.members.items():
            if isinstance(owner, griffe.Class):
                complete(owner)
                for key, member in list(owner.members.items()):
                    if isinstance(member, griffe.Attribute) and member.annotation is None:
                        owner.set_member(key, method(key, pkg, core.members[str(member.value)], owner))
                if "__new__" in owner.members:
                    owner.members["__init__"] = owner.members["__new__"]
                    owner.members["__init__"].returns = None
                if owner.docstring:
                    # The package lists the keywords that the core declares.
                    owner.docstring.value = getattr(compiled, name).__doc__


def complete(owner: griffe.Module | griffe.Class) -> None:
    """Replaces overloads by one function that covers them all."""
    for name, overloads in owner.overloads.items():
        if not overloads:
            continue
        first = overloads[0]
        for parameter in first.parameters:
            same = [one.parameters[parameter.name] for one in overloads if parameter.name in one.parameters]
            kinds = list(dict.fromkeys(str(one.annotation) for one in same))
            # A solver's name is any text, with its own options.
            kinds = [kind for kind in kinds if "str" not in kinds or not kind.startswith("Literal")]
            parameter.annotation = "Any" if parameter.name == "options" else " | ".join(kinds)
            parameter.default = next((one.default for one in same if one.default is not None), None)
        first.returns = " | ".join(dict.fromkeys(str(one.returns) for one in overloads))
        owner.set_member(name, first)


def method(
    name: str, pkg: griffe.Module, function: griffe.Object | griffe.Alias, owner: griffe.Class
) -> griffe.Function:
    """Returns a function of the package as a method of a compiled class: its first argument becomes
    `self`.
    """
    home, _, key = function.target_path.removeprefix("midair.").rpartition(".")
    found = (pkg[home] if home else pkg).members[key]
    if found.is_alias:
        return method(name, pkg, found, owner)
    parameters = griffe.Parameters(*list(found.parameters)[1:])
    return griffe.Function(name, parameters=parameters, returns=found.returns, parent=owner, docstring=found.docstring)
