"""Ctrl-C and SIGTERM: work stops between two steps, library calls are abandoned, the rest cleans up."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn, TypeVar

T = TypeVar("T")

#: The name of a thread that calls a library.
LIBRARY = "midair: a library's call"

#: Signals that ask a program to end; Windows has only the first two.
ENDING = [
    signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if name in signal.Signals.__members__
]


class Terminated(KeyboardInterrupt):
    """The end requested by a signal other than Ctrl-C."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


class Stop:
    """Whether a stop was requested; `number` is the signal, 0 before."""

    number = 0

    def __call__(self) -> bool:
        """Whether there was a request."""
        return self.number != 0

    def error(self) -> KeyboardInterrupt:
        """The end requested by the signal, for work that stores only finished parts."""
        return KeyboardInterrupt() if self.number == signal.SIGINT else Terminated(self.number)


@contextmanager
def interruptible() -> Iterator[Stop]:
    """Turns Ctrl-C and SIGTERM into a request to stop, which the block asks for. A second one ends.

    Outside the main thread, where no signal arrives, there never is one.
    """
    stop = Stop()

    def ask(number: int, _: FrameType | None) -> None:
        stop.number = number
        for each, previous in before.items():
            signal.signal(each, previous)

    with _handling(ask, ENDING) as before:
        yield stop


@contextmanager
def terminable() -> Iterator[None]:
    """End the block by `Terminated` on request, and clean up as after Ctrl-C."""

    def end(number: int, _: FrameType | None) -> None:
        signal.signal(number, before[signal.Signals(number)])
        raise Terminated(number)

    with _handling(end, ENDING[1:]) as before:
        yield


def interruptibly(function: Callable[..., T], *arguments: Any, **keywords: Any) -> T:
    """Calls a library's function that releases the GIL; Ctrl-C arrives meanwhile, within a tenth of a second.

    The call runs in a thread. Ctrl-C leaves it behind, and Python ends when it has ended: a library's memory
    must not go while it computes.
    """
    result: Future[T] = Future()

    def call() -> None:
        try:
            result.set_result(function(*arguments, **keywords))
        except BaseException as error:
            result.set_exception(error)

    thread = threading.Thread(target=call, name=LIBRARY)
    thread.start()
    while thread.is_alive():
        thread.join(0.05)
    return result.result()


def leave(status: int) -> NoReturn:
    """Ends the program, at once where Ctrl-C left a library's call behind."""
    if any(thread.name == LIBRARY for thread in threading.enumerate()):
        os._exit(status)
    sys.exit(status)


Handler = Callable[[int, FrameType | None], Any]


@contextmanager
def _handling(handler: Handler, numbers: list[signal.Signals]) -> Iterator[dict[signal.Signals, Any]]:
    """Signals under a handler, and their former handlers; ignored ones, as under nohup, stay so."""
    before: dict[signal.Signals, Any] = {}
    if threading.current_thread() is threading.main_thread():
        for number in numbers:
            if (previous := signal.getsignal(number)) not in (signal.SIG_IGN, None):
                before[number] = previous
        for number in before:
            signal.signal(number, handler)
    try:
        yield before
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)
