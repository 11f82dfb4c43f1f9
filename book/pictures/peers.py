"""docs/performance.md: two charts of the newest record of `make bench-peers` (2 s)."""

import sys

import numpy as np

from pictures import ROOT, end, figure, frame, save, write_names

sys.path.append(str(ROOT / "bench"))
import record

#: The lines of the first chart: program, method, and the upward shift of its name, in points.
LINES = (
    ("midair", "fast", -4),
    ("midair", "uniform", 2),
    ("midair", record.GREEDY, 0),
    ("autd3-rs", "gspat", 0),
    ("autd3", "gspat", 0),
    ("autd3", record.GREEDY, 0),
)
#: The methods of the second chart, by program.
POINTS = {
    "midair": ("fast", "uniform", "best", record.GREEDY, "gspat", "naive", "gs", "wgs", "lm"),
    "autd3": (record.GREEDY, "gspat", "gs", "naive"),
    "autd3-rs": ("gspat", "naive"),
}
COLOURS = {"midair": "#0b7285", "autd3": "#b35900", "autd3-rs": "#8a6d3b"}
STYLES = {"midair": "-", "autd3": "--", "autd3-rs": ":"}
Rows = dict[tuple[str, str, int], record.Row]


def times(rows: Rows) -> None:
    """Draws the time of a solve over the number of points, with the name at the end of each line."""
    drawn, (ax,) = figure(4.6)
    for rival, method, up in LINES:
        sizes = sorted(m for name, kind, m in rows if (name, kind) == (rival, method) and m <= 64)
        took = [float(rows[rival, method, m]["ns_median"]) / 1e3 for m in sizes]
        ax.loglog(sizes, took, STYLES[rival], marker="o", ms=4, color=COLOURS[rival])
        name = f"{rival} {method.removesuffix(' 16 phases')}"
        end(ax, name, (sizes[-1], took[-1]), COLOURS[rival], up)
    ax.set_xticks([1, 4, 8, 16, 64], ["1", "4", "8", "16", "64"])
    ax.set_yticks([10, 100, 1000, 10_000], ["10 µs", "100 µs", "1 ms", "10 ms"])
    ax.minorticks_off()
    frame(ax, "time of one solve, 996 transducers", xlim=(0.9, 420), xlabel="points M")
    save(drawn, "peers")


def evenness(rows: Rows) -> None:
    """Draws the spread of the pressures over the time of a solve, for 16 points."""
    drawn, (ax,) = figure(4.6)
    shown = [(rival, method) for rival, methods in POINTS.items() for method in methods]
    found = [rows[*one, 16] for one in shown]
    points = np.array([(float(row["ns_median"]) / 1e3, float(row["sigma"])) for row in found])
    colours = [COLOURS[rival] for rival, _ in shown]
    names = [f"{method} ({rival})".removesuffix(" (midair)").replace(" 16 phases", "") for rival, method in shown]
    ax.scatter(*points.T, c=colours)
    ax.set_xscale("log")
    ax.set_xticks([30, 100, 300, 1000, 3000], ["30 µs", "100 µs", "300 µs", "1 ms", "3 ms"])
    ax.minorticks_off()
    label = "time of one solve, 16 points (left is better)"
    frame(ax, "unevenness sigma (down is better)", ylim=(-0.01, 0.1), xlim=(20, 7000), xlabel=label)
    drawn.draw_without_rendering()
    write_names(ax, names, points, colours, size=11)
    save(drawn, "peers-even")


def main() -> None:
    """Draws both charts of the rows on the boards' grid."""
    newest = max((ROOT / "bench" / "records").glob("20*.csv"))
    forms = {"midair": "solve", "autd3": "full", "autd3-rs": "full"}
    rows = {
        (row["rival"], row["method"], int(row["M"])): row
        for row in record.read(newest)
        if row["N"] == "996" and row["grid"] == "board" and row["form"] == forms.get(row["rival"])
    }
    times(rows)
    evenness(rows)
