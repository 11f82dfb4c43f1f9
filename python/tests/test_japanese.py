"""Japanese pages against the English ones: the same code, pictures and terms, and links to each other."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
TUTORIALS = sorted(path.name for path in (DOCS / "tutorials").glob("*.md"))
PAGES = ["index.md", "glossary.md", *(f"tutorials/{name}" for name in TUTORIALS)]
#: A regular expression for a Japanese character: kana, kanji or full-width punctuation.
JAPANESE = "[\u3001-\u30ff\u4e00-\u9fff\uff01-\uff5e]"


def code(page: Path) -> list[tuple[str, str]]:
    """Returns language and content of each code block, without comments and docstrings."""
    found = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    return [(language, bare(language, block)) for language, block in found]


def bare(language: str, block: str) -> str:
    """Returns a code block without the parts that a translation may change."""
    if language != "python":
        return re.sub(r" *%.*" if language == "matlab" else r" *#.*", "", block)
    tree = ast.parse(block)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and ast.get_docstring(node):
            node.body = node.body[1:]
    return ast.unparse(ast.fix_missing_locations(tree))


def pictures(page: Path) -> list[Path]:
    return [page.parent.joinpath(path).resolve() for path in re.findall(r"!\[.*?\]\((.+?)\)", page.read_text("utf-8"))]


def rows(page: Path) -> list[list[str]]:
    """Returns the cells of every row of the page's tables, without heads and rules."""
    lines = re.findall(r"^\| .*\|$", page.read_text("utf-8"), re.MULTILINE)
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]
    return [row for row in cells if row[0] not in ("English", "用語")]


def test_every_tutorial_is_there_in_japanese() -> None:
    assert sorted(path.name for path in (DOCS / "ja" / "tutorials").glob("*.md")) == TUTORIALS


@pytest.mark.parametrize("page", PAGES)
def test_code_and_pictures_are_those_of_the_english_page(page: str) -> None:
    assert code(DOCS / "ja" / page) == code(DOCS / page)
    assert pictures(DOCS / "ja" / page) == pictures(DOCS / page)


@pytest.mark.parametrize("page", PAGES)
def test_each_page_links_to_the_other_at_its_head(page: str) -> None:
    for own, name, other in ((DOCS / page, "日本語", f"ja/{page}"), (DOCS / "ja" / page, "English", page)):
        head = "\n".join(own.read_text("utf-8").splitlines()[:6])
        found = re.search(rf"\[{name}\]\((.+?)\)", head)
        assert found, own
        assert (own.parent / found[1]).resolve() == DOCS / other


def test_both_glossaries_have_the_same_terms() -> None:
    english = [(row[1], row[0], re.findall("`.*?`", row[3])) for row in rows(DOCS / "glossary.md")]
    japanese = [(row[0], row[1], re.findall("`.*?`", row[3])) for row in rows(DOCS / "ja" / "glossary.md")]
    assert len(japanese) > 50
    assert japanese == english


@pytest.mark.parametrize("page", PAGES)
def test_no_line_ends_within_a_paragraph(page: str) -> None:
    """Checks that lines are not broken within Japanese text: the page would show a space there."""
    text = re.sub(r"^```.*?^```", "", (DOCS / "ja" / page).read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    assert not re.findall(rf"{JAPANESE}\n{JAPANESE}", text)
