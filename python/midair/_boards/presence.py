"""Presence: whether a process runs or is stopped, as /proc has it; elsewhere whether it is there."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

#: A dead process that its parent has not waited for, and stopped ones, by a signal and by a debugger.
DEAD, STOPPED, TRACED = "ZX", "T", "t"


def runs(process: int) -> bool:
    """Whether a process is there and neither stopped nor a zombie."""
    if state := _state(process):
        return state not in DEAD + STOPPED + TRACED
    try:
        os.kill(process, 0)
    except OSError:
        return False
    # Where there is no /proc, a process that is there runs.
    return not Path("/proc/self/stat").exists()


def is_stopped(process: int) -> bool:
    """Whether a process is stopped by a signal."""
    return _state(process) == STOPPED


class Stops:
    """Notes whether a process is stopped by a signal; one that is stopped but at a single look goes on."""

    def __init__(self, process: int) -> None:
        self._process = process
        self._before = False

    def look(self) -> bool:
        """Whether it is stopped now and was at the look before."""
        before, self._before = self._before, is_stopped(self._process)
        return before and self._before


def _state(process: int) -> str:
    """The letter of a process's state, none where it cannot be read."""
    with suppress(OSError):
        return Path(f"/proc/{process}/stat").read_text(errors="replace").rpartition(")")[2].split()[0]
    return ""
