"""What commands print for people, and the letters of the pictures that they write."""

import io
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import main, tables
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


def test_a_sentence_reports_an_answer() -> None:
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


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ["solve", "scene.toml"],
        ["compare", "scene.toml"],
        ["compare", "scene.toml", "--solvers", "naive,gs"],
        ["solvers"],
        ["solvers", "greedy"],
        ["boards"],
        ["presets"],
    ],
    ids=" ".join,
)
def test_tables_are_whole_in_a_terminal_of_80_columns(command: list[str], tmp_path: Path) -> None:
    small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]]).save(tmp_path / "scene.toml")
    far, near = os.openpty()
    environment = {**os.environ, "COLUMNS": "80", "TERM": "dumb"}
    program = [sys.executable, "-m", "midair", *command]
    done = subprocess.Popen(
        program, stdin=near, stdout=near, stderr=subprocess.DEVNULL, cwd=tmp_path, env=environment
    )
    os.close(near)
    shown = b""
    while True:
        try:
            shown += os.read(far, 65536)
        except OSError:  # the end of a pseudo-terminal
            break
    os.close(far)
    assert done.wait() == 0
    lines = shown.decode().replace("\r", "").splitlines()
    assert all("\u2026" not in line for line in lines)
    table = lines[:-1]
    assert all(len(line.rstrip()) <= 80 for line in table)
    if command[0] == "compare":
        text = "\n".join(lines)
        solvers = command[-1].split(",") if len(command) > 2 else list(midair.solvers())
        assert all(solver in text.split() for solver in solvers)


def test_show_draws_the_plane_of_the_points_in_letters(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["solve", "--preset", "sonicsurface", "--at", "0,0,0.1", "--at", "0.03,0,0.1", "--show"])
    out = capsys.readouterr().out
    rows = [line for line in out.splitlines() if set(line) & set("@%#") and not set(line) - set(" .:-=+*#%@")]
    # The two foci, 30 mm apart in a picture of 65 mm.
    brightest = max(rows, key=lambda row: row.count("@"))
    assert brightest.index("@") < 38 < brightest.rindex("@")
    assert "z = 100 mm; brightest" in out
