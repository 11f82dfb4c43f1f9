"""Ctrl-C and SIGTERM: work stops between two steps, calls of libraries are abandoned."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn, TypeVar

T = TypeVar("T")

#: Name of a thread that runs a library's function.
LIBRARY = "midair: a library's call"

#: Signals that request the end of a program; Windows has only the first two.
ENDING = [signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if name in signal.Signals.__members__]


class Terminated(KeyboardInterrupt):
    """Raised if a signal other than Ctrl-C requests the end of the program."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


class Stop:
    """Whether a signal has requested a stop; `number` is the signal, 0 without a request."""

    number = 0

    def __call__(self) -> bool:
        """Return whether a stop was requested."""
        return self.number != 0

    def error(self) -> KeyboardInterrupt:
        """Return the exception for the signal; work raises it after its finished parts are stored."""
        return KeyboardInterrupt() if self.number == signal.SIGINT else Terminated(self.number)


@contextmanager
def interruptible() -> Iterator[Stop]:
    """Convert Ctrl-C and SIGTERM to a request that the block checks. A second signal ends the program.

    Threads other than the main thread receive no signals, so they never get a request.
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
    """Raise `Terminated` in the block if a signal requests the end, so that it cleans up as after Ctrl-C."""

    def end(number: int, _: FrameType | None) -> None:
        signal.signal(number, before[signal.Signals(number)])
        raise Terminated(number)

    with _handling(end, ENDING[1:]) as before:
        yield


def interruptibly(function: Callable[..., T], *arguments: Any, **keywords: Any) -> T:
    """Call a library's function that releases the GIL, so that Ctrl-C takes effect within 0.1 s.

    The call runs in a thread. After Ctrl-C the caller no longer waits for this thread. Python itself ends
    only when the thread has, because it still uses the library's memory.
    """
    result: Future[T] = Future()

    def call() -> None:
        try:
            result.set_result(function(*arguments, **keywords))
        except BaseException as error:
            result.set_exception(error)

    threading.Thread(target=call, name=LIBRARY).start()
    # Not `Thread.join`: if Ctrl-C interrupts it, Python below 3.13 takes the thread for ended, and at its own
    # end it does not wait for it.
    while not wait([result], 0.05).done:
        pass
    return result.result()


def leave(status: int) -> NoReturn:
    """End the program; at once if a library's call still runs after Ctrl-C."""
    if any(thread.name == LIBRARY for thread in threading.enumerate()):
        os._exit(status)
    sys.exit(status)


Handler = Callable[[int, FrameType | None], Any]


@contextmanager
def _handling(handler: Handler, numbers: list[signal.Signals]) -> Iterator[dict[signal.Signals, Any]]:
    """Yield the former handlers while `handler` handles the signals.

    Ignored signals, as under nohup, stay ignored.
    """
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
