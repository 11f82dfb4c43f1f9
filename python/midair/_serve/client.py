"""WebSocket connections: their number, sizes, rates and backlogs are bounded, before the token and after."""

from __future__ import annotations

import asyncio
import math
import time
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from websockets.asyncio.connection import broadcast
from websockets.asyncio.server import ServerConnection

#: Largest number of clients, and of strangers. The library bounds a stranger's request: 128 lines of 8 kB.
MOST_CLIENTS, MOST_STRANGERS = 64, 64

#: Largest number of messages in a second, and of bytes that a client leaves unread.
MOST_RATE, MOST_UNREAD = 4000, 1 << 20


@dataclass
class Crowd:
    """The open connections: strangers, the oldest first, and clients, which have shown the token."""

    strangers: dict[Client, None] = field(default_factory=dict)
    clients: set[Client] = field(default_factory=set)


class Client(ServerConnection):
    """A connection.

    Attributes
    ----------
    arrived
        When its last bytes came, by `time.monotonic`.
    """

    def __init__(self, crowd: Crowd, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._crowd = crowd
        self._room = float(MOST_RATE)
        self.arrived = -math.inf

    def admit(self) -> bool:
        """Make this stranger a client; return False if there are too many clients."""
        if len(self._crowd.clients) >= MOST_CLIENTS:
            return False
        self._crowd.strangers.pop(self, None)
        self._crowd.clients.add(self)
        return True

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Join the strangers; end the connection of the oldest one if there are too many."""
        super().connection_made(transport)
        strangers = self._crowd.strangers
        strangers[self] = None
        if len(strangers) > MOST_STRANGERS:
            oldest = next(iter(strangers))
            del strangers[oldest]
            oldest.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Leave the crowd."""
        self._crowd.strangers.pop(self, None)
        self._crowd.clients.discard(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Note the time."""
        now = time.monotonic()
        self._room = min(MOST_RATE, self._room + MOST_RATE * (now - self.arrived))
        self.arrived = now
        super().data_received(data)

    def counts(self) -> bool:
        """Count a message; return False if there were too many in a second."""
        self._room -= 1
        return self._room >= 0

    def say(self, text: str) -> None:
        """Send a message from any thread, without waiting. End the connection of a client that reads none."""
        # The loop may have ended.
        with suppress(RuntimeError):
            self.loop.call_soon_threadsafe(self._say, text)

    def _say(self, text: str) -> None:
        if self.transport.get_write_buffer_size() > MOST_UNREAD:
            self.transport.abort()
        else:
            broadcast([self], text)
