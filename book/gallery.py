"""The gallery: docs/gallery.md, and the website's page of each example, with its program and notebook."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
PAGE = ROOT / "docs" / "gallery.md"
#: The tutorial that is also a notebook, for Colab and Binder.
LESSON = ROOT / "docs" / "tutorials" / "first-focus.md"

#: Examples by subject.
ORDER = {
    "Fields": ["smiley.py", "letters.py", "picture.py", "weak.py", "pair.py"],
    "Motion, traps, obstacles": ["ring.py", "traps.py", "ear.py", "ball.py"],
    "Measured arrays": ["board.py", "calibrate.py", "microphone.py", "faults.py", "air.ipynb"],
    "Methods": ["methods.ipynb", "acoustools.ipynb", "study.py", "own_solver.py"],
}

INTRODUCTION = """\
# Gallery

Each picture is the output of a short program or notebook in the folder [examples](../examples). In a clone,
`python examples/smiley.py` writes `smiley.png`.

Eight programs use scenes of the studio. [Once built](studio.md),
`midair studio docs/scenes/gallery/smiley.json` opens one.
"""
#: The Markdown of a card: picture, title, first sentence, and a link to the program.
CARD = """\
<div class="card" markdown>

[![{title}](gallery/{stem}.webp)](../examples/{name})

**{title}.** {line}

[{name}](../examples/{name})

</div>
"""


def cells(path: Path, kind: str) -> list[str]:
    """Returns the cells of a notebook of one kind, "code" or "markdown"."""
    found = json.loads(path.read_text("utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in found if cell["cell_type"] == kind]


def reported(path: Path) -> tuple[str, str]:
    """Returns title and description of an example."""
    if path.suffix == ".ipynb":
        title, text = cells(path, "markdown")[0].split("\n", 1)
        return title.removeprefix("# "), text.strip()
    docstring = re.match(r'"""(.*?)"""', path.read_text("utf-8"), re.DOTALL)
    assert docstring, f"{path} has no docstring"
    title, text = docstring[1].split(": ", 1)
    return title, (text[0].upper() + text[1:]).strip()


def page() -> str:
    """Returns the page: a grid of cards for each subject, from the examples' own texts."""

    def parts() -> Iterator[str]:
        yield INTRODUCTION
        for theme, names in ORDER.items():
            yield f'## {theme}\n\n<div class="cards" markdown>\n'
            for name in names:
                title, text = reported(EXAMPLES / name)
                line = text.split("\n\n")[0]
                yield CARD.format(title=title, stem=Path(name).stem, line=line, name=name)
            yield "</div>\n"

    return "\n".join(parts())


def scene(name: str) -> str | None:
    """Returns the studio's scene that an example uses, such as "smiley", None if it uses none."""
    found = re.search(r'SCENES / \\?"(\w+)\.json', (EXAMPLES / name).read_text("utf-8"))
    return found[1] if found else None


def links(name: str, folder: str, studio: bool) -> str:
    """Returns links to an example's files in `folder`, "gallery/" or "", and to its scene in the studio."""
    stem, up = folder + Path(name).stem, "" if folder else "../"
    found = [f'<a href="{stem}.py" download>program</a>'] if name.endswith(".py") else []
    found.append(f'<a href="{stem}.ipynb" download>notebook</a>')
    if studio and (shown := scene(name)):
        found.append(f'<a href="{up}studio/index.html?scene={shown}">try it</a>')
    return " · ".join(found)


def own_page(name: str, studio: bool) -> str:
    """Returns the website's page of an example: text, picture or live cell, downloads and program."""
    title, text = reported(EXAMPLES / name)
    stem = Path(name).stem
    picture = f"![{title}]({stem}.webp)"
    if studio and (shown := scene(name)):
        picture = (
            f'<div class="live" data-scene="../scenes/gallery/{shown}.json" markdown>\n\n{picture}\n\n'
            '<button class="try" type="button">Try it here</button>\n\n</div>'
        )
    if name.endswith(".ipynb"):
        text, code = "", notebook_page(EXAMPLES / name).split("\n", 1)[1]
    else:
        code = f"```python\n{program(name)}\n```\n"
    return f"# {title}\n\n{text}\n\n{picture}\n\n{links(name, '', studio)}\n\n{code}"


def program(name: str) -> str:
    """Returns the program of a script, without its description."""
    source = (EXAMPLES / name).read_text("utf-8")
    return source[source.index('"""', 3) + 3 :].strip()


def notebook_page(path: Path) -> str:
    """Returns a notebook's cells as Markdown."""
    kinds = {"markdown": "{}\n", "code": "```python\n{}\n```\n"}
    found = json.loads(path.read_text("utf-8"))["cells"]
    return "\n".join(kinds[cell["cell_type"]].format("".join(cell["source"])) for cell in found)


def lesson(page: Path) -> str:
    """Returns a tutorial as a notebook, which begins with the installation."""
    made = [("code", "%pip install --quiet midair")]
    for number, part in enumerate(re.split(r"```python\n(.*?)```\n", page.read_text("utf-8"), flags=re.DOTALL)):
        made.append(("code" if number % 2 else "markdown", part.strip()))
    cells = [
        {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": text.splitlines(keepends=True)}
        | ({"outputs": [], "execution_count": None} if kind == "code" else {})
        for number, (kind, text) in enumerate(made)
    ]
    metadata = {
        "kernelspec": {"display_name": "Python 3", "name": "python3"},
        "language_info": {"name": "python"},
    }
    found = {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def notebook(name: str) -> str:
    """Returns an example as a notebook; a script becomes one cell below its description."""
    if name.endswith(".ipynb"):
        return (EXAMPLES / name).read_text("utf-8")
    title, text = reported(EXAMPLES / name)
    code = program(name).replace("Path(__file__).parents[1]", "Path.cwd().parent")
    cell = {"metadata": {}, "outputs": [], "execution_count": None}
    return json.dumps(
        {
            "cells": [
                {"cell_type": "markdown", "id": "about", "metadata": {}, "source": f"# {title}\n\n{text}"},
                {"cell_type": "code", "id": "program", "source": code, **cell},
            ],
            "metadata": {"language_info": {"name": "python"}},
            "nbformat": 4,
            "nbformat_minor": 5,
        }
    )
