"""Transport: carries frames to a device, in the guard process; `open_transport` makes each kind.

Nothing here imports midair itself or NumPy: a guard starts in a few hundredths of a second.
"""

from __future__ import annotations

import os
from contextlib import suppress
from importlib import import_module
from typing import Any, Protocol


class Transport(Protocol):
    """A device that plays frames. Every method except `close` raises `BoardError` or a subclass."""

    def play(self, frame: bytes) -> None:
        """Send a frame; return when the line has accepted it. At most two frames wait in the line."""

    def silence(self) -> None:
        """Turn everything off now; at any time, and more than once."""

    def modulate(self, wave: Any) -> None:
        """Modulate the amplitude of all drives, now and later, at a frequency in Hz; None for no modulation.

        A device that stores sequences also accepts codes of 0 to 255.
        """

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Let the device repeat `count` frames at `rate` a second by itself."""

    def look(self) -> None:
        """Raise BoardLost if the device is known to be gone, without sending anything."""

    def close(self) -> None:
        """Release the device. Never raises, never hangs."""


def before_what_computes() -> None:
    """Let this thread, which keeps time, run before computing threads, if the system allows it."""
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))


#: Module and class of each kind of transport; the class takes the rest of a description as keywords.
TRANSPORTS = {
    "serial": ("serial_port", "SerialTransport"),
    "fifo": ("fifo", "FifoTransport"),
    "udp": ("autd3", "Autd3Transport"),
    "null": ("simulated", "NullTransport"),
    "loop": ("simulated", "LoopTransport"),
    "file": ("simulated", "FileTransport"),
}

#: Kinds behind which nothing emits.
SIMULATED = ("null", "loop", "file")


def open_transport(description: dict[str, Any]) -> Transport:
    """Make the transport of a description from JSON.

    {"kind": "serial", "port": ..., "baud": ..., ...} or {"kind": "udp", "address": ..., "boards": ...}:
    `kind` names the class, the other entries are its arguments. Opening it leaves the device silent.
    """
    given = dict(description)
    module, name = TRANSPORTS[given.pop("kind")]
    made: Transport = getattr(import_module(f"{__package__}.{module}"), name)(**given)
    return made
