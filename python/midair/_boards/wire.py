"""Messages between a program and the guard process of its board, over two pipes.

A message consists of its kind, a number that its answer repeats, the length of its content, and the content.
"""

import os
import struct
from enum import IntEnum


class Kind(IntEnum):
    """Kind of a message: a request or an answer."""

    OPEN = 1  # JSON: the transport's description, and hold in s
    PLAY = 2  # due time (monotonic clock, s; 0: now), latest time, treatment if late; then the frame
    OFF = 3
    MODULATE = 4  # Hz, NaN for no modulation; then codes of 0 to 255, if any, instead of a sine
    UPLOAD = 5  # count and rate; then the frames
    STATUS = 6
    EMITTING = 7
    HOLD = 8  # no content: the owner lives and waits for an answer
    CLOSE = 9
    BEAT = 10  # no content: the owner's interpreter runs; the guard answers with DONE without content
    DONE = 16  # JSON: the guard's status
    FAILED = 17  # JSON: status, and the kind and text of the error
    FRAME = 18  # the frame that plays now, empty if none does


HEADER = struct.Struct("<BQI")
WHEN = struct.Struct("<ddB")
MODULATION = struct.Struct("<d")
UPLOADED = struct.Struct("<Id")

#: Time in s between two beats of an owner; and the time without beats after which everything is turned off.
BEATS = 0.05
MISSED = 0.6

#: Error message for a late frame; the number is its delay in ms.
LATE = "a frame of the stream is {:.3g} ms late: give a lower rate"


class Late(IntEnum):
    """Treatment of a late frame: play it late (WAIT), skip it if the next frame is due, or raise an error."""

    WAIT = 0
    SKIP = 1
    ERROR = 2


class Gone(Exception):
    """Raised if the other end of the pipe is closed."""


def write(pipe: int, kind: Kind, number: int, content: bytes = b"") -> None:
    """Write a complete message."""
    rest = memoryview(HEADER.pack(kind, number, len(content)) + content)
    while rest:
        try:
            rest = rest[os.write(pipe, rest) :]
        except OSError as error:
            raise Gone from error


def read(pipe: int) -> tuple[Kind, int, bytes]:
    """Wait for a complete message; return its kind, number and content."""
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
