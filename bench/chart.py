"""The chart of docs/performance.md from the newest record: docs/peers.png. `make bench-peers` draws it."""

from pathlib import Path

import matplotlib.pyplot as plt

import record

ROOT = Path(__file__).parents[1]
METHODS = ("fast", record.GREEDY, "uniform", "gspat", "naive")
RIVALS = ("midair", "autd3", "autd3-rs")
#: A line style a program, a colour a method.
STYLES = dict(zip(RIVALS, ("-", "--", ":"), strict=True))


def main() -> None:
    """Each program's and method's time over that of the reference, on the boards' grid."""
    newest = max((ROOT / "bench" / "records").glob("20*.csv"))
    rows = [row for row in record.read(newest) if row["N"] == "996" and row["grid"] == "board"]
    times = {
        (row["rival"], row["method"], int(row["M"])): float(row["ns_median"])
        for row in rows
        if row["form"] == ("solve" if row["rival"] == "midair" else "full")
    }
    figure, ax = plt.subplots(figsize=(7, 4.2), layout="constrained")
    for rival in RIVALS:
        for colour, method in enumerate(METHODS):
            own = {
                m: ns for (name, kind, m), ns in times.items() if (name, kind) == (rival, method) and m <= 64
            }
            if own:
                sizes = sorted(own)
                ratios = [times[record.REFERENCE, record.GREEDY, m] / own[m] for m in sizes]
                label = f"{rival}, {method}"
                ax.loglog(sizes, ratios, STYLES[rival], marker="o", ms=3, color=f"C{colour}", label=label)
    ax.set_xticks([1, 4, 8, 16, 64], ["1", "4", "8", "16", "64"])
    ax.set_yticks([1, 3, 10, 30, 100], ["1", "3", "10", "30", "100"])
    ax.minorticks_off()
    ax.set_xlabel("control points M")
    ax.set_ylabel(f"times as fast as {record.REFERENCE}'s greedy")
    ax.grid(alpha=0.3)
    ax.legend(fontsize="small", ncols=1, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(ROOT / "docs" / "peers.png", dpi=90)


if __name__ == "__main__":
    main()
