"""Hooks of mkdocs: add pages from outside of docs/, and correct the links to them.

Pages in docs/ link to files of the repository as on GitHub, `../CHANGELOG.md`. On the website such a file
is a page in `repository/`, and so are the files that it links to.
"""

import posixpath
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File

sys.path.insert(0, str(Path(__file__).parent))

from latex2mathml.converter import convert
from PIL import Image

import gallery
import reference

ROOT = Path(__file__).parents[1]
#: The studio that `make studio` builds; without it the book has pictures instead of live cells.
STUDIO = ROOT / "studio" / "built"
EXAMPLES = {f"examples/{name}": name for names in gallery.ORDER.values() for name in names}
#: A card's link to its program; the website replaces it by several links.
PROGRAM = re.compile(r"^\[(\w+\.\w+)\]\(\.\./examples/\1\)$", re.MULTILINE)
#: A paragraph with only a picture, and the largest width in pixels of pictures that a phone shows whole.
PICTURE = re.compile(r'<p>(<img [^>]*src="([^"]+)"[^>]*>)</p>')
NARROW = 800
#: Formulas as GitHub writes them: in a line, and in a block.
FORMULA = re.compile(r"\$`([^`\n]+)`\$|^```math\n(.*?)\n```$", re.MULTILINE | re.DOTALL)
#: Pages of the navigation, even if no page in docs/ links to them.
ALWAYS = ("CHANGELOG.md", "CONTRIBUTING.md")
#: Long pages of names and records, which every page would load for its search.
UNSEARCHED = ("map.md", "repository/CHANGELOG.md")
#: The target of a Markdown link to a file, not to a web address or an anchor.
TARGET = re.compile(r"(?<=\]\()([^)#:\s]+)")


def home(page: str) -> str:
    """Returns the path in the repository of a page of the website."""
    own = next((path for path in EXAMPLES if place(path) == page), None)
    if own or not page.startswith("repository/"):
        return own or f"docs/{page}"
    own = page.removeprefix("repository/")
    return own if (ROOT / own).is_file() else own.removesuffix(".md")


def place(path: str) -> str:
    """Returns the path on the website of a file or folder of the repository."""
    if (ROOT / path).is_dir():
        return f"repository/{path}/index.md"
    if path in EXAMPLES:
        return f"gallery/{Path(path).stem}.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return f"repository/{path}" + ("" if path.endswith(".md") else ".md")


def outside(target: str, page: str) -> str | None:
    """Returns the file or folder of the repository that a link leads to,
    None if mkdocs resolves it by itself.
    """
    path = posixpath.normpath(posixpath.join(posixpath.dirname(home(page)), target))
    of_docs = not page.startswith("repository/") and home(page).startswith("docs/")
    at_home = of_docs and path.startswith("docs/") and (ROOT / path).is_file()
    return path if (ROOT / path).exists() and not at_home else None


def shown(path: str) -> str:
    """Returns a file of the repository as Markdown: code in a block, a notebook's cells, a folder's names."""
    if (ROOT / path).is_dir():
        names = sorted(file.name for file in (ROOT / path).iterdir())
        return f"# {path}\n\n" + "".join(f"- [{name}]({name})\n" for name in names)
    if path in EXAMPLES:
        return gallery.own_page(EXAMPLES[path], STUDIO.is_dir())
    text = (ROOT / path).read_text("utf-8")
    return text if path.endswith(".md") else f"# {path}\n\n```{Path(path).suffix[1:]}\n{text}```\n"


def on_config(config: Any) -> None:
    """Removes the script of live cells if the studio is not built."""
    if not STUDIO.is_dir():
        config.extra_javascript = [each for each in config.extra_javascript if "live" not in str(each)]


def assets() -> Iterator[tuple[str, Path | str]]:
    """Yields files that are in no source folder:
    their path on the website, and their source path or content.
    """
    for path, name in EXAMPLES.items():
        stem = f"gallery/{Path(name).stem}"
        yield f"{stem}.ipynb", gallery.notebook(name)
        if name.endswith(".py"):
            yield f"{stem}.py", ROOT / path
    if STUDIO.is_dir():
        yield "studio/widget.mjs", STUDIO / "widget.mjs"
        for path in (STUDIO / "site").rglob("*"):
            if path.is_file():
                yield f"studio/{path.relative_to(STUDIO / 'site').as_posix()}", path
        for path in (ROOT / "docs" / "scenes" / "gallery").iterdir():
            yield f"studio/scenes/{path.name}", path


def on_files(files: Any, config: Any) -> None:
    """Adds the generated pages, and the files of the repository that pages link to."""
    for place_, found in assets():
        given = {"abs_src_path": str(found)} if isinstance(found, Path) else {"content": found}
        files.append(File.generated(config, place_, **given))
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


def formula(found: re.Match[str]) -> str:
    """Returns a formula as MathML, which browsers draw without a script."""
    line, block = found.groups()
    if line:
        return convert(line)
    drawn = convert(" ".join(block.split()), display="block")
    return f'\n<div class="formula" role="region" aria-label="Formula" tabindex="0">{drawn}</div>\n'


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Converts links to those of the website. Adds words so that a search finds pages of docs/ first."""
    here = page.file.src_uri
    markdown = FORMULA.sub(formula, markdown)
    if here == "gallery.md":
        markdown = PROGRAM.sub(lambda found: gallery.links(found[1], "gallery/", STUDIO.is_dir()), markdown)
    if here.startswith("repository/"):
        page.meta["search"] = {"boost": 0.2}
    if here in UNSEARCHED or here.startswith("repository/bench/"):
        page.meta["search"] = {"exclude": True}

    def moved(link: re.Match[str]) -> str:
        path = outside(link[1], here)
        return posixpath.relpath(place(path), posixpath.dirname(here)) if path else link[1]

    return TARGET.sub(moved, markdown)


def on_page_context(context: dict[str, Any], page: Any, config: Any, **_: Any) -> dict[str, Any]:
    """Sets the language of the theme's own words, page by page."""
    config.theme["language"] = "ja" if page.url.startswith("ja/") else "en"
    return context


def scrolled(found: re.Match[str], page: str) -> str:
    """Puts a wide picture into a box that a phone can scroll, so that its text stays readable."""
    path = ROOT / "docs" / posixpath.normpath(posixpath.join(posixpath.dirname(page), found[2]))
    if not path.is_file() or path.suffix == ".svg" or Image.open(path).width <= NARROW:
        return found[0]
    return f'<div class="wide" role="region" aria-label="Picture" tabindex="0">{found[1]}</div>'


def on_post_page(output: str, page: Any, **_: Any) -> str:
    """Gives the search an accessible name, which the theme lacks, and makes wide pictures scroll."""
    output = PICTURE.sub(lambda found: scrolled(found, page.url), output)
    search = 'data-md-component="search" role="dialog"'
    return output.replace(search, f'{search} aria-label="Search"')
