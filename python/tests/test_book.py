"""The pages of the book that are generated at build time:
all public names, all options, all keys of files.
"""

import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

import midair
from midair._cli.app import app

ROOT = Path(__file__).parents[2]


def test_every_file_of_pictures_names_its_page_and_can_run(book: Callable[[str], ModuleType]) -> None:
    for name, line in book("pictures.__main__").PICTURES.items():
        pages = re.findall(r"(?:docs/)?[\w-]+\.md\b", line.partition(": ")[0])
        assert pages, f"{name}: the first line names its page"
        for page in pages:
            assert (ROOT / "docs" / page.removeprefix("docs/")).exists() or (ROOT / page).exists(), page
        assert callable(book(f"pictures.{name}").main), name


@pytest.fixture
def reference(book: Callable[[str], ModuleType]) -> ModuleType:
    return book("reference")


def test_every_public_name_is_on_one_page(reference: ModuleType) -> None:
    text = "".join(page for _, page in reference.python())
    assert sorted(re.findall(r"^      heading: midair\.(\w+)$", text, re.MULTILINE)) == sorted(midair.__all__)


def test_a_name_that_is_also_a_files_is_the_functions(reference: ModuleType) -> None:
    assert reference.entry("skin").startswith("::: midair._touch.skin.skin\n")
    assert reference.entry("sequence").startswith("::: midair._sequence.solve.sequence\n")
    assert reference.entry("solve").startswith("::: midair.solve\n")


def test_a_name_that_is_on_no_page_is_reported(reference: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(midair, "__all__", [*midair.__all__, "new"])
    with pytest.raises(ValueError, match="new"):
        list(reference.python())


@pytest.mark.slow
def test_every_command_is_described(reference: ModuleType) -> None:
    page = reference.command_line()
    commands = [name for name in app if not name.startswith("-")]
    assert len(commands) >= 16
    for name in commands:
        assert f"\n## midair {name}\n" in page
    assert page.startswith("# Command line\n")


@pytest.mark.slow
def test_every_option_is_described(reference: ModuleType) -> None:
    sections = dict(re.findall(r"^## midair (\S+)\n(.*?)(?=^## |\Z)", reference.command_line(), re.M | re.S))
    for name, section in sections.items():
        arguments = app[name].assemble_argument_collection(parse_docstring=True)
        for argument in arguments:
            assert argument.parameter.help, f"midair {name} {argument.name}"
            for option in argument.names:
                assert re.search(rf"^\* `.*{re.escape(option)}[ ,`].*: \S", section, re.MULTILINE), f"{name} {option}"


def test_every_option_of_every_method_is_described(reference: ModuleType) -> None:
    sections = dict(re.findall(r"^## (\S+)\n(.*?)(?=^## |\Z)", reference.methods(), re.M | re.S))
    assert sections.keys() == midair.solvers().keys()
    for name, about in midair.solvers().items():
        for option in about.options:
            assert re.search(rf"^\| `{option}` \| `\S+` \| \S.* \|$", sections[name], re.MULTILINE), (
                name,
                option,
            )


def test_every_preset_is_described(reference: ModuleType) -> None:
    rows = re.findall(r"^\| `(\w+)` \| \d+ \|(?: \S[^|]* \|){5}$", reference.presets(), re.MULTILINE)
    assert rows == list(midair.presets())


def test_the_page_of_columns_is_what_the_package_prints(book: Callable[[str], ModuleType]) -> None:
    page = book("schema").columns()
    assert (ROOT / "docs" / "columns.md").read_text("utf-8") == page, "run `make generated`"


def test_the_page_of_names_is_what_the_docstrings_say(reference: ModuleType) -> None:
    assert (ROOT / "docs" / "api.md").read_text("utf-8") == reference.index(), "run `make generated`"


def test_the_landing_page_leads_to_what_most_people_want() -> None:
    landing = (ROOT / "docs" / "index.md").read_text("utf-8")
    wanted = [
        "boards.md#sonicsurface",
        "tutorials/letter.md",
        "motion.md",
        "measuring.md",
        "c.md",
        "citing.md",
    ]
    for page in wanted:
        assert f"]({page})" in landing


def test_every_page_is_in_the_navigation(reference: ModuleType) -> None:
    navigation = (ROOT / "book" / "mkdocs.yml").read_text("utf-8").split("\nnav:\n")[1]
    listed = re.findall(r": (\S+\.md)$", navigation, re.MULTILINE)
    written = [page for page, _ in reference.pages()]
    pages = [path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")]
    own = [page for page in listed if not page.startswith("repository/")]
    assert sorted(own) == sorted(pages + written)
