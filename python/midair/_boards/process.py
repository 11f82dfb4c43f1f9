"""The owner's side of a guard process: sends calls, and turns the device off if the guard dies."""

import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError, TimeoutError as NoAnswer, wait
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from . import wire
from .errors import KINDS, BoardError, BoardLost, BoardTimeout
from .transport import SIMULATED, before_what_computes, open_transport, prepare
from .watcher import Stops
from .wire import Kind

#: Longest time in s to wait for a call, and for a call that opens a device; longer than the transports' own
#: limits.
PATIENCE = 12.0
OPENING = 70.0

#: Environment variable that every guard has. A connecting program that has it was itself started as a guard,
#: because it was mistaken for the Python interpreter.
GUARD = "MIDAIR_GUARD"

#: The wait for the answer to a beat is divided into this many short waits.
WAITS = 40

CLOSED = "this connection is closed: connect again"


@dataclass(frozen=True)
class Stats:
    """Counts of the frames of a connection.

    Attributes
    ----------
    frames : int
        Frames sent to the board.
    late : int
        Frames of streams that came more than a period late: skipped or played.
    lapses : int
        Times that the hold expired and everything was turned off.
    """

    frames: int
    late: int
    lapses: int

    def __sub__(self, before: "Stats") -> "Stats":
        return Stats(self.frames - before.frames, self.late - before.late, self.lapses - before.lapses)


class GuardProcess:
    """Starts the guard process of a device. Two threads exchange messages with it.

    A signal interrupts only the main thread, so it never cuts a message.

    Parameters
    ----------
    transport
        Description for `open_transport`.
    hold
        Time in s without a call after which the guard turns everything off.
    """

    def __init__(self, transport: dict[str, Any], hold: float) -> None:
        self._transport = transport
        self._owner = os.getpid()
        self._numbers = count(1)
        self._calls: dict[int, Future[bytes]] = {}
        self._outbox: SimpleQueue[tuple[Kind, int, bytes] | None] = SimpleQueue()
        self._opened = self._closing = False
        self._lock = threading.RLock()
        self._process = _started()
        self._threads = [threading.Thread(target=act, daemon=True) for act in (self._write, self._read)]
        for thread in self._threads:
            thread.start()
        path = [os.path.abspath(entry) for entry in sys.path]
        setting = json.dumps({"path": path, "transport": transport, "hold": hold, "owner": self._owner})
        try:
            opened = self.ask(Kind.OPEN, setting.encode())
            prepare(transport)
            self.answer(opened, OPENING)
        except BaseException:
            # If the caller is interrupted, do not wait until the device is open.
            self._process.terminate()
            self.close()
            raise
        self._opened = True
        threading.Thread(target=self._beat, daemon=True).start()

    def call(self, kind: Kind, content: bytes = b"") -> bytes:
        """Send a request, wait for its answer and return it."""
        return self.answer(self.ask(kind, content))

    def ask(self, kind: Kind, content: bytes = b"") -> Future[bytes]:
        """Send a message; return the future of its answer."""
        if self._owner != os.getpid():
            raise BoardError(f"this connection is that of process {self._owner}: connect in the process that plays")
        number, future = next(self._numbers), Future[bytes]()
        with self._lock:
            if self._closing:
                raise BoardError(CLOSED)
            self._calls[number] = future
        if self._process.poll() is not None:
            self._abandon()
        self._outbox.put((kind, number, content))
        return future

    def answer(self, future: Future[bytes], patience: float = PATIENCE) -> bytes:
        """Wait for an answer and return it; raise the error that it reports."""
        try:
            return future.result(patience)
        except NoAnswer as error:
            raise BoardTimeout("the board's guard does not answer: connect again") from error

    def close(self) -> None:
        """Let the guard turn everything off and end. Never raises an error and never hangs."""
        if self._owner != os.getpid():
            return
        self._outbox.put((Kind.CLOSE, 0, b""))
        self._outbox.put(None)
        with self._lock:
            already, self._closing = self._closing, True
        reader = self._threads[1]
        # Garbage collection may call `close` in any thread, also in the reader itself.
        if already or reader is threading.current_thread():
            return

        def is_over(pause: float) -> bool:
            reader.join(pause)
            return not reader.is_alive()

        if self._hangs(is_over):
            self._process.kill()
            reader.join()
            self._silence()

    def _beat(self) -> None:
        """Send beats while the guard answers. Kill a guard that hangs; the reader then stops the device."""
        with suppress(BoardError):
            while True:
                requested = self.ask(Kind.BEAT)

                def answered(pause: float, requested: Future[Any] = requested) -> bool:
                    return bool(wait([requested], pause).done)

                if self._hangs(answered):
                    self._process.kill()
                    return
                requested.result()
                time.sleep(wire.BEATS)

    def _hangs(self, is_over: Callable[[float], bool]) -> bool:
        """Return whether the guard is stopped, or does not react within the allowed time."""
        stops = Stops(self._process.pid)
        # Many short waits: if this program was stopped itself, that counts as one short wait only.
        for _ in range(WAITS):
            if is_over(wire.MISSED / WAITS):
                return False
            if stops.look():
                break
        return True

    def _write(self) -> None:
        """Write messages to the guard until the connection closes."""
        before_what_computes()
        assert self._process.stdin is not None
        with self._process.stdin as pipe, suppress(wire.Gone):
            while (message := self._outbox.get()) is not None:
                wire.write(pipe.fileno(), *message)

    def _read(self) -> None:
        """Read answers and pass them to the callers. If the guard dies, turn the device off."""
        before_what_computes()
        assert self._process.stdout is not None
        with self._process.stdout as pipe, suppress(wire.Gone):
            while True:
                kind, number, content = wire.read(pipe.fileno())
                # If the caller has stopped waiting, there is no future.
                with suppress(KeyError, InvalidStateError):
                    future = self._calls.pop(number)
                    if kind == Kind.FAILED:
                        reported = json.loads(content)
                        future.set_exception(KINDS.get(reported["kind"], BoardError)(reported["message"]))
                    else:
                        future.set_result(content)
        self._process.wait()
        if not self._closing:
            self._silence()
        self._abandon()

    def _abandon(self) -> None:
        """Report to all waiting callers that the guard has ended."""
        lost = "the board's guard process has ended, everything was turned off: connect again"
        while self._calls:
            with suppress(KeyError, InvalidStateError):
                _, future = self._calls.popitem()
                future.set_exception(BoardError(CLOSED) if self._closing else BoardLost(lost))

    def _silence(self) -> None:
        """Turn the device off without the guard, if the guard had opened it."""
        if self._opened and self._transport["kind"] not in SIMULATED:
            with suppress(Exception):
                transport = open_transport(self._transport)
                with suppress(Exception):
                    transport.silence()
                transport.close()


def _started() -> subprocess.Popen[bytes]:
    """Start a guard process with two pipes, with Python's standard library only.

    It has a session of its own, on Windows a console of its own: closing the program's does not end it.
    """
    try:
        return subprocess.Popen(
            [_interpreter(), "-I", "-S", str(Path(__file__).with_name("start.py"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            env={**os.environ, GUARD: "1"},
        )
    except OSError as error:
        reported = f'the guard process "{_interpreter()}" cannot be started ({error.strerror})'
        raise BoardError(f"{reported}: end other programs, or give more memory") from error


def _interpreter() -> str:
    """Return the Python that runs the guard: never a frozen application, which would start itself."""
    requested = os.environ.get("MIDAIR_PYTHON") or ("" if getattr(sys, "frozen", False) else sys.executable)
    if not requested or GUARD in os.environ:
        raise BoardError(
            "a board's guard process needs a Python interpreter, and this program is none: "
            "name one by the environment variable MIDAIR_PYTHON"
        )
    return requested
