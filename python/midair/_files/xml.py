"""XML as a tree, by expat: no document type, no entities of its own, bounds on depth and elements."""

from __future__ import annotations

from os import PathLike
from xml.parsers import expat

from .._midair import SceneError
from .content import fault

#: The largest file known has 10^5 elements, 14 deep.
MOST_ELEMENTS = 1_000_000
MOST_DEPTH = 100


class Element:
    """An element: name, attributes, elements in it, text, and the line where it begins."""

    __slots__ = ("attributes", "children", "line", "name", "text")

    def __init__(self, name: str, attributes: dict[str, str], line: int) -> None:
        self.name, self.attributes, self.line = name, attributes, line
        self.children: list[Element] = []
        self.text = ""


def parse(path: str | PathLike[str], content: bytes) -> Element:
    """The root of a document."""
    parser = expat.ParserCreate()
    parser.buffer_text = True
    top = Element("", {}, 0)
    open_: list[Element] = [top]
    count = 0

    def refused(reason: str) -> SceneError:
        return fault(path, parser.CurrentLineNumber, reason)

    def begin(name: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MOST_ELEMENTS:
            raise refused(f"more than {MOST_ELEMENTS} elements: give a file of an array")
        if len(open_) > MOST_DEPTH:
            raise refused(f"elements more than {MOST_DEPTH} deep: give a file of an array")
        element = Element(name, attributes, parser.CurrentLineNumber)
        open_[-1].children.append(element)
        open_.append(element)

    def end(_: str) -> None:
        open_.pop()

    def words(found: str) -> None:
        open_[-1].text += found

    def declared(*_: object) -> None:
        raise refused("a document type is declared: take <!DOCTYPE ...> out")

    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    parser.CharacterDataHandler = words
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise fault(path, error.lineno, f"it is no XML ({reason}): get the file again") from error
    except (LookupError, ValueError) as error:
        # An encoding that Python has not.
        if isinstance(error, SceneError):
            raise
        raise fault(path, None, "its encoding is unknown: give UTF-8") from error
    return top.children[0]
