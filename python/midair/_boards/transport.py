"""Transport: sends frames to a device, in the guard process. `open_transport` makes transports of all kinds.

`LineTransport` is the base of serial lines: a board never answers, so this program computes when the line is
free.

This module imports neither midair itself nor NumPy, so a guard starts within a few hundredths of a second.
"""

import os
import threading
import time
from abc import abstractmethod
from contextlib import suppress
from importlib import import_module
from typing import Any, Protocol

from .errors import BoardError

#: Bits on a serial line for each byte: a start bit, eight data bits, a stop bit.
BITS = 10

#: The longest time in s that bytes may wait in the line when the next frame is written. It matters for long
#: frames, as of a chain of boards; otherwise at most one frame waits.
MOST_AHEAD = 0.025

#: Modulation below this frequency, in Hz, sends whole frames, on and off, instead of swaps.
LEAST_HZ = 0.05

#: Largest share of the line's time that the swaps of a modulation may take.
MOST_SWAPS = 0.2

#: A modulation that is late by more than this, in s, skips swaps instead of catching up.
DELAYED = 0.1


class Transport(Protocol):
    """A device that plays frames. Every method except `close` raises `BoardError` or a subclass.

    By default a device cannot modulate, stores no sequence, and is never known to be gone.
    """

    def play(self, frame: bytes) -> None:
        """Send a frame. Returns when the line has accepted it; at most two frames wait in the line."""

    def silence(self) -> None:
        """Turn everything off now. May be called at any time, and repeatedly."""

    def modulate(self, wave: Any) -> None:
        """Modulate the amplitude of all frames from now on, at a frequency in Hz; None ends it."""
        if wave is not None:
            raise BoardError("this board cannot modulate: stream drives of changing amplitude")

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Store `count` frames in the device, which repeats them by itself at `rate` frames per second."""
        raise BoardError("this board holds no sequence: use stream")

    def look(self) -> None:
        """Raise BoardLost if the device is known to be gone. Sends nothing."""

    def close(self) -> None:
        """Release the device. Never raises an error and never hangs."""


def before_what_computes() -> None:
    """Give this thread, which must keep time, a higher priority than computing threads, if allowed."""
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))


class LineTransport(Transport):
    """Sends frames at the line's speed; modulates by swapping two banks. Subclasses write the bytes."""

    def __init__(self, *, baud: int, silence: str, off: str, swap: str | None = None) -> None:
        self._byte = BITS / baud
        self._silence = bytes.fromhex(silence)
        self._off = bytes.fromhex(off)
        self._swap = None if swap is None else bytes.fromhex(swap)
        self._free = 0.0
        #: Whether the bytes that turn everything off were the last ones in the line.
        self._silent = False
        self._hz: float | None = None
        self._frame: bytes | None = None
        self._lock = threading.Lock()
        self._swinging = threading.Event()
        self._failed: BoardError | None = None

    @abstractmethod
    def _write(self, content: bytes) -> None:
        """Write bytes to the line."""

    def play(self, frame: bytes) -> None:
        """Wait until at most one frame is still in the line, then write this frame."""
        with self._lock:
            self._steady()
            self._frame = frame
            self._begin()

    def modulate(self, hz: float | None) -> None:
        """Modulate at `hz`: swap between a bank with the frame and one that is off, 2 hz times a second."""
        most = MOST_SWAPS / (2 * self._byte)
        if hz is not None and not LEAST_HZ <= hz <= most:
            raise BoardError(f"modulate is given {hz:g} Hz: give {LEAST_HZ:g} to {most:.4g}, for the line's sake")
        with self._lock:
            self._steady()
            swapped, self._hz = self._hz is not None, hz
            if self._frame is not None:
                self._begin(loaded=not swapped)
            self._drain()

    def silence(self) -> None:
        """Stop the modulation and turn everything off. Bytes that are already in the line are sent first.

        While the line still has the bytes that turn everything off, they are not sent again: calls in quick
        succession must not make the next frame wait.
        """
        with self._lock:
            self._swinging.set()
            self._failed = self._frame = None
            if not self._silent or self._free <= time.monotonic():
                self._give(self._silence)
                self._silent = True

    def _begin(self, *, loaded: bool = False) -> None:
        """Send the frame unless the board has it (`loaded`), and start the swaps if a modulation is set."""
        assert self._frame is not None
        if not loaded:
            self._pace(self._frame)
        if self._hz is None:
            return
        self._pace(self._off)
        self._swinging = threading.Event()
        begin = max(self._free, time.monotonic())
        given = self._swinging, begin, 0.5 / self._hz
        threading.Thread(target=self._swing, args=given, daemon=True).start()

    def _pace(self, frame: bytes) -> None:
        ahead = min(len(frame) * self._byte, MOST_AHEAD)
        time.sleep(max(0.0, self._free - time.monotonic() - ahead))
        self._give(frame)

    def _give(self, content: bytes) -> None:
        self._silent = False
        self._write(content)
        self._free = max(self._free, time.monotonic()) + len(content) * self._byte

    def _swing(self, stopped: threading.Event, begin: float, half: float) -> None:
        """Swap the banks every half period after `begin`, until stopped."""
        assert self._swap is not None
        before_what_computes()
        count = 1
        while not stopped.wait(max(0.0, begin + count * half - time.monotonic())):
            with self._lock:
                if stopped.is_set():
                    return
                self._silent = False
                try:
                    self._write(self._swap)
                except BoardError as error:
                    self._failed = error
                    return
            count += 1
            late = time.monotonic() - begin - count * half
            if late > DELAYED:
                # An even number of swaps is skipped, so that the bank that plays stays the same.
                count += 2 * int(late / (2 * half))

    def _steady(self) -> None:
        """Stop the swaps of the two banks; raise the error, if any, that occurred during a swap."""
        self._swinging.set()
        if self._failed is not None:
            failed, self._failed = self._failed, None
            raise failed

    def _stop(self) -> None:
        """Stop the swaps of the two banks, because the line is about to be closed."""
        with self._lock:
            self._swinging.set()

    def _drain(self) -> None:
        """Wait until the line has transmitted all bytes."""
        time.sleep(max(0.0, self._free - time.monotonic()))


#: Module and class of each kind of transport. The class gets the other entries of the description as
#: arguments.
TRANSPORTS = {
    "serial": ("serial_port", "SerialTransport"),
    "fifo": ("fifo", "FifoTransport"),
    "udp": ("autd3", "Autd3Transport"),
    "null": ("simulated", "NullTransport"),
    "loop": ("simulated", "LoopTransport"),
    "file": ("simulated", "FileTransport"),
}

#: Kinds of transport without a real device.
SIMULATED = ("null", "loop", "file")


def prepare(description: dict[str, Any]) -> None:
    """Import what `open_transport` needs, which takes too long on a busy computer once a guard is dead."""
    # The guard reports what cannot be imported.
    with suppress(Exception):
        import_module(f"{__package__}.{TRANSPORTS[description['kind']][0]}")


def open_transport(description: dict[str, Any]) -> Transport:
    """Make the transport that a JSON description specifies.

    {"kind": "serial", "port": ..., "baud": ..., ...} or {"kind": "udp", "address": ..., "boards": ...}:
    `kind` selects the class, the other entries are its arguments. After opening, the device is silent.
    """
    given = dict(description)
    module, name = TRANSPORTS[given.pop("kind")]
    made: Transport = getattr(import_module(f"{__package__}.{module}"), name)(**given)
    return made
