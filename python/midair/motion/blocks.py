"""Blocks: frames worked through a few at a time, so that memory stays bounded whatever their number."""

from __future__ import annotations

from collections.abc import Iterator

#: Complex numbers in one block: 16 MB in single precision, a fifth of a second of work.
BLOCK = 1 << 21


def blocks(count: int, each: int) -> Iterator[slice]:
    """Slices of `count` items, of `each` numbers an item; no block is empty."""
    length = max(1, BLOCK // max(each, 1))
    for start in range(0, count, length):
        yield slice(start, min(start + length, count))
