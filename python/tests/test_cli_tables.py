"""What commands print for people, and the letters of the pictures that they write."""

import io
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import tables
from midair._judging.compare import cells as compare_cells
from midair._judging.compare import sentence
from scenes import small


@pytest.mark.parametrize("width", [60, 80, 120])
def test_tables_are_whole_at_any_width(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]])
    solvers = ["uniform", "greedy", "naive", "tikhonov", "gspat", "descent", "lm", "sdp"]
    solutions = [midair.solve(scene, solver) for solver in solvers]
    console = tables._Console(width=width, file=io.StringIO())
    monkeypatch.setattr(tables, "console", console)
    tables.print_solutions(solutions)
    printed = console.file.getvalue()
    table = printed.rpartition("left out")[0] or printed.rpartition("\n")[0]
    assert max(len(line.rstrip()) for line in table.splitlines()[:-1]) <= width
    words = set(printed.split())
    left = set(printed.partition("left out, for want of width: ")[2].partition(";")[0].split(", "))
    assert left <= {"sigma", "residual", "limit", "accuracy", "steps", "time", ""}
    for name, cells in compare_cells(solutions, solvers).items():
        if name not in left:
            assert {name, *" ".join(cells).split()} <= words


def test_an_answer_is_told_in_one_plain_sentence() -> None:
    solution = midair.solve(small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]]), "uniform")
    got = np.abs(solution.pressures)
    level = 20 * np.log10(got.max() / np.sqrt(2) / 20e-6)
    assert (
        sentence(solution)
        == f"2 points at {got.max():.4g} Pa ({level:.0f} dB) with 64 transducers, even to 0.1 %"
    )


def test_a_pdf_and_an_svg_have_fonts_that_journals_take(tmp_path: Path) -> None:
    figure = midair.solve(small(points=[[0, 0, 0.15]]), "naive").plot()
    for name in ("a.pdf", "a.svg"):
        tables.write_image(tmp_path / name, figure)
    assert b"/Type3" not in (tmp_path / "a.pdf").read_bytes()
    assert b"<text" in (tmp_path / "a.svg").read_bytes()
