"""Checks that the built website has an anchor for every public name of the package; reports missing names."""

import dataclasses
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import midair


def members(owner: type) -> Iterator[str]:
    """Yields a class's public attributes and methods, own and inherited, without its fields,
    which the class's docstring describes.
    """
    fields = {field.name for field in dataclasses.fields(owner)} if dataclasses.is_dataclass(owner) else set()
    fields |= set(getattr(owner, "_fields", ()))
    _, _, attributes = (inspect.getdoc(owner) or "").partition("\nAttributes\n---")
    fields |= {
        name
        for names in re.findall(r"^(\w[\w, ]*) : ", attributes, re.MULTILINE)
        for name in names.split(", ")
    }
    for base in owner.__mro__:
        if base.__module__.startswith("midair"):
            own = (name for name in vars(base) if not name.startswith("_") and name not in fields)
            yield from (f"{owner.__name__}.{name}" for name in own)


def names() -> Iterator[str]:
    """Yields all public names, each as the end of its anchor on the website."""
    for name in midair.__all__:
        thing = getattr(midair, name)
        inner = [getattr(thing, one) for one in thing.__all__] if isinstance(thing, ModuleType) else [thing]
        yield name
        if isinstance(thing, ModuleType):
            yield from (f"{name}.{one}" for one in thing.__all__)
        for one in inner:
            if isinstance(one, type):
                yield from members(one)


def faults(site: Path) -> list[str]:
    """Returns the names without an anchor."""
    pages = "".join(
        path.read_text("utf-8") for path in sorted((site / "reference" / "python").glob("*.html"))
    )
    anchors = [f".{anchor}" for anchor in re.findall(r' id="(midair\.[^"]+)"', pages)]
    return sorted({name for name in names() if not any(anchor.endswith(f".{name}") for anchor in anchors)})


def main() -> None:
    """Prints the names that the website in the given folder lacks, and exits with 1 if there are any."""
    found = faults(Path(sys.argv[1]))
    print("\n".join(f"{name} is not in the reference" for name in found) or "every public name is there")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
