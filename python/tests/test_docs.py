"""Runs the documentation's code and checks its numbers: Python blocks, scene files, commands."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

import midair
from midair import _cli as cli
from midair._reproduce import tables
from sane import columns, printed, sane, written

ROOT = Path(__file__).parents[2]
#: Commands that need a cluster (test_cluster.py has one) or take minutes.
TOO_BIG = ("--scheduler", "dataset.toml", "--judge")
#: Pages whose examples need an extra that the development environment does not have.
EXTRAS = {"learn-poses.md": "torch", "own-objective.md": "jax"}
PAGES = [ROOT / "README.md", *sorted(ROOT.joinpath("docs").rglob("*.md"))]
#: Pages of code; test_japanese.py says that the code of a translation is that of its English page.
RUN = [page for page in PAGES if "ja" not in page.parts]


def named(page: Path) -> str:
    return page.relative_to(ROOT).with_suffix("").as_posix()


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=named)
def test_python_blocks_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    if page.name in EXTRAS:
        pytest.importorskip(EXTRAS[page.name])
    found = blocks(page, "python")
    assert found or page.name != "README.md"
    printed_blocks = re.findall(r"^```python\n(.*?)^```\n\n```output\n(.*?)^```", page.read_text("utf-8"), re.M | re.S)
    outputs = dict(printed_blocks)
    names: dict[str, object] = {}
    for k, block in enumerate(found):
        exec(compile(block, str(page), "exec"), names)
        text = capsys.readouterr().out
        assert text == outputs.get(block, text), f"{named(page)}, example {k + 1} prints something else"
        made = {name: value for name, value in names.items() if not name.startswith("__")}
        where = f"{named(page)}, example {k + 1}"
        assert sane(made, where), f"{where}: no answer to look at"


@pytest.mark.parametrize("page", RUN, ids=named)
def test_scene_files_are_solved(page: Path, tmp_path: Path) -> None:
    found = [block for block in blocks(page, "toml") if "[array]" in block and "[[solver]]" not in block]
    assert found or page.name != "files.md"
    for block in found:
        path = tmp_path / "scene.toml"
        path.write_text(block, "utf-8")
        assert sane(midair.solve(midair.Scene.load(path)), f"scene file of {page.name}")


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=named)
def test_commands_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for block in blocks(page, "toml"):
        name = "sweep.toml" if "[[solver]]" in block else "scene.toml"
        if not (tmp_path / name).exists():
            (tmp_path / name).write_text(block, "utf-8")
    # Some commands read files in docs/, as they would in a clone of the repository.
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    lines = [line for block in blocks(page, "console") for line in block.splitlines()]
    commands = [line.partition("  #")[0] for line in lines if line.startswith("midair ")]
    commands = [line for line in commands if not any(big in line for big in TOO_BIG)]
    assert len(commands) >= 3 or page.name != "README.md"
    answers = 0
    for command in commands:
        before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
        with pytest.raises(SystemExit) as left_by:
            cli.main(shlex.split(command)[1:])
        out, err = capsys.readouterr()
        assert not left_by.value.code, f"{command}: {err}"
        assert "warning" not in err, f"{command}: {err}"
        table = printed(out)
        left = [path for path in tmp_path.iterdir() if before.get(path) != path.stat().st_mtime_ns]
        answers += (columns(table, command) if table else 0) + written(left)
    assert answers or not commands, "no command of the page gave a number to look at"


@pytest.mark.parametrize("name", sorted(midair.solvers()))
def test_every_solver_has_its_row_and_paragraph(name: str) -> None:
    page = ROOT.joinpath("docs", "how-to-choose.md").read_text("utf-8")
    assert len(re.findall(rf"^\| `{name}` \|", page, re.MULTILINE)) == 2, "a row of words and one of numbers"
    assert re.search(rf"^\*\*`{name}`\*\* ", page, re.MULTILINE), "a paragraph"


def test_every_picture_is_there_and_loads_fast() -> None:
    for page in PAGES:
        for target in re.findall(r"!\[[^]]*\]\(([^)]+)\)", page.read_text("utf-8")):
            assert 1000 < (page.parent / target).stat().st_size < 400_000, target


def test_every_method_is_in_the_quality_time_picture() -> None:
    rows = tables.read(ROOT / "docs" / "quality-time.csv")
    for count in (4, 16, 64):
        found = {row["method"] for row in tables.pick(rows, M=count)}
        assert found == {*midair.solvers(), "greedy 256 x 16"}, "run `make pictures NAMES=quality`"


def test_the_papers_page_is_what_its_tables_say(book: Callable[[str], ModuleType]) -> None:
    made = book("pictures.paper").parts(ROOT / "docs" / "paper")
    assert len(made) == 7
    for name, text in made.items():
        assert book("marked").parts(ROOT / "docs" / "paper.md", name)[1] == text, name


def test_the_files_that_contributing_names_are_there() -> None:
    page = ROOT.joinpath("CONTRIBUTING.md").read_text("utf-8")
    assert len(page.encode()) <= 10_000
    for row in re.findall(r"^\| [^|]+ \| (.*) \|$", page.partition("## The map")[2], re.MULTILINE):
        # A name without a folder is in the last folder of its cell.
        folder = ROOT
        for name in re.findall(r"`([\w./-]+(?:/|\.(?:rs|py|ts|cs|yml)))`", row):
            if ROOT.joinpath(name).exists():
                path = ROOT / name
                folder = path if path.is_dir() else path.parent
            assert any((place / name).exists() for place in (ROOT, folder)), f"{name} is not in {folder}"


@pytest.mark.parametrize("page", ["serve.md", "reliability.md"])
def test_the_tests_that_promises_name_are_there(page: str) -> None:
    rows = re.findall(r"^\| [^|]+ \| (.*`test_.*) \|$", ROOT.joinpath("docs", page).read_text("utf-8"), re.MULTILINE)
    assert len(rows) > 5
    for row in rows:
        files, names = re.findall(r"`(test_\w+\.py)`", row), re.findall(r"`(test_\w+)\.\.\.`", row)
        texts = "".join((ROOT / "python" / "tests" / file).read_text("utf-8") for file in files)
        for name in names:
            assert f"def {name}" in texts, name
