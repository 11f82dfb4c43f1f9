"""What commands print for people, and the letters of the pictures that they write."""

import io
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import tables
from midair._judging.compare import cells as compare_cells
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
    assert max(map(len, printed.splitlines())) <= width
    words = set(printed.split())
    for name, cells in compare_cells(solutions, solvers).items():
        assert {name, *" ".join(cells).split()} <= words


def test_solve_ends_with_one_plain_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    solution = midair.solve(small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]]), "uniform")
    console = tables._Console(width=80, file=io.StringIO())
    monkeypatch.setattr(tables, "console", console)
    tables.print_summary(solution)
    got = np.abs(solution.pressures)
    level = 20 * np.log10(got.min() / np.sqrt(2) / 20e-6)
    said = console.file.getvalue()
    assert said.startswith(f"2 points at {got.min():.4g}")
    assert f"({level:.0f} dB" in said
    assert "with 64 transducers" in said


def test_a_pdf_and_an_svg_have_fonts_that_journals_take(tmp_path: Path) -> None:
    figure = midair.solve(small(points=[[0, 0, 0.15]]), "naive").plot()
    for name in ("a.pdf", "a.svg"):
        tables.write_image(tmp_path / name, figure)
    assert b"/Type3" not in (tmp_path / "a.pdf").read_bytes()
    assert b"<text" in (tmp_path / "a.svg").read_bytes()
