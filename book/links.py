"""Checks the built website: broken links, and files loaded from elsewhere."""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

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


def main() -> None:
    """Prints the faults of the website in the given folder, and exits with 1 if there are any."""
    found = faults(Path(sys.argv[1]))
    print("\n".join(found) or "no broken link, nothing loaded from elsewhere")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
