"""Hooks of mkdocs: pages from elsewhere join those of docs/, and links find them.

Pages of docs/ link to files of the repository as GitHub shows them, `../CHANGELOG.md`. On the site such a
file is a page under `repository/`, with those that it links to.
"""

from __future__ import annotations

import json
import posixpath
import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File

sys.path.insert(0, str(Path(__file__).parent))

import reference

ROOT = Path(__file__).parents[1]
#: Pages of the navigation that no page of docs/ may happen to link to.
ALWAYS = ("CHANGELOG.md", "CONTRIBUTING.md")
#: The target of a Markdown link to a file: no address of the web, no bare anchor.
TARGET = re.compile(r"(?<=\]\()([^)#:\s]+)")


def home(page: str) -> str:
    """Where in the repository a page of the site comes from."""
    if not page.startswith("repository/"):
        return f"docs/{page}"
    own = page.removeprefix("repository/")
    return own if (ROOT / own).is_file() else own.removesuffix(".md")


def place(path: str) -> str:
    """Where on the site a file or folder of the repository is."""
    if (ROOT / path).is_dir():
        return f"repository/{path}/index.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return f"repository/{path}" + ("" if path.endswith(".md") else ".md")


def outside(target: str, page: str) -> str | None:
    """The file or folder of the repository that a link leads to, if mkdocs does not find it by itself."""
    path = posixpath.normpath(posixpath.join(posixpath.dirname(home(page)), target))
    at_home = not page.startswith("repository/") and path.startswith("docs/") and (ROOT / path).is_file()
    return path if (ROOT / path).exists() and not at_home else None


def shown(path: str) -> str:
    """A file of the repository as Markdown: code in a block, a notebook's cells, a folder's names."""
    if (ROOT / path).is_dir():
        names = sorted(file.name for file in (ROOT / path).iterdir())
        return f"# {path}\n\n" + "".join(f"- [{name}]({name})\n" for name in names)
    if path.endswith(".ipynb"):
        kinds = {"markdown": "{}\n", "code": "```python\n{}\n```\n"}
        cells = json.loads((ROOT / path).read_text())["cells"]
        return "\n".join(kinds[cell["cell_type"]].format("".join(cell["source"])) for cell in cells)
    text = (ROOT / path).read_text()
    return text if path.endswith(".md") else f"# {path}\n\n```{Path(path).suffix[1:]}\n{text}```\n"


def on_files(files: Any, config: Any) -> None:
    """Adds the pages that are written now, and those of the repository that are linked to."""
    for page, text in reference.pages():
        files.append(File.generated(config, page, content=text))
    waiting = [(file.src_uri, file.content_string) for file in files.documentation_pages()]
    waiting.append(("index.md", "".join(f"[]({'../' + path})" for path in ALWAYS)))
    while waiting:
        page, text = waiting.pop()
        for path in filter(None, (outside(target, page) for target in TARGET.findall(text))):
            if not files.get_file_from_path(place(path)):
                waiting.append((place(path), shown(path)))
                files.append(File.generated(config, place(path), content=shown(path)))


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Links as they are on the site. A search finds the pages of docs/ before files of the repository."""
    here = page.file.src_uri
    if here.startswith("repository/"):
        page.meta["search"] = {"boost": 0.2}

    def moved(link: re.Match[str]) -> str:
        path = outside(link[1], here)
        return posixpath.relpath(place(path), posixpath.dirname(here)) if path else link[1]

    return TARGET.sub(moved, markdown)


def on_page_context(context: dict[str, Any], page: Any, config: Any, **_: Any) -> dict[str, Any]:
    """Chooses the language of the theme's own words, page by page."""
    config.theme["language"] = "ja" if page.url.startswith("ja/") else "en"
    return context


def on_post_page(output: str, **_: Any) -> str:
    """Names the search, to which the theme gives no name."""
    search = 'data-md-component="search" role="dialog"'
    return output.replace(search, f'{search} aria-label="Search"')
