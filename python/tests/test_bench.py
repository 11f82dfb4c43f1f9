"""Tests how the side-by-side benchmark judges drives and writes its table; it does not run the benchmark."""

import re
import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import midair
import oracle

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "bench"
marked = SimpleNamespace(**runpy.run_path(str(ROOT / "book" / "marked.py")))


def load(name: str) -> SimpleNamespace:
    return SimpleNamespace(**runpy.run_path(str(BENCH / f"{name}.py")))


def test_the_tasks_field_and_metrics_agree_with_midairs() -> None:
    task = load("rivals").Task("paper20", None, 4, (), ())
    rng = np.random.default_rng(1)
    drive = (rng.uniform(0, 1, 400) * np.exp(2j * np.pi * rng.uniform(size=400))).astype(np.complex64)
    found = oracle.metrics(np.abs(task.propagation(task.points(0)) @ drive), task.targets)
    scene = midair.Scene(task.array, task.points(0), task.targets, sound_speed=340.0)
    expected = midair.judge(scene, drive, precision="double")
    for name in ("accuracy", "sigma", "uniformity"):
        # Both results are in double precision. The error of kr = 200 rad is 3e-14, of 400 terms below 1e-11.
        assert found[name] == pytest.approx(getattr(expected, name), rel=1e-11), name


def test_the_pages_tables_are_made_from_the_newest_record() -> None:
    record = load("record")
    newest = max(BENCH.joinpath("records").glob("20*.csv"))
    for path, table in record.tables(record.read(newest)).items():
        assert marked.parts(ROOT / path, "bench")[1] == f"{table.rstrip()}\n", path


def test_the_papers_numbers_are_those_of_the_record_and_of_the_pages() -> None:
    paper = (ROOT / "paper" / "paper.md").read_text("utf-8")
    record = load("record")
    newest = max(BENCH.joinpath("records").glob("20*.csv"))
    assert f"`bench/records/{newest.name}`" in paper
    made = re.findall(r"^\| (\w+, [\w ]+) \| (.*) \|$", record.brief(record.read(newest)), re.MULTILINE)
    for (name, cells), label in zip(made, ("`fast`", "`uniform`", "autd3, greedy"), strict=True):
        one, four, _, sixteen, most, spread = cells.split(" | ")
        row = " | ".join([label, one, four, sixteen, most, spread.removeprefix("0")])
        assert f"| {row} |" in paper, name
    (error, calibrated) = re.findall(r"(\d\.\d %)\s\(root mean square\).*? (\d\.\d %) after", paper, re.DOTALL)[0]
    (again,) = re.findall(r"Repeated readings differ\sby (\d\.\d %)", paper)
    measuring = (ROOT / "docs" / "measuring.md").read_text("utf-8")
    assert f"| 140 | {error} | {calibrated} |" in measuring
    assert f"Repeated readings scatter by {again} in" in measuring
    (most,) = re.findall(r"resonances of a levitated bead are within (\d+) %", paper)
    gaps = re.findall(r"^\| resonance .*\| \+(\d+) % \|$", (ROOT / "docs/beads.md").read_text("utf-8"), re.M)
    assert int(most) == max(map(int, gaps))
    assert "It has fifteen methods" in paper
    assert len(midair.solvers()) == 15


def test_the_paper_has_josss_sections_and_cites_what_its_bibliography_has() -> None:
    paper = (ROOT / "paper" / "paper.md").read_text("utf-8")
    text = paper.split("---\n", 2)[2]
    assert 750 <= len(text.split()) <= 1000
    wanted = ["Summary", "Statement of need", "State of the field", "Software design"]
    wanted += ["Research impact statement", "AI usage disclosure", "Acknowledgements", "References"]
    assert re.findall(r"^# (.*)$", text, re.MULTILINE) == wanted
    entries = re.findall(r"^@\w+\{(\w+),", (ROOT / "paper" / "paper.bib").read_text("utf-8"), re.MULTILINE)
    assert {*re.findall(r"@(\w+)", text)} == {*entries}


def test_no_table_of_the_readme_is_longer_than_a_screen() -> None:
    tables = re.findall(r"(?:^\|.*\n)+", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE)
    assert len(tables) >= 3
    assert all(len(table.splitlines()) < 40 for table in tables)


def row(rival: str, method: str, form: str, grid: str, m: int, ns: float) -> dict[str, str]:
    known = {"rival": rival, "method": method, "form": form, "grid": grid}
    known |= {"N": "996", "M": str(m), "ns_median": str(ns)}
    return dict.fromkeys(load("record").FIELDS, "0.5") | known


def test_ratios_refer_to_autd3s_greedy_on_the_board() -> None:
    record = load("record")
    rows = [
        row("midair", record.GREEDY, "solve", "board", 16, 100),
        row("midair", record.GREEDY, "Solver", "board", 16, 50),
        row("midair", record.GREEDY, "solve", "none", 16, 80),
        row("midair", "fast", "solve", "board", 4, 20),
        row("autd3", record.GREEDY, "full", "board", 16, 2500),
        row("autd3", "gspat", "full", "board", 4, 150),
        row("textbook f64", record.GREEDY, "call", "none", 16, 5000),
    ]
    table = record.table(rows)
    assert "| midair, greedy 16 phases | - | - | - | 25 (31) | - | 0.500 / 0.500 | - |" in table
    assert "| autd3, greedy 16 phases | - | - | - | 1 | - |" in table
    assert "| textbook f64, greedy 16 phases | - | - | - | - (0.5) | - |" in table
    assert "autd3's gspat" not in table
    few = [row("midair", "fast", "solve", "board", m, 20) for m in (1, 8)]
    few += [row("autd3", "gspat", "full", "board", m, 90) for m in (1, 8)]
    assert "1/4.5, 1/7.5, 1/4.5 of the time of autd3's gspat" in " ".join(record.table([*rows, *few]).split())


def test_gs_pats_own_setting_is_a_table_of_its_own() -> None:
    record = load("record")
    rows = [
        row("autd3", record.GREEDY, "full", "board", 4, 900),
        row("midair", "fast", "batch, 2 cores", "board", 32, 4e4),
    ]
    assert "| midair, fast, `solve_batch`, 2 cores | 25,000 |" in record.table(rows)
    assert "GTX" not in record.table(rows[:1])


def test_a_page_without_markers_is_left_alone(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("no table", "utf-8")
    with pytest.raises(SystemExit, match="has no text between <!-- bench:begin --> and"):
        marked.put(page, "bench", "a table")
    assert page.read_text("utf-8") == "no table"


def test_a_table_is_put_between_its_markers(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- a:begin -->\nold\n<!-- a:end -->\nafter\n", "utf-8")
    rows = [["|p|", "1"], [r"\phi", "2"]]
    marked.put(page, "a", marked.table(["what", "value"], rows))
    before, inside, after = marked.parts(page, "a")
    assert (before, after) == ("before\n<!-- a:begin -->\n", "<!-- a:end -->\nafter\n")
    assert inside == "| what | value |\n|---|---|\n| \\|p\\| | 1 |\n| \\phi | 2 |\n"
