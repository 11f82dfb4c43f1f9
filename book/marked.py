"""Tables of the pages: as Markdown, and between their markers, <!-- NAME:begin --> and <!-- NAME:end -->."""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path


def row(*cells: object) -> str:
    """Returns a row of a Markdown table; bars within cells are escaped."""
    return "| " + " | ".join(str(cell).replace("|", r"\|") for cell in cells) + " |\n"


def rule(columns: int) -> str:
    """Returns the line below the head of a Markdown table."""
    return "|---" * columns + "|\n"


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Returns a Markdown table."""
    return row(*head) + rule(len(head)) + "".join(row(*cells) for cells in rows)


def parts(page: Path, name: str) -> tuple[str, str, str]:
    """Returns the page before the text between a name's markers, this text, and the page after it."""
    before, begin, rest = page.read_text(encoding="utf-8").partition(f"<!-- {name}:begin -->\n")
    inside, end, after = rest.partition(f"<!-- {name}:end -->")
    if not begin or not end:
        raise SystemExit(f"{page} has no text between <!-- {name}:begin --> and <!-- {name}:end -->")
    return before + begin, inside, end + after


def put(page: Path, name: str, text: str) -> None:
    """Replaces the text between a name's markers; the page is never left incomplete."""
    before, _, after = parts(page, name)
    new = page.with_suffix(".new")
    new.write_text(f"{before}{text.rstrip()}\n{after}", encoding="utf-8")
    os.replace(new, page)
