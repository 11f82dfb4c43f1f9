"""Exit statuses, and errors as one line."""

from __future__ import annotations

from pathlib import Path

#: Exit status of a request that cannot be answered, of a fault of midair's own, of a reader of standard
#: output that is gone (128 + SIGPIPE), and of Ctrl-C (128 + SIGINT); another signal's is 128 + its number.
REFUSED, FAULT, UNREAD, INTERRUPTED = 2, 70, 141, 130


def one_line(error: BaseException | str) -> str:
    """What an error says, without line breaks."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())


def fault(error: BaseException) -> str:
    """What nobody foresaw, and where, for a report."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    where = "" if trace is None else f" ({Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno})"
    said = f"{type(error).__name__}: {one_line(error)}"
    return f"a fault of midair itself, please report this line with your command and files: {said}{where}"
