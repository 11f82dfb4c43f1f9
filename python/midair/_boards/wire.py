"""Messages between a program and the guard of its board, over two pipes.

A message is its kind, a number that its answer repeats, the length of its content, and the content.
"""

from __future__ import annotations

import os
import struct
from enum import IntEnum


class Kind(IntEnum):
    """Kind of a message: a request or an answer."""

    OPEN = 1  # JSON: the transport's description, and hold in s
    PLAY = 2  # time, by the monotonic clock in s (0: now), the latest time, the treatment then; and the frame
    OFF = 3
    MODULATE = 4  # hz, NaN for no modulation; and codes of 0 to 255, if any, in place of a sine
    UPLOAD = 5  # count and rate, and the frames
    STATUS = 6
    EMITTING = 7
    HOLD = 8  # nothing: the owner lives and waits for an answer
    CLOSE = 9
    BEAT = 10  # nothing: the owner's interpreter answers; so does the guard's, by DONE without content
    DONE = 16  # JSON: the guard's status
    FAILED = 17  # JSON: status, and the error's kind and message
    FRAME = 18  # the frame that plays now; empty if none plays


HEADER = struct.Struct("<BQI")
WHEN = struct.Struct("<ddB")
MODULATION = struct.Struct("<d")
UPLOADED = struct.Struct("<Id")

#: Time between two beats of an owner, in s, and the time after which missing beats turn everything off.
BEATS = 0.05
MISSED = 0.6

#: Message for a frame that is late, by ms, if that is an error.
LATE = "a frame of the stream is {:.3g} ms late: give a lower rate"


class Late(IntEnum):
    """Treatment of a late frame: wait, skip it if the next is due, or an error."""

    WAIT = 0
    SKIP = 1
    ERROR = 2


class Gone(Exception):
    """The other end of the pipe is closed."""


def write(pipe: int, kind: Kind, number: int, content: bytes = b"") -> None:
    """Write a whole message."""
    rest = memoryview(HEADER.pack(kind, number, len(content)) + content)
    while rest:
        try:
            rest = rest[os.write(pipe, rest) :]
        except OSError as error:
            raise Gone from error


def read(pipe: int) -> tuple[Kind, int, bytes]:
    """Wait for a message and read all of it."""
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
