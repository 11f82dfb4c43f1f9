"""docs/gallery.md: every example, with the picture that it draws (30 s)."""

import os
import runpy
import sys
import tempfile
from pathlib import Path
from typing import Any
from unittest.mock import patch

import matplotlib.pyplot as plt
from PIL import Image

from gallery import EXAMPLES, ORDER, PAGE, cells, page
from pictures import DOCS

#: The largest width of a picture in pixels.
WIDTH = 1000


def run(path: Path) -> dict[str, Any]:
    """Runs a script or notebook in the current folder, where it writes its picture; returns its variables."""
    if path.suffix == ".ipynb":
        names: dict[str, Any] = {}
        exec(compile("\n".join(cells(path, "code")), str(path), "exec"), names)
        return names
    with patch.object(sys, "argv", [str(path)]):
        return runpy.run_path(str(path), run_name="__main__")


def main() -> None:
    """Runs all examples, stores their pictures and writes the page."""
    plt.switch_backend("Agg")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in (name for names in ORDER.values() for name in names):
            run(EXAMPLES / name)
            image = Image.open(f"{Path(name).stem}.png").convert("RGB")
            image.thumbnail((WIDTH, WIDTH))
            image.save(DOCS / "gallery" / f"{Path(name).stem}.webp", quality=80, method=6)
            plt.close("all")
        os.chdir(DOCS)
    PAGE.write_text(page(), encoding="utf-8")
