"""OSC datagrams: sizes, nesting and the token are checked here, before the OSC library reads a message."""

from __future__ import annotations

import hmac
import struct
import time
from typing import Any

from pythonosc.osc_message import OscMessage, ParseError
from pythonosc.osc_message_builder import OscMessageBuilder

from .._midair import stated

BUNDLE = b"#bundle\0"
_HEAD, _SIZE = struct.Struct(">8sQ"), struct.Struct(">i")

#: Largest number of bundles inside one another.
MOST_NESTED = 8

#: Time tag for "immediately"; seconds from 1900, when time tags begin, to 1970; time in s by which the
#: sender's clock may be ahead.
IMMEDIATELY, EPOCH, AHEAD = 1, 2_208_988_800, 0.05


class Datagram:
    """Messages of a datagram whose first argument is the token; none of a damaged datagram.

    Attributes
    ----------
    messages
        The messages, not yet read.
    ahead
        How far in the future the latest time tag of its bundles is, in s.
    """

    def __init__(self, content: bytes, token: str) -> None:
        self.messages: list[bytes] = []
        self.ahead = 0.0
        key, waiting = token.encode(), [(content, 0)]
        while waiting:
            part, depth = waiting.pop()
            if part.startswith(BUNDLE):
                inner = self._parts(part) if depth < MOST_NESTED else None
                if inner is None:
                    self.messages = []
                    return
                waiting += [(each, depth + 1) for each in reversed(inner)]
            elif hmac.compare_digest(_first(part), key):
                self.messages.append(part)

    def refuse_future(self) -> None:
        """Raise SceneError if a bundle is for a time that has not come."""
        if self.ahead > AHEAD:
            raise stated("bundle", f"is for a time in {self.ahead:.3g} s", "send it at that time")

    def _parts(self, bundle: bytes) -> list[bytes] | None:
        """Return the parts of a bundle, None if it is damaged."""
        if len(bundle) < _HEAD.size:
            return None
        _, tag = _HEAD.unpack_from(bundle)
        if tag != IMMEDIATELY:
            self.ahead = max(self.ahead, tag / 2**32 - EPOCH - time.time())
        at, parts = _HEAD.size, []
        while at < len(bundle):
            if len(bundle) - at < _SIZE.size:
                return None
            (size,) = _SIZE.unpack_from(bundle, at)
            at += _SIZE.size
            if not 0 < size <= len(bundle) - at:
                return None
            parts.append(bundle[at : at + size])
            at += size
        return parts


def _first(message: bytes) -> bytes:
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


def read(message: bytes) -> tuple[str, list[Any]]:
    """Return the name and the arguments after the token of a message.

    Raises SceneError for a damaged one.
    """
    try:
        found = OscMessage(message)
    except (ParseError, ValueError, struct.error) as error:
        raise stated("message", "is damaged", "give OSC 1.0", code="unreadable") from error
    return found.address.removeprefix("/midair/"), found.params[1:]


def written(name: str, values: dict[str, Any]) -> bytes:
    """Return a message with these values; None becomes an empty text."""
    built = OscMessageBuilder(f"/midair/{name}")
    for value in values.values():
        built.add_arg("" if value is None else value)
    return built.build().dgram
