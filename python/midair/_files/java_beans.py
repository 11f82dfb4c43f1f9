"""java.beans.XMLDecoder: the objects that its XML makes, as trees of properties; nothing of Java is run.

An `object` or `void` element is a call: with `class` it makes an object; with `property` it sets it to its
one argument, without argument it gets it; `method` is what it says. Elements in it that are values are its
arguments; `void` elements act upon its value, which is made when the first of them, or an `idref` to it,
needs it.
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any

from .content import fault
from .table import number
from .xml import Element

NUMBERS = ("byte", "short", "int", "long", "float", "double")


class Bean:
    """An object: the name of its class, its properties and, of a list, its items."""

    __slots__ = ("items", "kind", "line", "properties")

    def __init__(self, kind: str, line: int) -> None:
        self.kind, self.line = kind, line
        self.properties: dict[str, Any] = {}
        self.items: list[Any] = []


class _Field:
    """A public field of a class, which `get` and `set` are called on."""

    __slots__ = ("name",)

    def __init__(self, name: str) -> None:
        self.name = name


class Decoder:
    """Objects of a document, in the order in which they are made."""

    def __init__(self, path: str | PathLike[str], root: Element) -> None:
        self._path = path
        self._named: dict[str, Callable[[], Any]] = {}
        self.beans: list[Bean] = []
        top = Bean("", root.line)
        for element in root.children:
            self._value(element, lambda: top)

    def _value(self, element: Element, outer: Callable[[], Any]) -> Any:
        """The value of an element; `outer` gives that of the one around it."""
        if element.name in NUMBERS:
            found = number(element.text.strip())
            if found is None:
                wrong = f'<{element.name}> is "{element.text.strip()[:40]}": give a finite number'
                raise fault(self._path, element.line, wrong)
            return found
        if element.name not in ("object", "void"):
            for child in element.children:
                self._value(child, lambda: None)
            return element.text
        made: list[Any] = []
        arguments: list[Any] = []

        def own() -> Any:
            if not made:
                # Stands there for as long as the value is being made, for one that needs itself.
                made.append(None)
                made[0] = self._call(element, arguments, outer)
            return made[0]

        if "id" in element.attributes:
            self._named[element.attributes["id"]] = own
        for child in element.children:
            value = self._value(child, own)
            if child.name != "void":
                arguments.append(value)
        return own()

    def _call(self, element: Element, arguments: list[Any], outer: Callable[[], Any]) -> Any:
        told = element.attributes
        if "idref" in told:
            if told["idref"] not in self._named:
                wrong = f'"{told["idref"]}" is used before it is there: get the file again'
                raise fault(self._path, element.line, wrong)
            return self._named[told["idref"]]()
        kind, method, name = told.get("class"), told.get("method"), told.get("property")
        if kind is not None and method is None and name is None:
            bean = Bean(kind, element.line)
            self.beans.append(bean)
            return bean
        if method == "getField" and arguments:
            return _Field(str(arguments[0]))
        around = outer() if kind is None else None
        if isinstance(around, _Field) and arguments and isinstance(arguments[0], Bean):
            owner, name, arguments = arguments[0], around.name, arguments[1:]
        elif isinstance(around, Bean):
            owner = around
        else:
            return Bean("", element.line)
        if name is not None:
            if arguments:
                owner.properties[name] = arguments[0]
                return None
            return owner.properties.setdefault(name, Bean("", element.line))
        if method == "add" and arguments:
            owner.items.append(arguments[-1])
        return Bean("", element.line)
