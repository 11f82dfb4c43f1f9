"""Writes docs/paper.md from the tables of `midair reproduce`, for `make paper`.

python book/paper.py OUT DOCS
"""

from __future__ import annotations

import io
import shutil
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from textwrap import fill

from PIL import Image

from midair._reproduce import FIGURES, fig2, fig5, tables, timing
from midair._reproduce.tables import Outcome
from midair._support import output

#: The number of colours and the width in pixels of the page's pictures: small, to keep the repository small.
COLOURS = 128
WIDTH = 860

HEAD = """# The paper and its figures

midair grew from one paper: S. Suzuki, M. Fujiwara, Y. Makino, H. Shinoda, "Radiation Pressure Field
Reconstruction for Ultrasound Midair Haptics by Greedy Algorithm With Brute-Force Search", IEEE Transactions
on Haptics 14(4), 914-921, 2021 ([doi:10.1109/TOH.2021.3076489](https://doi.org/10.1109/TOH.2021.3076489)).
This page is for readers of that paper. It repeats the experiments with midair and compares {count} statements
of the paper with the new numbers: {outcomes}.

- **The task.** An array has to make a given sound pressure at several points at once. The paper's greedy
  search sets one transducer after the other. For each it tries K amplitudes and L phases and keeps the best.
- **Symbols.** N is the number of transducers, M the number of points, q the drive of a transducer (a complex
  number) and p a sound pressure. P0 is the pressure of a transducer at full drive times the distance, in
  Pa m. Equations (eq.), algorithms (alg.) and figures have the paper's numbers.
- **Accuracy** is the sum of the pressures over the sum of the requested pressures, the targets. At 100 % the
  two sums are equal.
- **Variation**, sigma, is the spread of the pressures between the points. 0 is best.
- **Uniformity** is the smallest pressure over the largest, each relative to its target. 1 is best.
- **The methods** are explained in [how to choose](how-to-choose.md#one-paragraph-each). They have the
  settings of the authors' public code, without balancing (which raises weak targets before the search).
  LM is Levenberg-Marquardt, EVD uses an eigenvector, and SDP+BCD is semidefinite relaxation solved by block
  coordinate descent. GS is Gerchberg-Saxton, and GS-PAT its variant on an M x M matrix. `uniform` and `best`
  are methods of midair.
- **Raw moduli** in the label of SDP+BCD: the method multiplies each target by an entry of an eigenvector. It
  keeps the moduli of these entries, and a point whose modulus is small is lost. midair's `sdp` can also set
  all moduli to 1, which this page does not show.
- **Variants of greedy.** The label "l1" means absolute instead of squared errors. This variant evaluates
  every candidate in full, and is also the row "plain brute force". The other rows of greedy evaluate in full
  only the candidates that an approximation leaves.
- **Full drive.** Some methods return amplitudes above 1, which no transducer can play. One of three rules
  limits them: reduce amplitudes above 1 to 1 (clamp), divide all by the largest (normalize), or set all to
  1 (|q| = 1). Each legend names the rule, because in fig. 3 the rule matters more than the method.
- **Random points** are the same for every method. A ± value is half of an interval that contains the mean
  with 95 % probability. After a slope, ± is the standard error of the fitted slope.
- **Statements.** Each section compares statements of the paper with the new numbers. They compare only the
  paper's five methods: greedy with K = 1 and L = 16, LM, EVD, SDP+BCD and GS-PAT. Other rows count only where
  a statement or its numbers name them. "(ours)" marks a statement of this page, and "points" are percentage
  points of accuracy. Code names such as lm are the methods' names in midair.

`make paper` writes this page from the tables in [docs/paper](paper). `midair reproduce all --trials
{trials}` makes these tables and the pictures.
"""

PLURAL: dict[Outcome, str] = {
    "holds": "hold",
    "holds in part": "hold in part",
    "does not hold": "do not hold",
}

WORDS = {
    "fig2": (
        "Fig. 2: a pattern of 38 points",
        "36 x 36 transducers play a smiley of 38 points at z = 150 mm. The target is |p| = 1 at each"
        " point, in the authors' unit with lengths in mm (1 Pa for P0 = 1e-3 Pa m). A point counts as"
        " lost if its pressure is below half of the method's mean.",
    ),
    "fig3": (
        "Fig. 3: accuracy",
        "20 x 20 transducers play M random points above the array at z = 150 mm. Each has the target"
        " p1/sqrt(M), where p1 is the pressure of a single focus in the middle. Accuracy is eq. (12) and"
        " may exceed 100 %. The table has the mean accuracy in percent:",
    ),
    "fig4": (
        "Fig. 4: variation",
        "The trials are those of fig. 3. sigma is eq. (13), with 1/M where the paper prints 1/N. The table"
        " has the mean sigma:",
    ),
    "fig5": (
        "Fig. 5: time over the number of points",
        "The array has 20 x 20 transducers and plays M random points. Greedy treats the transducers in a"
        " fixed order. The methods run alternately on the same scenes, and all are implemented in midair."
        " The first table has the median CPU time of a whole solve in ms, with the times of all threads"
        " added. The second table has the slope of log time over log M, for all M and for M of 64 and more."
        " A slope of 1 means that the time is linear in M. In the third table, a time counts as linear if the"
        f" slope from M = {fig5.LARGE} on differs from 1 by at most {fig5.LINEAR}. At smaller M, the work for"
        " each transducer that does not depend on M takes most of the time:",
    ),
    "fig6": (
        "Fig. 6: time over the number of transducers",
        "M = 64 random points lie in a square that grows with the array. The first table has the median"
        " CPU time in ms, the second the slope of log time over log N. A slope of 1 means that the time is"
        " linear in N. In the third table, a time counts as linear if its slope differs from 1 by at most"
        f" {fig5.LINEAR}:",
    ),
    "fig7": (
        "Fig. 7: weak and strong targets, the order of the transducers",
        "36 x 36 transducers play one point at (0, 0, 150 mm) by greedy with K = 1, L = 16. Width is"
        " the distance between the outermost places where |p| is above half its maximum, within 60 mm."
        " An artefact is the highest |p| farther than 13.4 mm from the point, relative to the point."
        " Power is the mean of |q|². Targets are in the authors' unit, as in fig. 2. The table has medians"
        " over the orders in which greedy treats the transducers. A focus is ideal if its width is that of"
        " diffraction, 1.2 wavelengths over twice the numerical aperture, within 5 %. The third row of panels"
        " (e and f) is not in the paper: it shows the cure that section V of the paper asks for.",
    ),
}

#: The rows of the last table but one: item, paper, authors' code, here.
DIFFERENCES = (
    (
        "unit of length",
        "none",
        "mm",
        "P0 = 1e-3 Pa m, so |p| = 1 Pa is the 1 of the authors' code, with lengths in mm",
    ),
    (
        "greedy's objective",
        "squared errors (eq. 7, alg. 1)",
        "absolute errors",
        'squared errors; absolute errors in the rows "l1"',
    ),
    ("sigma, eq. (13)", "1/N", "1/M", "1/M"),
    ("first line of algs. 1 and 2", "the pressures p start at 0", "not compared", "the drives start at 0"),
    (
        "amplitudes (k+1)/K, k from 0 to K-1",
        'no "off"',
        'no "off"',
        'as in the paper: without an "off", weak targets make the background of fig. 7 (a)',
    ),
    (
        "fixed order",
        "columns first, from the corner",
        "x changes fastest",
        "y changes fastest: only then is fig. 7 (b) wide in x",
    ),
    ("random order", "a fresh order", "a shuffle without a seed", "a shuffle with a seed for each trial"),
    (
        "EVD",
        "regularisation gamma = 1",
        "a row of the eigenvector matrix instead of an eigenvector; q times mean(|Gq|/a), with the targets a;"
        " clamp",
        "an eigenvector; clamp",
    ),
    (
        "SDP+BCD",
        '"as in the original"',
        "moduli of the eigenvector as they are; divided by max |q|",
        "as in the authors' code",
    ),
    (
        "LM",
        "phases only",
        "phases of drives and points unknown, |q| = 1, 200 steps",
        "as in the authors' code",
    ),
    (
        "GS-PAT",
        "100 iterations",
        "the amplitude enters the back-propagation twice; clamp",
        "the amplitude enters once, with equal results; clamp",
    ),
)


def build(folder: Path, docs: Path) -> None:
    """Copies the tables and reduced pictures of `folder` to docs/paper, and writes docs/paper.md."""
    place = docs / "paper"
    place.mkdir(exist_ok=True)
    for name in FIGURES:
        shutil.copyfile(folder / f"{name}.csv", place / f"{name}.csv")
        reduce(folder / f"{name}.png", place / f"{name}.png")
    output.write(docs / "paper.md", text(place).encode())


def reduce(picture: Path, target: Path) -> None:
    """Writes a picture with few colours and the page's width."""
    image = Image.open(picture).convert("RGB")
    image.thumbnail((WIDTH, 2 * WIDTH))
    content = io.BytesIO()
    image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(
        content, "PNG", optimize=True
    )
    output.write(target, content.getvalue())


def text(place: Path) -> str:
    """Returns the page, from the tables in docs/paper."""
    rows = {name: tables.read(place / f"{name}.csv") for name in FIGURES}
    verdicts = {name: figure.judge(rows[name]) for name, figure in FIGURES.items()}
    outcomes = [verdict.verdict for judged in verdicts.values() for verdict in judged]
    reported = ", ".join(f"{outcomes.count(kind)} {words}" for kind, words in PLURAL.items())
    parts = [HEAD.format(trials=rows["fig3"][0]["trials"], count=len(outcomes), outcomes=reported)]
    for name, (title, words) in WORDS.items():
        judged = [[it.statement, f"**{it.verdict}**", it.evidence] for it in verdicts[name]]
        parts += [
            f"## {title}\n\n![{title}](paper/{name}.png)\n\n{fill(words, 115)}\n",
            TABLES[name](rows[name]),
            table(["the paper says", "we find", "by these numbers"], judged),
        ]
    title = "## Differences between the paper's text, its authors' code and this page"
    head = ["item", "paper", "authors' code", "here"]
    parts.append(f"{title}\n\n{table(head, DIFFERENCES)}")
    if "uniform" in tables.labels(rows["fig3"]):
        parts.append(ours(rows))
    return "\n".join(parts)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns rows as a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)


def pattern(rows: tables.Rows) -> str:
    """Returns the table of fig. 2, with a row for each method."""
    names = ("accuracy", "sigma", "uniformity")
    lines = []
    for key in tables.labels(rows):
        first = tables.pick(rows, method=key)[0]
        lines.append([first["label"], *(f"{first[name]:.3f}" for name in names), str(fig2.lost(rows, key))])
    return table(["method", *names, "lost points"], lines)


def wide(rows: tables.Rows, x: str, cell: Callable[[tables.Row], str]) -> str:
    """Returns a table with a row for each method and a column for each value of x."""
    sizes = dict.fromkeys(str(row[x]) for row in rows)
    methods = [tables.pick(rows, method=key) for key in tables.labels(rows)]
    return table([f"{x} =", *sizes], [[mine[0]["label"], *map(cell, mine)] for mine in methods])


def means(rows: tables.Rows, factor: float, digits: int) -> str:
    """Returns a table of figs. 3 and 4: means and half their confidence intervals."""

    def cell(row: tables.Row) -> str:
        half = (row["high"] - row["low"]) / 2
        return f"{factor * row['mean']:.{digits}f} ± {factor * half:.{digits}f}"

    return wide(rows, "M", cell)


def times(rows: tables.Rows, x: str) -> str:
    """Returns the tables of figs. 5 and 6: medians in ms, and slopes."""
    firsts = [tables.pick(rows, method=key)[0] for key in tables.labels(rows)]
    slopes = [[row["label"], timing.stated_slope(row)] for row in firsts]
    medians = wide(rows, x, lambda row: f"{1e3 * row['median']:.3g}")
    return f"{medians}\n" + table(["method", f"slope of log time over log {x}"], slopes)


def foci(rows: tables.Rows) -> str:
    """Returns the table of fig. 7, with a row for each panel."""
    names = ("panel", "target", "order", "balance", "orders")
    head = [*names, "width x / mm", "width y / mm", "artefact", "power"]
    return table(
        head,
        [
            [
                *(str(row[name]) for name in names),
                *(f"{row[name]:.1f}" for name in ("width_x_mm", "width_y_mm")),
                f"{row['artefact']:.2f}",
                f"{row['power']:.3f}",
            ]
            for row in rows
        ],
    )


TABLES: dict[str, Callable[[tables.Rows], str]] = {
    "fig2": pattern,
    "fig3": partial(means, factor=100, digits=1),
    "fig4": partial(means, factor=1, digits=4),
    "fig5": partial(times, x="M"),
    "fig6": partial(times, x="N"),
    "fig7": foci,
}


def ours(rows: dict[str, tables.Rows]) -> str:
    """Returns a table of the advantages of `uniform` over the paper's best two methods."""
    accuracies = (tables.pick(rows["fig3"], method=key) for key in ("greedy", "lm", "uniform"))
    lines = [
        [str(sigma["M"]), *(f"{100 * row['mean']:.1f}" for row in found), f"{sigma['mean']:.1e}"]
        for sigma, *found in zip(tables.pick(rows["fig4"], method="uniform"), *accuracies, strict=True)
    ]
    return (
        "## What `uniform` adds\n\n`uniform` gives all points the same pressure, and the highest that it"
        " finds. Its sigma is nearly 0.\n\n"
        + table(["M", "greedy / %", "LM / %", "uniform / %", "uniform's sigma"], lines)
    )


if __name__ == "__main__":
    build(Path(sys.argv[1]), Path(sys.argv[2]))
