"""The documentation, run: docstrings, every Python block, every scene file, every command line."""

import doctest
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import midair
import midair._midair
from midair.reproduce import page as paper
from midair.reproduce import tables

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted(ROOT.joinpath("docs").glob("*.md"))]


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


def test_docstrings_run() -> None:
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner()
    names = [midair, *(getattr(midair._midair, name) for name in midair._midair.__all__)]
    for thing in names:
        for example in finder.find(thing, getattr(thing, "__name__", None), module=False, globs={}):
            runner.run(example)
    assert runner.failures == 0
    assert runner.tries > 10


def test_everything_public_has_a_docstring() -> None:
    for name in midair.__all__:
        thing = getattr(midair, name)
        assert thing.__doc__, name
        for attribute, value in vars(thing).items() if isinstance(thing, type) else ():
            assert attribute.startswith("_") or getattr(value, "__doc__", None), f"{name}.{attribute}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_python_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    found = blocks(page, "python")
    assert found or page.name != "README.md"
    names: dict[str, object] = {}
    for block in found:
        exec(compile(block, str(page), "exec"), names)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_scene_files_load(page: Path, tmp_path: Path) -> None:
    found = [block for block in blocks(page, "toml") if "[array]" in block and "[[solver]]" not in block]
    assert found or page.name not in {"README.md", "conventions.md"}
    for block in found:
        path = tmp_path / "scene.toml"
        path.write_text(block)
        assert midair.Scene.load(path).points.size


def test_the_readmes_commands_run(tmp_path: Path) -> None:
    readme = ROOT / "README.md"
    (tmp_path / "scene.toml").write_text(blocks(readme, "toml")[0])
    lines = [line for block in blocks(readme, "console") for line in block.splitlines()]
    commands = [line for line in lines if line.startswith("midair ")]
    assert len(commands) >= 3
    for command in commands:
        done = subprocess.run(
            [sys.executable, "-m", *shlex.split(command)], cwd=tmp_path, capture_output=True, text=True
        )
        assert done.returncode == 0, f"{command}: {done.stderr}"
    assert (tmp_path / "drive.npz").exists()


@pytest.mark.parametrize("name", sorted(midair.solvers()))
def test_every_solver_has_its_row_and_paragraph(name: str) -> None:
    assert re.search(rf"^\| `{name}` \|.* here \|$", (ROOT / "README.md").read_text(), re.MULTILINE)
    page = ROOT.joinpath("docs", "how-to-choose.md").read_text()
    assert len(re.findall(rf"^\| `{name}` \|", page, re.MULTILINE)) == 2, "a row of words and one of numbers"
    assert re.search(rf"^\*\*`{name}`\*\* ", page, re.MULTILINE), "a paragraph"


def test_every_picture_is_there() -> None:
    for page in PAGES:
        for target in re.findall(r"!\[[^]]*\]\(([^)]+)\)", page.read_text()):
            assert (page.parent / target).stat().st_size > 1000, target


def test_every_method_is_in_the_quality_time_picture() -> None:
    rows = tables.read(ROOT / "docs" / "quality-time.csv")
    for count in (4, 16, 64):
        found = {row["method"] for row in tables.pick(rows, M=count)}
        assert found == {*midair.solvers(), "greedy 256 x 16"}, "run `make figures`"


def test_the_papers_page_is_what_its_tables_say() -> None:
    assert (ROOT / "docs" / "paper.md").read_text() == paper.text(ROOT / "docs" / "paper")
