"""Memory: how much a computation may take at once, as python/src/limits.rs has it for the core."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from .arguments import refused

#: Complex numbers in one block: 16 MB in single precision, a fifth of a second of work.
BLOCK = 1 << 21


def blocks(count: int, each: int) -> Iterator[slice]:
    """Slices of `count` items, of `each` numbers an item; no block is empty."""
    length = max(1, BLOCK // max(each, 1))
    for start in range(0, count, length):
        yield slice(start, min(start + length, count))


#: Bytes, unless the machine has less or MIDAIR_MEMORY says otherwise.
MOST = 8_000_000_000

UNITS = {"KB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12, "": 1.0}


def limit() -> int:
    """The most bytes at once: MIDAIR_MEMORY (2e9, 500MB, 16GB), else 8 GB or 3/4 of the machine's if less."""
    asked = os.environ.get("MIDAIR_MEMORY")
    if not asked:
        machine = _installed()
        return MOST if machine is None else min(MOST, machine // 4 * 3)
    text = asked.strip().upper()
    unit = next(unit for unit in UNITS if text.endswith(unit))
    with suppress(ValueError):
        found = float(text.removesuffix(unit)) * UNITS[unit]
        if math.isfinite(found) and found >= 0:
            return int(found)
    raise refused("MIDAIR_MEMORY", asked, "give bytes, such as 2e9, 500MB or 16GB")


def _installed() -> int | None:
    """The machine's memory in bytes, where Linux tells."""
    with suppress(OSError, StopIteration, ValueError):
        lines = Path("/proc/meminfo").read_text().splitlines()
        line = next(line for line in lines if line.startswith("MemTotal:"))
        return int(line.removeprefix("MemTotal:").removesuffix("kB")) * 1024
    return None
