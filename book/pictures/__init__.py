"""Place, width and colours of the pages' pictures, and tables that are printed row by row."""

import io
from itertools import product
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from PIL import Image

from marked import row, rule

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
INK, TEAL, AMBER, SOFT = "#0c0f14", "#0b7f74", "#b35900", "#6b7686"
COLOURS = {"naive": SOFT, "gspat": "#7a5195", "greedy": AMBER, "uniform": TEAL, "fast": "#2f6fb5"}
#: A page is 360 points wide on a phone, so text of 12 points in a picture of 5.6 inches appears as 11 points.
WIDTH, STYLE = 5.6, {"font.size": 12, "axes.spines.top": False, "axes.spines.right": False}
#: The number of colours and the largest width in pixels of stored pictures, which keep the repository small.
SHADES, PIXELS = 128, 860

#: Half the size of a marker in pixels, the sides on which a name may stand, and its alignment there.
SIZE = 6
SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1), (0.7, 0.7), (-0.7, 0.7), (0.7, -0.7), (-0.7, -0.7))
ENDS = {1: "left", 0.7: "left", 0: "center", -0.7: "right", -1: "right"}


def figure(height: float, rows: int = 1, columns: int = 1) -> tuple[Figure, np.ndarray]:
    """Returns a figure of a page's width, and its axes as a flat array."""
    plt.rcParams.update(STYLE)
    drawn, axes = plt.subplots(rows, columns, figsize=(WIDTH, height), layout="constrained", squeeze=False)
    return drawn, axes.ravel()


def save(drawn: Figure, name: str) -> None:
    """Writes a picture with few colours to docs."""
    content = io.BytesIO()
    drawn.savefig(content, format="png", dpi=130)
    reduce(content, DOCS / f"{name}.png")
    plt.close(drawn)


def reduce(picture: Path | io.BytesIO, target: Path) -> None:
    """Writes a picture with few colours and a page's width."""
    image = Image.open(picture).convert("RGB")
    image.thumbnail((PIXELS, 2 * PIXELS))
    few = image.quantize(SHADES, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(target, "PNG", optimize=True)


def write_names(axes: Axes, names: list[str], points: np.ndarray, colours: list[str], size: float = 8) -> None:
    """Writes each name beside its point (K, 2), where it covers least; the layout must be final."""
    places = axes.transData.transform(points)
    taken = [Bbox.from_extents(*(place - SIZE), *(place + SIZE)) for place in places]
    for name, point, colour in sorted(zip(names, points, colours, strict=True), key=lambda one: -len(one[0])):
        tried = []
        for far, (across, up) in product((7, 11, 16), SIDES):
            text = axes.annotate(name, point, (far * across, far * up), textcoords="offset points")
            text.set(color=colour, fontsize=size, ha=ENDS[across], va="center")
            box = text.get_window_extent()
            outside = not (axes.bbox.contains(*box.min) and axes.bbox.contains(*box.max))
            tried.append((box.count_overlaps(taken) + outside, len(tried), text, box))
        *_, best, box = min(tried, key=lambda each: each[:2])
        taken.append(box)
        for *_, text, _ in tried:
            if text is not best:
                text.remove()


def end(axes: Axes, name: str, place: tuple[float, float], colour: str, up: float = 0) -> None:
    """Writes a name beside the end of its line, `up` points higher than the end."""
    axes.annotate(name, place, (8, up), textcoords="offset points", va="center", color=colour)


def frame(axes: Axes, title: str, **settings: object) -> None:
    """Writes a title above axes with a faint grid; `settings` are those of `Axes.set`."""
    axes.set(**settings)
    axes.set_title(title, fontsize=12, loc="left")
    axes.grid(alpha=0.3)


def head(*names: str) -> None:
    """Prints the first two lines of a Markdown table."""
    print(row(*names) + rule(len(names)), end="")


def line(*cells: object) -> None:
    """Prints a row of a Markdown table."""
    print(row(*cells), end="", flush=True)
