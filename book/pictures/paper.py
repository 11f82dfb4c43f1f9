"""docs/paper.md: the figures of Suzuki et al. 2021 by `midair reproduce`, and their tables (2 h)."""

import shutil
from pathlib import Path

from marked import put, table
from midair._cli.progress import progress_bar
from midair._reproduce import FIGURES, fig2, reproduce, tables
from pictures import DOCS, ROOT, reduce

#: The verdicts as the page's sentence has them.
PLURAL = {"holds": "hold", "holds in part": "hold in part", "does not hold": "do not hold"}


def main() -> None:
    """Makes the figures, copies tables and reduced pictures to docs/paper, and writes the page's parts."""
    made = ROOT / "out" / "paper"
    reproduce(["all"], made, progress=progress_bar)
    for name in FIGURES:
        shutil.copyfile(made / f"{name}.csv", DOCS / "paper" / f"{name}.csv")
        reduce(made / f"{name}.png", DOCS / "paper" / f"{name}.png")
    for name, text in parts(DOCS / "paper").items():
        put(DOCS / "paper.md", name, text)


def parts(place: Path) -> dict[str, str]:
    """Returns the parts of the page between its markers, from the tables in a folder."""
    rows = {name: tables.read(place / f"{name}.csv") for name in FIGURES}
    verdicts = {name: figure.judge(rows[name]) for name, figure in FIGURES.items()}
    every = [verdict for judged in verdicts.values() for verdict in judged]
    outcomes = [verdict.verdict for verdict in every if not verdict.statement.startswith("(ours)")]
    counts = ", ".join(f"{outcomes.count(kind)} {words}" for kind, words in PLURAL.items())
    found = {"statements": f"Of the paper's {len(outcomes)} statements, {counts}.\n"}
    for name in FIGURES:
        judged = [[it.statement, f"**{it.verdict}**", it.evidence] for it in verdicts[name]]
        found[name] = table(["the paper says", "we find", "by these numbers"], judged)
    for name, own in (("fig2", pattern), ("fig7", foci)):
        found[name] = f"{own(rows[name])}\n{found[name]}"
    return found


def pattern(rows: tables.Rows) -> str:
    """Returns the table of fig. 2, with a row for each method."""
    names = ("accuracy", "sigma", "uniformity")
    lines = []
    for key in tables.labels(rows):
        first = tables.pick(rows, method=key)[0]
        lines.append([first["label"], *(f"{first[name]:.3f}" for name in names), str(fig2.lost(rows, key))])
    return table(["method", *names, "lost points"], lines)


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
