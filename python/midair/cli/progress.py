"""Progress bars on standard error."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)


@contextmanager
def progress_bar(doing: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar for whatever takes over a second; the block calls what it gets with (step, steps)."""
    # A spinner of letters that every terminal has.
    columns = (
        SpinnerColumn("line"),
        TextColumn(doing),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    terminal = Console(stderr=True)
    # Elsewhere even a bar that leaves nothing behind leaves an empty line.
    moves = terminal.is_terminal and not terminal.is_dumb_terminal
    bar = Progress(*columns, console=terminal, transient=True, disable=not moves)
    task = bar.add_task(doing, total=None)
    began = time.monotonic()
    shown = began

    def tell(step: int, steps: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - began > 1 and now - shown > 0.1:
            shown = now
            bar.start()
            bar.update(task, completed=step, total=steps)

    try:
        yield tell
    finally:
        # A bar that was never shown would still end its line.
        if bar.live.is_started:
            bar.stop()
