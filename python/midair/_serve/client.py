"""WebSocket connections: their numbers and what they leave unread are bounded."""

from __future__ import annotations

import asyncio
import math
import time
from contextlib import suppress
from typing import Any

from websockets.asyncio.connection import broadcast
from websockets.asyncio.server import ServerConnection

#: Largest number of clients, and of strangers. The library bounds a stranger's request: 128 lines of 8 kB.
MOST_CLIENTS, MOST_STRANGERS = 64, 64

#: Largest number of bytes that a client leaves unread.
MOST_UNREAD = 1 << 20


class Client(ServerConnection):
    """A connection: a stranger's until it is admitted.

    Attributes
    ----------
    arrived
        When its last bytes came, by `time.monotonic`.
    """

    def __init__(
        self, strangers: dict[Client, None], clients: set[Client], *arguments: Any, **options: Any
    ) -> None:
        super().__init__(*arguments, **options)
        self._strangers, self._clients = strangers, clients
        self.arrived = -math.inf

    def admit(self) -> bool:
        """Make this stranger a client; return False if there are too many clients."""
        if len(self._clients) >= MOST_CLIENTS:
            return False
        self._strangers.pop(self, None)
        self._clients.add(self)
        return True

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Join the strangers; end the connection of the oldest one if there are too many."""
        super().connection_made(transport)
        self._strangers[self] = None
        if len(self._strangers) > MOST_STRANGERS:
            oldest = next(iter(self._strangers))
            del self._strangers[oldest]
            oldest.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Leave the strangers or the clients."""
        self._strangers.pop(self, None)
        self._clients.discard(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Note the time."""
        self.arrived = time.monotonic()
        super().data_received(data)

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
