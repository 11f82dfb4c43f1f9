"""OSC datagrams: sizes, nesting and the token are checked here, before the OSC library reads a message."""

from __future__ import annotations

import struct
import time
from typing import Any

from pythonosc.osc_message import OscMessage, ParseError
from pythonosc.osc_message_builder import OscMessageBuilder

from .._midair import SceneError

BUNDLE = b"#bundle\0"
_TAG, _SIZE = struct.Struct(">Q"), struct.Struct(">i")

#: Largest number of bundles inside one another.
MOST_NESTED = 8

#: Time in s from 1900, when time tags begin, to 1970; and by which the sender's clock may be ahead.
EPOCH, AHEAD = 2_208_988_800, 0.05


def messages(part: bytes, levels: int = MOST_NESTED, tag: int = 0) -> list[tuple[bytes, int]]:
    """Return the messages of a datagram or of a part of it, each with the time tag of its bundle.

    Raises ValueError or struct.error if it is damaged.
    """
    if not part.startswith(BUNDLE):
        return [(part, tag)]
    (tag,) = _TAG.unpack_from(part, len(BUNDLE))
    found, at = [], len(BUNDLE) + _TAG.size
    while at < len(part):
        (size,) = _SIZE.unpack_from(part, at)
        at += _SIZE.size
        if not 0 < size <= len(part) - at or not levels:
            raise ValueError("size or depth")
        found += messages(part[at : at + size], levels - 1, tag)
        at += size
    return found


def first(message: bytes) -> bytes:
    """Return the first argument of a message if it is text, else nothing."""
    tags = _after(message, 0)
    values = _after(message, tags)
    if message[:1] != b"/" or message[tags : tags + 2] != b",s":
        return b""
    return message[values:].partition(b"\0")[0]


def _after(message: bytes, at: int) -> int:
    """Return where the text that begins at a place ends, with its padding to 4 bytes."""
    end = message.find(b"\0", at)
    return len(message) if end < 0 else end // 4 * 4 + 4


def read(message: bytes, tag: int) -> tuple[str, list[Any]]:
    """Return the name of a message and its arguments after the token.

    Raises SceneError if it is damaged, or for a time that has not come.
    """
    if (ahead := tag / 2**32 - EPOCH - time.time()) > AHEAD:
        raise SceneError(f"bundle is for a time in {ahead:.3g} s: send it at that time")
    try:
        found = OscMessage(message)
    except (ParseError, ValueError, struct.error) as error:
        raise SceneError("message is damaged: give OSC 1.0") from error
    return found.address.removeprefix("/midair/"), found.params[1:]


def written(name: str, values: dict[str, Any]) -> bytes:
    """Return a message with these values; None becomes an empty text."""
    built = OscMessageBuilder(f"/midair/{name}")
    for value in values.values():
        built.add_arg("" if value is None else value)
    return built.build().dgram
