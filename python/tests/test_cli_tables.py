"""The tables and texts that commands print, and the pictures in characters."""

import io
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import main, tables
from midair._cli.app import TABLES
from midair._judging.compare import cells as compare_cells
from midair._pictures.words import sentence
from midair._support import text
from scenes import small

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("width", [60, 80, 120])
def test_tables_are_whole_at_any_width(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]])
    solvers = ["uniform", "greedy", "naive", "tikhonov", "gspat", "descent", "lm", "sdp"]
    solutions = [midair.solve(scene, solver) for solver in solvers]
    console = tables._Console(width=width, file=io.StringIO())
    monkeypatch.setattr(tables, "console", console)
    tables.print_solutions("compare", solutions)
    printed = console.file.getvalue()
    table = printed.rpartition("left out")[0] or printed.rpartition("columns: ")[0]
    assert max(len(line.rstrip()) for line in table.splitlines()[1:]) <= width
    words = set(printed.split())
    left = set(printed.partition("left out, because the terminal is narrow: ")[2].partition(";")[0].split(", "))
    assert left <= {"sigma", "residual", "limit", "accuracy", "steps", "time", ""}
    for name, cells in compare_cells(solutions, solvers).items():
        if name not in left:
            assert {name, *" ".join(cells).split()} <= words


def test_the_sentence_is_about_the_method_nearest_to_the_request(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = midair.Scene(midair.Array.preset("autd3"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]], 3000.0)
    console = tables._Console(width=120, file=io.StringIO())
    monkeypatch.setattr(tables, "console", console)
    tables.print_solutions("compare", [midair.solve(scene, solver) for solver in ("gs", "uniform", "naive")])
    assert console.file.getvalue().startswith("uniform: 2 points at 2999 Pa")


def test_a_miss_of_many_times_the_request_is_a_plain_number() -> None:
    scene = midair.Scene(midair.Array.preset("paper20"), [[-0.03, 0, 0.15], [0.03, 0, 0.15]], 0.02)
    words = sentence(midair.solve(scene, "sdp"))
    assert re.search(r"within \d{3,} % of what was requested", words)


@pytest.mark.parametrize("command", [*TABLES])
def test_every_printed_column_is_explained(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, moving = tmp_path / "scene.toml", ROOT / "docs" / "scenes" / "orbit.toml"
    small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]]).save(scene)
    heads: list[str] = []
    table = tables._table

    def kept(columns: dict[str, list[str]], **how: bool) -> object:
        heads.extend(columns)
        return table(columns, **how)

    monkeypatch.setattr(tables, "_table", kept)
    arguments = {
        "solve": [scene],
        "compare": [scene],
        "motion": [moving],
        "tolerate": [scene, "--phase", "10", "--dead", "0.1", "--trials", "2"],
        "exposure": [scene, "--at", "0,0.1,0.5"],
    }
    if command in {"dataset", "reproduce", "ports"}:
        pytest.skip("needs minutes or hardware")
    with pytest.raises(SystemExit):
        main([command, *map(str, arguments.get(command, []))])
    assert f"columns: midair {command} --help, docs/columns.md" in capsys.readouterr().out
    assert heads
    assert {*heads} <= text.meanings(TABLES[command]).keys()
    with pytest.raises(SystemExit):
        main([command, "--help"])
    shown = capsys.readouterr().out
    assert all(f"\n{head} " in shown for head in text.meanings(TABLES[command]))


def test_a_sentence_reports_an_answer() -> None:
    solution = midair.solve(small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]]), "uniform")
    got = np.abs(solution.pressures)
    level = 20 * np.log10(got.max() / np.sqrt(2) / 20e-6)
    assert sentence(solution) == f"2 points at {got.max():.4g} Pa ({level:.0f} dB) with 64 transducers, even to 0.1 %"


def test_a_pdf_and_an_svg_have_fonts_that_journals_take(tmp_path: Path) -> None:
    figure = midair.solve(small(points=[[0, 0, 0.15]]), "naive").plot()
    for name in ("a.pdf", "a.svg"):
        tables.write_image(tmp_path / name, figure)
    assert b"/Type3" not in (tmp_path / "a.pdf").read_bytes()
    assert b"<text" in (tmp_path / "a.svg").read_bytes()


def test_the_best_of_each_metric_is_marked_in_a_terminal_alone() -> None:
    columns = {"solver": ["a", "b", "c"], "accuracy": ["0.9", "0.8", "0.9"], "gap": ["1.0%", "-", "3.0%"]}
    columns["sigma"] = ["0.1", "0.1", "0.1"]
    for terminal in (True, False):
        console = tables._Console(width=60, file=io.StringIO(), force_terminal=terminal)
        console.print(tables._table(tables.best_of(columns)))
        green = re.findall("\x1b\\[1;32m *([^ \x1b]*)", console.file.getvalue())
        assert sorted(green) == (["0.9", "0.9", "1.0%"] if terminal else [])


def test_lines_too_long_for_any_table_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    tables.print_columns("ports", {"port": ["x" * 90, "y" * 90], "could be": ["z" * 90, "-"]})
    shown = capsys.readouterr().out
    for letter in "xyz":
        assert letter * 90 in shown


#: Commands that print, and a part of their first or last line.
COMMANDS = {
    "solve scene.toml": "2 points at ",
    "compare scene.toml": ": 2 points at ",
    "compare scene.toml --solvers naive,gs": ": 2 points at ",
    "tolerate scene.toml --phase 10 --gain 0.1 --trials 20": "all faults together: 95% of the trials keep ",
    "exposure scene.toml --at 0,0.1,0.5 --at 0,0.2,0.5": "the loudest place, 0,0.",
    "motion motion.toml --solvers glide,naive": ": 6 frames of 1 point at 1000 Hz with 64 transducers, at ",
    "calibrate readings.npz -o found.toml": "wrote found.toml",
    "sweep sweep.toml -o table.csv": "wrote 4 rows to table.csv",
    "solvers": "midair solvers NAME ",
    "solvers greedy": "  Python:",
    "boards": "midair boards NAME ",
    "presets": "midair presets NAME ",
    "ports": "serial port",
    "reproduce fig2 --output figures": " of the paper: ",
    "doctor sonicsurface:loop --microphone 0,0,.15 --microphone .1,0,.1 --simulate 'dead 9'": "readings, ",
    "play board.toml --on sonicsurface:loop --for 200ms": "off after 0.",
    "off sonicsurface:loop": "sonicsurface at sonicsurface:loop is off",
    "export drive.npz drive.csv": "wrote drive.csv",
}

MOTION = """
[array]
grid = { nx = 8, ny = 8, pitch = 0.01 }
[motion]
rate = 1000.0
[[motion.path]]
kind = "line"
start = [0, 0, 0.15]
end = [0.001, 0, 0.15]
speed = 0.2
"""

SWEEP = """
seeds = 1
[array]
preset = "paper20"
[points]
count = [2, 3]
x = [-0.02, 0.02]
y = [-0.02, 0.02]
z = 0.15
[[solver]]
name = "naive"
[[solver]]
name = "gs"
"""


def inputs(folder: Path) -> None:
    """Writes the files that the commands read."""
    scene = small(points=[[-0.02, 0, 0.15], [0.02, 0.01, 0.15]])
    scene.save(folder / "scene.toml")
    midair.solve(scene, "naive").save(folder / "drive.npz")
    midair.Scene(midair.Array.preset("sonicsurface"), scene.points).save(folder / "board.toml")
    (folder / "sweep.toml").write_text(SWEEP, "utf-8")
    (folder / "motion.toml").write_text(MOTION, "utf-8")
    few = midair.Scene(midair.Array.grid(3, 3, 0.01), scene.points)
    drives = np.exp(2j * np.pi * np.random.default_rng(0).random((20, 9)))
    known = {"drives": drives, "readings": drives @ few.propagation().T, "microphones": few.points}
    np.savez(folder / "readings.npz", **known, scene=few.json())


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_tables_are_whole_in_a_terminal_of_80_columns(command: str, tmp_path: Path) -> None:
    inputs(tmp_path)
    far, near = os.openpty()
    environment = {**os.environ, "COLUMNS": "80", "TERM": "dumb"}
    program = [sys.executable, "-m", "midair", *shlex.split(command)]
    # `play` prints its progress on standard error.
    beside = near if command.startswith("play") else subprocess.DEVNULL
    done = subprocess.Popen(program, stdin=near, stdout=near, stderr=beside, cwd=tmp_path, env=environment)
    os.close(near)
    shown = b""
    while True:
        try:
            shown += os.read(far, 65536)
        except OSError:  # reading raises this at the end of a pseudo-terminal
            break
    os.close(far)
    assert done.wait() == 0
    lines = shown.decode().replace("\r", "").splitlines()
    assert all("\u2026" not in line for line in lines)
    # Tables begin with a blank line; other text may be wider than 80 characters.
    blank = [k for k, line in enumerate(lines) if not line.strip()]
    table = lines[blank[0] : blank[-1]] if blank else []
    assert all(len(line.rstrip()) <= 80 for line in table)
    assert COMMANDS[command] in lines[0] + lines[-1]
    assert not re.search(r"\b1 (points|frames|transducers|rows|faults|ports)\b", "\n".join(lines))
    if command.startswith("compare"):
        text = "\n".join(lines)
        solvers = command.rpartition(" ")[2].split(",") if "--" in command else list(midair.solvers())
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
    assert out.splitlines()[-1].endswith(" Pa")


def test_show_reports_the_unit_of_the_paper(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["solve", "--preset", "paper20", "--at", "0,0,0.1", "--show"])
    out = capsys.readouterr().out
    assert "in the paper's unit" in out.splitlines()[0]
    assert out.splitlines()[-1].endswith(" in the paper's unit")


def test_a_list_continues_on_further_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    console = tables._Console(width=50, file=io.StringIO())
    monkeypatch.setattr(tables, "console", console)
    words = "one two three four five six seven eight nine ten eleven"
    tables.print_list("presets", {"preset": ["a", "bb"], "transducers": ["7", "12"], "what it is": [words, "x"]})
    rows = [line.split() for line in console.file.getvalue().splitlines()[:-1]]
    assert [word for row in rows for word in row if word in words.split()] == words.split()
    assert max(map(len, console.file.getvalue().splitlines()[:-1])) <= 50


def test_a_picture_is_grey_in_a_terminal_of_few_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    field = midair.field(small(), midair.solve(small()), midair.Plane(at=0.15, size=0.08, pixels=40))
    for system, letters in (("standard", "█"), ("truecolor", "\u2580")):
        console = tables._Console(width=60, file=io.StringIO(), force_terminal=True, color_system=system)
        monkeypatch.setattr(tables, "console", console)
        tables.print_field(field)
        assert letters in console.file.getvalue()
