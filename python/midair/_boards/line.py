"""Line of known speed that never answers; the clock here paces its frames."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod

from .errors import BoardError
from .transport import before_what_computes

#: Bits that a serial line takes for a byte: a start bit, eight bits, a stop bit.
BITS = 10

#: Long frames, such as those of a chain of boards: less than one is in the line when the next one comes, by
#: this time, in s.
MOST_AHEAD = 0.025

#: Below this frequency, in Hz, on and off are sent as frames.
LEAST_HZ = 0.05

#: Largest part of a line's time for swaps.
MOST_SWAPS = 0.2

#: A modulation delayed by more than this, in s, does not catch up.
DELAYED = 0.1


class LineTransport(ABC):
    """Paces frames and modulates by swaps; a subclass has the line itself.

    Parameters
    ----------
    baud
        Bits a second; a byte takes 10.
    silence
        Hexadecimal, the bytes that make the device silent from any state.
    off
        Hexadecimal, a frame that plays nothing.
    swap
        Hexadecimal, the byte by which a device of two banks plays the other one; None for one bank.
    """

    def __init__(self, *, baud: int, silence: str, off: str, swap: str | None = None) -> None:
        self._byte = BITS / baud
        self._silence = bytes.fromhex(silence)
        self._off = bytes.fromhex(off)
        self._swap = None if swap is None else bytes.fromhex(swap)
        self._free = 0.0
        self._hz: float | None = None
        self._frame: bytes | None = None
        self._lock = threading.Lock()
        self._swinging = threading.Event()
        self._failed: BoardError | None = None

    @abstractmethod
    def _write(self, content: bytes) -> None:
        """Write bytes to the line."""

    def play(self, frame: bytes) -> None:
        """Wait until at most one frame is still in the line, then write this one."""
        with self._lock:
            self._steady()
            self._frame = frame
            self._begin()

    def modulate(self, hz: float | None) -> None:
        """Swap the banks, one with the frame and one that is off, 2 hz times a second."""
        most = MOST_SWAPS / (2 * self._byte)
        if hz is not None and not LEAST_HZ <= hz <= most:
            raise BoardError(
                f"modulate is given {hz:g} Hz: give {LEAST_HZ:g} to {most:.4g}, for the line's sake"
            )
        with self._lock:
            self._steady()
            swapped, self._hz = self._hz is not None, hz
            if self._frame is not None:
                self._begin(loaded=not swapped)
            self._drain()

    def silence(self) -> None:
        """Turn everything off, after the bytes that are already in the line."""
        with self._lock:
            self._swinging.set()
            self._failed = self._frame = None
            self._give(self._silence)

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Raise BoardError: such boards store one frame."""
        raise BoardError("this board holds no sequence: use stream")

    @abstractmethod
    def look(self) -> None:
        """Raise BoardLost if the line is known to be gone."""

    @abstractmethod
    def close(self) -> None:
        """Release the line. Never raises, never hangs."""

    def _begin(self, *, loaded: bool = False) -> None:
        """Play the frame, unless it plays already, and swap from then on if it is modulated."""
        assert self._frame is not None
        if not loaded:
            self._pace(self._frame)
        if self._hz is None:
            return
        self._pace(self._off)
        self._swinging = threading.Event()
        begin = max(self._free, time.monotonic())
        threading.Thread(
            target=self._swing, args=(self._swinging, begin, 0.5 / self._hz), daemon=True
        ).start()

    def _pace(self, frame: bytes) -> None:
        ahead = min(len(frame) * self._byte, MOST_AHEAD)
        time.sleep(max(0.0, self._free - time.monotonic() - ahead))
        self._give(frame)

    def _give(self, content: bytes) -> None:
        self._write(content)
        self._free = max(self._free, time.monotonic()) + len(content) * self._byte

    def _swing(self, stopped: threading.Event, begin: float, half: float) -> None:
        """Swap every half period after `begin`, until stopped."""
        assert self._swap is not None
        before_what_computes()
        count = 1
        while not stopped.wait(max(0.0, begin + count * half - time.monotonic())):
            with self._lock:
                if stopped.is_set():
                    return
                try:
                    self._write(self._swap)
                except BoardError as error:
                    self._failed = error
                    return
            count += 1
            late = time.monotonic() - begin - count * half
            if late > DELAYED:
                # Pairs of swaps change nothing, so the playing bank stays the same.
                count += 2 * int(late / (2 * half))

    def _steady(self) -> None:
        """Stop swapping, and raise an error that occurred meanwhile."""
        self._swinging.set()
        if self._failed is not None:
            failed, self._failed = self._failed, None
            raise failed

    def _stop(self) -> None:
        """Prevent further swaps."""
        with self._lock:
            self._swinging.set()

    def _drain(self) -> None:
        """Wait until the line has carried all its bytes."""
        time.sleep(max(0.0, self._free - time.monotonic()))
