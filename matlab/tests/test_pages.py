"""The programs on the pages and in the help texts run, and check their results themselves."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1]
DOCS = FOLDER.parent / "docs"
PAGES = ["matlab.md", "tutorials/own-script.md", "coming-from.md"]
HELP = sorted(FOLDER.joinpath("+midair").glob("*.m"))


@pytest.mark.parametrize("page", PAGES)
def test_the_page(octave: Callable[[str], str], page: str) -> None:
    blocks = re.findall(r"^```matlab\n(.*?)^```", (DOCS / page).read_text("utf-8"), re.MULTILINE | re.DOTALL)
    program = "\n".join(blocks)
    assert "assert(" in program
    octave(f"warning('error', 'midair:scene');\n{program}")


@pytest.mark.parametrize("file", HELP, ids=lambda file: file.stem)
def test_the_example_of_the_help(octave: Callable[[str], str], file: Path) -> None:
    text = file.read_text("utf-8")
    assert re.match(rf"(function|classdef) .*\n  % midair\.{file.stem}  [A-Z]", text)
    example = re.search(r"^ *%   Example:\n((?: *%     .*\n)+)", text, re.MULTILINE)
    if example is None:
        assert file.stem in ("opened", "silence")
    else:
        octave(re.sub(r"^ *%", "", example[1], flags=re.MULTILINE))
