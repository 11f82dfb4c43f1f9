"""Transport: sends frames to a device, in the guard process. `open_transport` makes transports of all kinds.

This module imports neither midair itself nor NumPy, so a guard starts within a few hundredths of a second.
"""

import os
from contextlib import suppress
from importlib import import_module
from typing import Any, Protocol

from .errors import BoardError


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
