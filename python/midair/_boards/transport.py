"""Transport: what carries frames to a device, in the guard process; and the one place where each is made.

Nothing here imports midair itself or NumPy: a guard starts in a few hundredths of a second.
"""

from __future__ import annotations

import os
from contextlib import suppress
from importlib import import_module
from typing import Any, Protocol


class Transport(Protocol):
    """A device that takes frames. Every method but `close` raises `BoardError` or one of its kinds."""

    def play(self, frame: bytes) -> None:
        """Send a frame; returns when the line has taken it. At most two frames wait in the line."""

    def silence(self) -> None:
        """Turn everything off, now; at any time, more than once."""

    def modulate(self, wave: Any) -> None:
        """Modulate the amplitude of what plays, and of what will, at a frequency in Hz; None for not at all.

        A device that holds sequences takes codes of 0 to 255, too.
        """

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Let the device play `count` frames at `rate` a second by itself, over and over."""

    def look(self) -> None:
        """Raise BoardLost where the device is known to be gone, without sending it anything."""

    def close(self) -> None:
        """Let go of the device. Never raises, never hangs."""


def before_what_computes() -> None:
    """Let this thread, which keeps time, run before those that compute, where the system allows it."""
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))


#: The module and class of each kind of transport; the class takes the rest of a description as keywords.
TRANSPORTS = {
    "serial": ("serial_port", "SerialTransport"),
    "fifo": ("fifo", "FifoTransport"),
    "udp": ("autd3", "Autd3Transport"),
    "null": ("simulated", "NullTransport"),
    "loop": ("simulated", "LoopTransport"),
    "file": ("simulated", "FileTransport"),
}

#: Those behind which nothing emits.
SIMULATED = ("null", "loop", "file")


def open_transport(description: dict[str, Any]) -> Transport:
    """The transport that a description, made of what JSON holds, tells of.

    {"kind": "serial", "port": ..., "baud": ..., ...} or {"kind": "udp", "address": ..., "boards": ...}:
    `kind` names the class, the other entries are its arguments. Opening it leaves the device silent.
    """
    given = dict(description)
    module, name = TRANSPORTS[given.pop("kind")]
    made: Transport = getattr(import_module(f"{__package__}.{module}"), name)(**given)
    return made
