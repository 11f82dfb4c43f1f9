"""docs/boards.md, embedded.md, sweeps.md, why.md: pictures readable on a phone; the card of links (20 s)."""

import re

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import midair
from pictures import COLOURS, DOCS, INK, ROOT, TEAL, end, figure, frame, save


def boards() -> None:
    """Draws arrays of boards at the same scale, each transducer as a disc."""
    names = {
        "autd3": "AUTD3, 249",
        "sonicsurface": "SonicSurface, 256",
        "openmpd_board": "OpenMPD, 256",
        "ultraino_flat8x8": "Ultraino 8 x 8, 64",
        "tinylev": "TinyLev, 72",
        "stratos": "STRATOS, 256 (model only)",
    }
    drawn, axes = figure(8.2, 3, 2)
    for ax, (name, title) in zip(axes, names.items(), strict=True):
        places = 1e3 * midair.Array.preset(name).positions
        across, up = (0, 2) if name == "tinylev" else (0, 1)
        middle = (places.min(axis=0) + places.max(axis=0)) / 2
        ax.scatter(places[:, across] - middle[across], places[:, up] - middle[up], s=11, color=TEAL)
        ax.set(xlim=(-110, 110), ylim=(-100, 100), aspect="equal", xticks=[], yticks=[])
        ax.set_title(title + (", from the side" if name == "tinylev" else ""), fontsize=11)
        ax.spines[:].set_visible(False)
    axes[0].plot([-100, 0], [-93, -93], color=INK, lw=2)
    axes[0].annotate("100 mm", (-50, -91), ha="center", va="bottom", fontsize=10)
    save(drawn, "boards")


def embedded() -> None:
    """Draws the number of instructions per frame over the number of points, from docs/embedded.md."""
    rows = re.findall(r"^\| `(\w+)` \|(.*)\|$", (DOCS / "embedded.md").read_text("utf-8"), re.MULTILINE)
    cells = [(name, [float(cell.replace(",", "")) for cell in row.split("|")]) for name, row in rows if "." in row]
    drawn, (ax,) = figure(4.2)
    for method in ("uniform", "greedy", "naive", "fast"):
        own = [row for name, row in cells if name == method and row[1] == 256]
        points, counts = [int(row[2]) for row in own], [sum(row[6:9]) / 1e3 for row in own]
        ax.plot(points, counts, "o-", color=COLOURS[method])
        end(ax, method, (points[-1], counts[-1]), COLOURS[method])
    title = "million instructions of a frame, 256 transducers"
    frame(ax, title, xlabel="points M", xticks=[1, 4, 8], xlim=(0.5, 9.6), ylim=(0, None))
    save(drawn, "embedded")


def sweeps() -> None:
    """Draws uniformity over the number of points M, by four methods, with 95 % intervals.
    The data are 1600 problems of the first sweep in docs/sweeps.md.
    """
    methods = ["naive", "gspat", "greedy", "uniform"]
    table = midair.sweep(
        {
            "array": {"preset": "autd3"},
            "points": {"count": [2, 4, 8, 16], "x": [-0.08, 0.08], "y": [-0.06, 0.06], "z": 0.15},
            "solver": [{"name": name} for name in methods],
            "seeds": 100,
        }
    )
    drawn, (ax,) = figure(4.2)
    for name in methods:
        found = [table["uniformity"][(table["solver"] == name) & (table["points"] == m)] for m in (2, 4, 8, 16)]
        means = np.array([each.mean() for each in found])
        half = np.array([1.96 * each.std(ddof=1) / np.sqrt(len(each)) for each in found])
        ax.errorbar(range(4), means, half, marker="o", capsize=4, color=COLOURS[name])
        end(ax, name, (3, means[-1]), COLOURS[name], {"gspat": 7, "greedy": -7}.get(name, 0))
    ax.set_xticks(range(4), ["2", "4", "8", "16"])
    title = "uniformity: weakest over strongest point"
    frame(ax, title, xlabel="points M", xlim=(-0.3, 3.9), ylim=(0, 1.05))
    save(drawn, "sweeps")


def why() -> None:
    """Draws two plots: the level of two foci over the phase between them, and |p| at eight points
    by three methods.
    """
    pair = midair.Scene(midair.Array.grid(16, 16, 10e-3), [[-0.006, 0, 0.15], [0.006, 0, 0.15]])
    G = pair.propagation()
    turns = np.linspace(0, 1, 181)
    drives = G[0].conj() + np.exp(2j * np.pi * turns)[:, None] * G[1].conj()
    levels = np.abs((drives / np.abs(drives)) @ G.T).min(axis=1)
    rng = np.random.default_rng(3)
    places = np.c_[rng.uniform(-0.05, 0.05, (8, 2)), np.full(8, 0.15)]
    scene = midair.Scene(midair.Array.preset("paper20"), places)
    drawn, (above, below) = figure(6.6, 2)
    above.plot(360 * turns, levels / 1e3, color=TEAL, lw=2.5)
    above.set(xlabel="phase between the two foci / degrees", xticks=[0, 90, 180, 270, 360], ylim=(0, None))
    above.set_title("two foci 12 mm apart: the weaker one, kPa", fontsize=12, loc="left")
    bars(below, scene)
    save(drawn, "why")


def bars(ax: Axes, scene: midair.Scene) -> None:
    """Draws |p| at each point relative to the balanced level, by three methods."""
    level = scene.reach().level
    for k, name in enumerate(("naive", "greedy", "uniform")):
        solution = midair.solve(scene, name)
        heights = np.sort(np.abs(solution.pressures) / level)
        ax.bar(np.arange(8) + 0.27 * (k - 1), heights, 0.25, color=COLOURS[name], label=name)
    ax.set(xlabel="points, weakest first", xticks=[], ylim=(0, 1.45))
    ax.set_title("eight points: |p| over the balanced level", fontsize=12, loc="left")
    ax.legend(frameon=False, ncols=3, loc="upper left", handlelength=1, columnspacing=1)


def card() -> None:
    """Draws the picture that other programs show for a link:
    the name, one sentence, and the field of a smiley.
    """
    scene = midair.Scene.load(DOCS / "scenes" / "gallery" / "smiley.json")
    solution = midair.solve(scene, "uniform")
    points = scene.points
    center = tuple(points[:, :2].mean(axis=0))
    plane = midair.Plane(z=float(points[0, 2]), size=0.2, pixels=420, center=center)
    field = np.abs(midair.field(scene, solution, plane).pressure)
    drawn = plt.figure(figsize=(12, 6.3), facecolor=INK)
    picture = drawn.add_axes((0.475, 0, 0.525, 1))
    picture.imshow(field, cmap="magma", origin="lower", vmax=np.quantile(field, 0.999), interpolation="bicubic")
    picture.set_axis_off()
    drawn.text(0.05, 0.56, "midair", color="white", fontsize=64, weight="bold", va="bottom")
    lines = "Ultrasound phased arrays:\nthe pressure at given points\nis what you request."
    drawn.text(0.052, 0.51, lines, color="#b6c0ce", fontsize=23, va="top", linespacing=1.5)
    drawn.text(0.052, 0.1, "Rust · Python · C · JavaScript", color="#5ad1c4", fontsize=20)
    drawn.savefig(ROOT / "book" / "theme" / "assets" / "card.jpg", dpi=100, pil_kwargs={"quality": 88})
    plt.close(drawn)


def main() -> None:
    """Draws all pictures."""
    for draw in (boards, embedded, sweeps, why, card):
        draw()
