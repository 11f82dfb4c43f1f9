"""Executes messages one after another in a thread of its own; few of each source may wait."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Hashable
from contextlib import suppress
from queue import SimpleQueue

from .._boards.transport import before_what_computes

#: Largest number of messages of a source that may wait.
MOST_WAITING = 1000


class Work:
    """Queue of functions, each with the source that wants it."""

    def __init__(self) -> None:
        self._queue: SimpleQueue[tuple[Hashable, Callable[[], object]] | None] = SimpleQueue()
        self._waiting: Counter[Hashable] = Counter()
        self._lock = threading.Lock()
        threading.Thread(target=self._run, daemon=True).start()

    def ask(self, source: Hashable, act: Callable[[], object]) -> bool:
        """Execute a function later. Return False, and do not, if too many of its source wait."""
        with self._lock:
            if self._waiting[source] >= MOST_WAITING:
                return False
            self._waiting[source] += 1
        self._queue.put((source, act))
        return True

    def end(self) -> None:
        """End the thread when what waits is done."""
        self._queue.put(None)

    def _run(self) -> None:
        before_what_computes()
        while (request := self._queue.get()) is not None:
            source, act = request
            # A function tells its source of errors itself. An unexpected one must not end the others.
            with suppress(Exception):
                act()
            with self._lock:
                self._waiting[source] -= 1
                if not self._waiting[source]:
                    del self._waiting[source]
