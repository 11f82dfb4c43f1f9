"""Draws the charts of docs/performance.md from the newest record: docs/peers.png, docs/peers-even.png."""

from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

import record

ROOT = Path(__file__).parents[1]
#: The lines of the first chart: program, method, and the upward shift of its name, in points.
LINES = (
    ("midair", "fast", -4), ("midair", "uniform", 2), ("midair", record.GREEDY, 0), ("autd3-rs", "gspat", 0),
    ("autd3", "gspat", 0), ("autd3", record.GREEDY, 0),
)  # fmt: skip
#: The points of the second chart, with the offsets of their names, in points.
POINTS = {
    ("midair", "fast"): (8, -12), ("midair", "uniform"): (-14, 10), ("midair", "best"): (0, 10),
    ("midair", record.GREEDY): (9, -3), ("midair", "gspat"): (-20, -17), ("midair", "naive"): (-10, 9),
    ("midair", "gs"): (-4, 9), ("midair", "wgs"): (-16, 10), ("midair", "lm"): (-16, 10),
    ("autd3", record.GREEDY): (-34, -18), ("autd3", "gspat"): (6, 6), ("autd3", "gs"): (-30, 10),
    ("autd3", "naive"): (8, -1), ("autd3-rs", "gspat"): (-30, -18), ("autd3-rs", "naive"): (-44, -18),
}  # fmt: skip
COLOURS = {"midair": "#0b7285", "autd3": "#b35900", "autd3-rs": "#8a6d3b"}
STYLES = {"midair": "-", "autd3": "--", "autd3-rs": ":"}
#: Width and height in inches, and a font size in points that is readable on a page 390 pixels wide.
SIZE, LETTERS = (5.6, 4.6), 12


def found() -> dict[tuple[str, str, int], record.Row]:
    """Returns the newest record's rows on the boards' grid, by program, method and M."""
    newest = max((ROOT / "bench" / "records").glob("20*.csv"))
    return {
        (row["rival"], row["method"], int(row["M"])): row
        for row in record.read(newest)
        if row["N"] == "996" and row["grid"] == "board"
        if row["form"] == ("solve" if row["rival"] == "midair" else "full")
    }


def axes() -> Axes:
    """Returns empty axes of the page's width."""
    plt.rcParams.update({"font.size": LETTERS})
    ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
    ax.grid(alpha=0.3)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def times(rows: dict[tuple[str, str, int], record.Row]) -> None:
    """Draws the time of a solve over the number of points, with the name at the end of each line."""
    ax = axes()
    for rival, method, up in LINES:
        sizes = sorted(m for name, kind, m in rows if (name, kind) == (rival, method) and m <= 64)
        took = [float(rows[rival, method, m]["ns_median"]) / 1e3 for m in sizes]
        ax.loglog(sizes, took, STYLES[rival], marker="o", ms=4, color=COLOURS[rival])
        name = f"{rival} {method.removesuffix(' 16 phases')}"
        place = {"xytext": (7, up), "textcoords": "offset points", "va": "center", "color": COLOURS[rival]}
        ax.annotate(name, (sizes[-1], took[-1]), **place)
    ax.set_xticks([1, 4, 8, 16, 64], ["1", "4", "8", "16", "64"])
    ax.set_yticks([10, 100, 1000, 10_000], ["10 µs", "100 µs", "1 ms", "10 ms"])
    ax.minorticks_off()
    ax.set_xlim(0.9, 420)
    ax.set_xlabel("points M")
    ax.set_title("time of one solve, 996 transducers", fontsize=LETTERS, loc="left")
    ax.figure.savefig(ROOT / "docs" / "peers.png", dpi=130)


def evenness(rows: dict[tuple[str, str, int], record.Row]) -> None:
    """Draws the spread of the pressures over the time of a solve, for 16 points."""
    ax = axes()
    for (rival, method), offset in POINTS.items():
        row = rows[rival, method, 16]
        place = float(row["ns_median"]) / 1e3, float(row["sigma"])
        ax.semilogx(*place, "o", color=COLOURS[rival])
        name = f"{method.removesuffix(' 16 phases')}" + ("" if rival == "midair" else f" ({rival})")
        ax.annotate(
            name, place, xytext=offset, textcoords="offset points", color=COLOURS[rival], fontsize=LETTERS - 1
        )
    ax.set_xticks([30, 100, 300, 1000, 3000], ["30 µs", "100 µs", "300 µs", "1 ms", "3 ms"])
    ax.minorticks_off()
    ax.set_ylim(-0.01, 0.1)
    ax.set_xlim(20, 7000)
    ax.set_xlabel("time of one solve, 16 points (left is better)")
    ax.set_title("unevenness sigma (down is better)", fontsize=LETTERS, loc="left")
    ax.figure.savefig(ROOT / "docs" / "peers-even.png", dpi=130)


if __name__ == "__main__":
    times(found())
    evenness(found())
