"""Exit statuses, and errors as one line."""

from __future__ import annotations

#: Exit status of a request that cannot be answered, and of Ctrl-C (128 + SIGINT).
REFUSED, INTERRUPTED = 2, 130


def one_line(error: BaseException) -> str:
    """What an error says, without line breaks."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())
