"""Checks the built website: broken links, files loaded from elsewhere, public names without an anchor."""

import dataclasses
import inspect
import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from urllib.parse import unquote, urlsplit

import midair

#: Attributes whose file a page loads as soon as it is opened.
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("video", "src")}
#: Kinds of <link> that load nothing.
UNLOADED = {"canonical", "next", "prev", "alternate"}


class Page(HTMLParser):
    """A page's anchors, its links, and the files that it loads."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = {""}
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collects anchors, links and loaded files of a tag."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        for name in ("href", "src"):
            if name not in given:
                continue
            loads = (tag, name) in LOADED or (tag == "link" and given.get("rel") not in UNLOADED)
            (self.loads if loads else self.links).append(given[name])


def faults(site: Path) -> list[str]:
    """Returns the faults, one line each."""
    pages = {path.resolve(): Page(path) for path in site.resolve().rglob("*.html")}
    found = []
    for path, page in pages.items():
        where = path.relative_to(site.resolve())
        found += [f"{where}: loads {url} from elsewhere" for url in page.loads if urlsplit(url).netloc]
        for url in page.links + page.loads:
            parts = urlsplit(url)
            # 404.html is shown at any address; its links are relative to the website's root.
            if parts.scheme or parts.netloc or path.name == "404.html":
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file():
                found.append(f"{where}: {url} leads nowhere")
            elif target in pages and unquote(parts.fragment) not in pages[target].anchors:
                found.append(f"{where}: {url} has no such anchor")
    for path in site.rglob("*.css"):
        for url in re.findall(r"url\(['\"]?(?:https?:)?//[^)]*", path.read_text("utf-8")):
            found.append(f"{path.relative_to(site)}: loads {url} from elsewhere")
    return found


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


def unnamed(site: Path) -> list[str]:
    """Returns the public names of the package that have no anchor."""
    paths = sorted((site / "reference" / "python").glob("*.html"))
    pages = "".join(path.read_text("utf-8") for path in paths)
    anchors = [f".{anchor}" for anchor in re.findall(r' id="(midair\.[^"]+)"', pages)]
    return sorted({name for name in names() if not any(anchor.endswith(f".{name}") for anchor in anchors)})


def main() -> None:
    """Prints the faults of the website in the given folder, and exits with 1 if there are any."""
    site = Path(sys.argv[1])
    found = [*faults(site), *(f"{name} is not in the reference" for name in unnamed(site))]
    print("\n".join(found) or "no broken link, nothing loaded from elsewhere, every public name is there")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
