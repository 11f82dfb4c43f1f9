"""Messages between a program and the guard of its board, over two pipes.

A message is its kind, a number that its answer repeats, the length of its content, and the content.
"""

from __future__ import annotations

import os
import struct
from enum import IntEnum


class Kind(IntEnum):
    """What a message asks for, or how it is answered."""

    OPEN = 1  # JSON: the transport's description, and hold in s
    PLAY = 2  # when, by the monotonic clock in s (0: now), the latest time, what then; and the frame
    OFF = 3
    MODULATE = 4  # hz, NaN for no modulation; and codes of 0 to 255, if any, in place of a sine
    UPLOAD = 5  # count and rate, and the frames
    STATUS = 6
    EMITTING = 7
    HOLD = 8  # nothing: the owner lives and waits for what it asked for
    CLOSE = 9
    BEAT = 10  # nothing: the owner's interpreter answers; so does the guard's, by DONE without content
    DONE = 16  # JSON: the guard's status
    FAILED = 17  # JSON: status, and the error's kind and message
    FRAME = 18  # the frame that plays now; empty where nothing does


HEADER = struct.Struct("<BQI")
WHEN = struct.Struct("<ddB")
MODULATION = struct.Struct("<d")
UPLOADED = struct.Struct("<Id")

#: How often an owner beats, in s, and for how long either may be missed before everything is turned off.
BEATS = 0.05
MISSED = 0.6

#: What a frame that is late, by ms, is told to be where that is an error.
LATE = "a frame of the stream is {:.3g} ms late: give a lower rate"


class Late(IntEnum):
    """What becomes of a frame that comes late: it waits, is skipped if the next is due, or is an error."""

    WAIT = 0
    SKIP = 1
    ERROR = 2


class Gone(Exception):
    """Nobody is at the other end."""


def write(pipe: int, kind: Kind, number: int, content: bytes = b"") -> None:
    """Write a message whole."""
    rest = memoryview(HEADER.pack(kind, number, len(content)) + content)
    while rest:
        try:
            rest = rest[os.write(pipe, rest) :]
        except OSError as error:
            raise Gone from error


def read(pipe: int) -> tuple[Kind, int, bytes]:
    """Wait for a message and read it whole."""
    kind, number, length = HEADER.unpack(_exactly(pipe, HEADER.size))
    return Kind(kind), number, _exactly(pipe, length)


def _exactly(pipe: int, length: int) -> bytes:
    found = bytearray()
    while len(found) < length:
        try:
            more = os.read(pipe, length - len(found))
        except OSError as error:
            raise Gone from error
        if not more:
            raise Gone
        found += more
    return bytes(found)
