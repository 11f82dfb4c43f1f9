"""OSC datagrams: sizes and nesting of bundles are checked here, before the OSC library reads a message."""

import struct
import time
from typing import Any

from pythonosc.osc_message import OscMessage, ParseError
from pythonosc.osc_message_builder import OscMessageBuilder

from .._midair import SceneError, stated

#: Beginning of a bundle; length in bytes of its head, which ends with a time tag, and of a size.
BUNDLE, HEAD, SIZE = b"#bundle\0", 16, 4

#: Largest number of bundles inside one another.
MOST_NESTED = 8

#: Time in s from 1900, when time tags begin, to 1970; and by which the sender's clock may be ahead.
EPOCH, AHEAD = 2_208_988_800, 0.05


def messages(part: bytes, levels: int = MOST_NESTED, tag: int = 0) -> list[tuple[bytes, int]]:
    """Return the messages of a datagram or of a part of it, each with the time tag of its bundle.

    Raises SceneError if it is damaged.
    """
    if not part.startswith(BUNDLE):
        return [(part, tag)]
    tag = int.from_bytes(part[len(BUNDLE) : HEAD], "big")
    found, at = [], HEAD
    while at < len(part):
        size = int.from_bytes(part[at : at + SIZE], "big", signed=True)
        at += SIZE
        if not levels or not 0 < size <= len(part) - at:
            raise _damaged()
        found += messages(part[at : at + size], levels - 1, tag)
        at += size
    return found


def _damaged() -> SceneError:
    cure = f"give OSC 1.0, with {MOST_NESTED} bundles inside one another at most"
    return stated("datagram", "is damaged", cure, code="unreadable")


def read(message: bytes, tag: int) -> tuple[str, list[Any]]:
    """Return the name of a message and its arguments, of which the first is empty if there is none.

    Raises SceneError if it is damaged, or for a time that has not come.
    """
    if (ahead := tag / 2**32 - EPOCH - time.time()) > AHEAD:
        raise stated("bundle", f"is for a time in {ahead:.3g} s", "send it at that time")
    try:
        found = OscMessage(message)
    except (ParseError, ValueError, struct.error) as error:
        raise _damaged() from error
    return found.address.removeprefix("/midair/"), found.params or [""]


def written(name: str, values: dict[str, Any]) -> bytes:
    """Return a message with these values; None becomes an empty text."""
    built = OscMessageBuilder(f"/midair/{name}")
    for value in values.values():
        built.add_arg("" if value is None else value)
    return built.build().dgram
