"""Progress bars and messages on standard error, and exit statuses."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

#: Exit statuses: of a rejected request; of a result for lengths that are probably in another unit; of an
#: internal error of midair; if the reader of standard output has closed it (128 + SIGPIPE); of Ctrl-C (128 +
#: SIGINT). Another signal's status is 128 + its number.
REFUSED, DOUBTED, FAULT, UNREAD, INTERRUPTED = 2, 3, 70, 141, 130


#: Terminal colours of the first word of a line.
SHADES = {"error": "31", "warning": "33"}


def one_line(error: BaseException | str) -> str:
    """Return the text of an error without line breaks."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.strerror}: {error.filename}{_meant(error)}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())


def _meant(error: OSError) -> str:
    """Return ": did you mean ...?" if a similar file exists beside a missing one, else ""."""
    path = Path(os.fsdecode(error.filename)) if isinstance(error, FileNotFoundError) else None
    if path is None or not path.parent.is_dir():
        return ""
    from difflib import get_close_matches

    near = get_close_matches(path.name, sorted(os.listdir(path.parent)), 1, 0.75)
    return f": did you mean {path.parent / near[0]}?" if near else ""


def fault(error: BaseException) -> str:
    """Return the text of an unexpected error and the place where it occurred, for a bug report."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    where = "" if trace is None else f" ({Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno})"
    said = f"{type(error).__name__}: {one_line(error)}"
    return f"a fault of midair itself, please report this line with your command and files: {said}{where}"


def prepare() -> None:
    """Prepare the standard streams: closed ones discard text, others escape characters they cannot encode.

    On Windows a file or pipe gets UTF-8, as on other systems; a console has all characters anyway.
    """
    for descriptor in range(3):
        # Otherwise the next opened file would get the number of a closed stream, and the stream's text.
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        # In a notebook the streams are replaced by objects without `reconfigure`.
        if hasattr(stream, "reconfigure"):
            encoding = "utf-8" if sys.platform == "win32" and "PYTHONIOENCODING" not in os.environ else None
            stream.reconfigure(encoding=encoding, errors="backslashreplace")


def tell(line: str) -> None:
    """Print a line on standard error, if it is open."""
    first, colon, rest = line.partition(":")
    shade = SHADES.get(first) if sys.stderr.isatty() and "NO_COLOR" not in os.environ else None
    shown = line if shade is None else f"\x1b[{shade}m{first}{colon}\x1b[0m{rest}"
    with suppress(OSError):
        print(shown, file=sys.stderr, flush=True)


def abandon() -> None:
    """Redirect standard output to the null device, so that Python reports no error at exit."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


@contextmanager
def progress_bar(doing: str) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar if a block takes over a second; yields a function to call with (step, steps)."""
    # This spinner consists of ASCII characters, which every terminal has.
    columns = (SpinnerColumn("line"), TextColumn(doing), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    terminal = Console(stderr=True)
    # If the output is no terminal, even a transient bar would leave an empty line.
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
        # Stopping a bar that was never shown would print an empty line.
        if bar.live.is_started:
            bar.stop()
