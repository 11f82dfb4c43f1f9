"""Prints flash, heap, stack and instructions of every method on the emulated board: the table of
docs/embedded.md.

python3 firmware/measure.py
"""

from pathlib import Path

import emulated

PAGE = Path(__file__).parents[1] / "docs" / "embedded.md"
BEGIN, END = "<!-- measured:begin -->\n", "<!-- measured:end -->\n"
COUNTS = (64, 256)
POINTS = (1, 4, 8)


def table(target: Path) -> str:
    """Returns the table, with the numbers of the third frame."""
    lines = [
        "| method | flash / kB | N | M | heap / kB | stack / kB | set-up | new points | solve | encode |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for method in emulated.METHODS:
        flash = emulated.flash(target, method) / 1000
        for count in COUNTS:
            for points in POINTS:
                run = emulated.emulated(target, method, str(count), "sonicsurface", points)
                sizes = [f"{run.numbers[name] / 1000:.1f}" for name in ("heap", "stack")]
                names = ("setup", "points", "solve", "encode")
                thousands = [f"{run.instructions(name) / 1000:,.0f}" for name in names]
                cells = [f"`{method}`", f"{flash:.0f}", str(count), str(points), *sizes, *thousands]
                lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    before, rest = PAGE.read_text().split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}{table(emulated.build())}{END}{after}")


if __name__ == "__main__":
    main()
