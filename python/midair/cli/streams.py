"""Standard streams as they come: closed, without the letters of a name, or gone while they are written to."""

from __future__ import annotations

import os
import sys
from contextlib import suppress


def prepare() -> None:
    """Make streams that take anything: a closed one leads nowhere, letters it lacks are escaped."""
    for descriptor in range(3):
        # Otherwise the next file opened would take the place of a closed stream.
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        # What stands in for a stream, as in a notebook, may not know how.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def tell(line: str) -> None:
    """A line on standard error, if anybody reads it."""
    with suppress(OSError):
        print(line, file=sys.stderr, flush=True)


def abandon() -> None:
    """Leave standard output to nobody, so that nothing more is said of it when Python ends."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
