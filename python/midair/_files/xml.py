"""XML as a tree (expat), with limits on depth and number of elements; document types are rejected."""

from collections.abc import Callable
from os import PathLike
from typing import Any, NamedTuple
from xml.parsers import expat

from .._midair import SceneError
from .._support.text import fault, number

#: Limits; the largest known file has 10^5 elements, 14 levels deep.
MOST_ELEMENTS = 1_000_000
MOST_DEPTH = 100


class Element:
    """An element: its name, attributes, child elements and text, and the line where it begins."""

    __slots__ = ("attributes", "children", "line", "name", "text")

    def __init__(self, name: str, attributes: dict[str, str], line: int) -> None:
        self.name, self.attributes, self.line = name, attributes, line
        self.children: list[Element] = []
        self.text = ""


def parse(path: str | PathLike[str], content: bytes) -> Element:
    """Return the root element of a document."""
    parser = expat.ParserCreate()
    parser.buffer_text = True
    top = Element("", {}, 0)
    open_: list[Element] = [top]
    count = 0

    def refused(words: str, cure: str) -> SceneError:
        return fault(path, parser.CurrentLineNumber, words, cure)

    def begin(name: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MOST_ELEMENTS:
            raise refused(f"more than {MOST_ELEMENTS} elements", "give a file of an array")
        if len(open_) > MOST_DEPTH:
            raise refused(f"elements more than {MOST_DEPTH} deep", "give a file of an array")
        element = Element(name, attributes, parser.CurrentLineNumber)
        open_[-1].children.append(element)
        open_.append(element)

    def end(_: str) -> None:
        open_.pop()

    def words(found: str) -> None:
        open_[-1].text += found

    def declared(*_: object) -> None:
        raise refused("a document type is declared", "take <!DOCTYPE ...> out")

    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    parser.CharacterDataHandler = words
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise fault(path, error.lineno, f"it is no XML ({reason})", "get the file again") from error
    except (LookupError, ValueError) as error:
        # Python does not know the encoding.
        if isinstance(error, SceneError):
            raise
        raise fault(path, None, "its encoding is unknown", "give UTF-8") from error
    return top.children[0]


NUMBERS = ("byte", "short", "int", "long", "float", "double")

#: Java's number classes. An element of such a class has a number that other elements may refer to.
BOXES = tuple(f"java.lang.{name}" for name in ("Byte", "Short", "Integer", "Long", "Float", "Double"))


class Bean:
    """A Java object: the name of its class, its properties and, for a list, its items."""

    __slots__ = ("items", "kind", "line", "properties")

    def __init__(self, kind: str, line: int) -> None:
        self.kind, self.line = kind, line
        self.properties: dict[str, Any] = {}
        self.items: list[Any] = []


class _Field(NamedTuple):
    """A public field of a Java class, with its `get` and `set`."""

    name: str


class Decoder:
    """Decodes the Java objects of a document; `beans` has them in the order of their creation."""

    def __init__(self, path: str | PathLike[str], root: Element) -> None:
        self._path = path
        self._named: dict[str, Callable[[], Any]] = {}
        self.beans: list[Bean] = []
        top = Bean("", root.line)
        for element in root.children:
            self._value(element, lambda: top)

    def _value(self, element: Element, outer: Callable[[], Any]) -> Any:
        """Return the value of an element; `outer` returns the value of the element around it."""
        if element.name in NUMBERS:
            found = number(element.text.strip())
            if found is None:
                wrong = f'<{element.name}> is "{element.text.strip()[:40]}"'
                raise fault(self._path, element.line, wrong, "give a finite number")
            if "id" in element.attributes:
                self._named[element.attributes["id"]] = lambda: found
            return found
        if element.name not in ("object", "void"):
            for child in element.children:
                self._value(child, lambda: None)
            return element.text
        made: list[Any] = []
        arguments: list[Any] = []

        def own() -> Any:
            if not made:
                # A placeholder, for an element inside that refers to this value while it is still being made.
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
        reported = element.attributes
        if "idref" in reported:
            if reported["idref"] not in self._named:
                wrong = f'"{reported["idref"]}" is used before it is there'
                raise fault(self._path, element.line, wrong, "get the file again")
            return self._named[reported["idref"]]()
        kind, method, name = reported.get("class"), reported.get("method"), reported.get("property")
        if kind in BOXES and len(arguments) == 1:
            value = arguments[0]
            return number(value.strip()) if isinstance(value, str) else value
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
