"""The gallery, `make gallery`: runs the examples, stores their pictures and writes docs/gallery.md."""

from __future__ import annotations

import json
import os
import re
import runpy
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import patch

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
PAGE = ROOT / "docs" / "gallery.md"
PICTURES = ROOT / "docs" / "gallery"

#: Examples by subject.
ORDER = {
    "Fields": ["smiley.py", "letters.py", "picture.py", "weak.py", "pair.py"],
    "Motion, traps, obstacles": ["ring.py", "traps.py", "ear.py", "ball.py"],
    "Measured arrays": ["board.py", "calibrate.py", "microphone.py", "faults.py", "air.ipynb"],
    "Methods": ["methods.ipynb", "study.py", "own_solver.py"],
}

INTRODUCTION = """\
# Gallery

These short programs are in the folder [examples](../examples), each with its picture. The tests run all of
them. Eight begin with a scene of the [studio's](studio.md) gallery;
`midair studio docs/scenes/gallery/smiley.json` opens one.
"""
#: Pixels across, at most.
WIDTH = 1000


def cells(path: Path, kind: str) -> list[str]:
    """The cells of a notebook that are "code" or "markdown"."""
    found = json.loads(path.read_text())["cells"]
    return ["".join(cell["source"]) for cell in found if cell["cell_type"] == kind]


def run(path: Path) -> dict[str, Any]:
    """Run a script or a notebook in the current folder, where it writes its picture; return its names."""
    if path.suffix == ".ipynb":
        names: dict[str, Any] = {}
        exec(compile("\n".join(cells(path, "code")), str(path), "exec"), names)
        return names
    with patch.object(sys, "argv", [str(path)]):
        return runpy.run_path(str(path), run_name="__main__")


def reported(path: Path) -> tuple[str, str]:
    """Title and description of an example."""
    if path.suffix == ".ipynb":
        title, text = cells(path, "markdown")[0].split("\n", 1)
        return title.removeprefix("# "), text.strip()
    docstring = re.match(r'"""(.*?)"""', path.read_text(), re.DOTALL)
    assert docstring, f"{path} has no docstring"
    title, text = docstring[1].split(": ", 1)
    return title, (text[0].upper() + text[1:]).strip()


def page() -> str:
    """The page, of what the examples say of themselves."""

    def parts() -> Iterator[str]:
        yield INTRODUCTION
        for theme, names in ORDER.items():
            yield f"## {theme}\n"
            for name in names:
                title, text = reported(EXAMPLES / name)
                picture = f"![{title}](gallery/{Path(name).stem}.webp)"
                yield f"### {title}\n\n{text}\n\n{picture}\n\n[{name}](../examples/{name})\n"

    return "\n".join(parts())


def keep(picture: Path) -> None:
    """A picture as a small file of docs/gallery."""
    from PIL import Image

    image = Image.open(picture).convert("RGB")
    image.thumbnail((WIDTH, WIDTH))
    image.save(PICTURES / f"{picture.stem}.webp", quality=80, method=6)


def main() -> None:
    """Run all, keep their pictures, write the page."""
    import matplotlib.pyplot as plt

    plt.switch_backend("Agg")
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in (name for names in ORDER.values() for name in names):
            run(EXAMPLES / name)
            keep(Path(folder) / f"{Path(name).stem}.png")
            plt.close("all")
    PAGE.write_text(page())


if __name__ == "__main__":
    main()
