"""Columns of text as a table, plain or in HTML."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape


def plain(columns: Mapping[str, list[str]]) -> str:
    """A heading, a rule and a line for each row."""
    lines = list(zip(*([name, *column] for name, column in columns.items()), strict=True))
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    texts = ["  ".join(map(str.ljust, line, widths)).rstrip() for line in lines]
    return "\n".join([texts[0], "-" * (sum(widths) + 2 * (len(widths) - 1)), *texts[1:]])


def html(columns: Mapping[str, list[str]], caption: str) -> str:
    """The same as an HTML table under a caption."""
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    rows = zip(*columns.values(), strict=True)
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return (
        f"<table><caption>{escape(caption)}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )
