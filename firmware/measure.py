"""Puts flash, heap, stack and instructions of every method on the emulated board into docs/embedded.md.

python3 firmware/measure.py
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import emulated

sys.path.append(str(Path(__file__).resolve().parents[1] / "book"))
from marked import put, table

PAGE = Path(__file__).resolve().parents[1] / "docs" / "embedded.md"
HEAD = "method", "flash / kB", "N", "M", "heap / kB", "stack / kB", "set-up", "new points", "solve", "encode"
#: Numbers of transducers and of points.
SIZES = (64, 4), (256, 1), (256, 4), (256, 8)


def rows(target: Path) -> Iterator[list[object]]:
    """Yields a row for each method and size, with the numbers of the third frame."""
    for method in emulated.METHODS:
        flash = emulated.flash(target, method) / 1000
        for count, points in SIZES:
            run = emulated.emulated(target, method, str(count), "sonicsurface", points)
            sizes = [f"{run.numbers[name] / 1000:.1f}" for name in ("heap", "stack")]
            names = ("setup", "points", "solve", "encode")
            thousands = [f"{run.instructions(name) / 1000:,.0f}" for name in names]
            yield [f"`{method}`", f"{flash:.0f}", count, points, *sizes, *thousands]


if __name__ == "__main__":
    put(PAGE, "measured", table(HEAD, rows(emulated.build())))
