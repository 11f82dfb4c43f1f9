"""A study in a dozen lines: the mean uniformity, weakest focus over strongest, by five methods.

The table has a hundred random scenes for each number of points. `midair.sweep` also runs on a cluster.
"""

import matplotlib.pyplot as plt

import midair

COUNTS, METHODS = (2, 4, 8, 16, 32), ("naive", "gspat", "wgs", "greedy", "uniform")

table = midair.sweep(
    {
        "array": {"preset": "paper20"},
        "points": {"count": COUNTS, "x": [-0.08, 0.08], "y": [-0.08, 0.08], "z": 0.15},
        "solver": [{"name": name} for name in METHODS],
        "seeds": 100,
    }
)

figure, ax = plt.subplots(figsize=(7, 4.2), layout="constrained")
for name in METHODS:
    rows = [(table["solver"] == name) & (table["points"] == count) for count in COUNTS]
    ax.plot(COUNTS, [table["uniformity"][row].mean() for row in rows], "o-", label=name)
ax.set_xscale("log")
ax.set_xticks(COUNTS, COUNTS)
ax.minorticks_off()
ax.set(xlabel="points", ylabel="weakest focus over loudest, mean", ylim=(0, 1.03))
ax.legend(title="100 random scenes each")
figure.savefig("study.png")
