"""WebSocket connections: their number, sizes, rates and backlogs are bounded, before the token and after."""

from __future__ import annotations

import asyncio
import math
import time
from contextlib import suppress
from typing import Any

from websockets.asyncio.connection import broadcast
from websockets.asyncio.server import ServerConnection

#: Largest number of clients with the token, and of strangers without; bytes of a stranger's request.
MOST_CLIENTS, MOST_STRANGERS, MOST_REQUEST = 64, 64, 1 << 14

#: Largest number of messages in a second, and of bytes that a client leaves unread.
MOST_RATE, MOST_UNREAD = 4000, 1 << 20


class Crowd:
    """The open connections: strangers, the oldest first, and clients, which have shown the token."""

    def __init__(self) -> None:
        self.strangers: dict[Client, None] = {}
        self.clients: set[Client] = set()

    def enter(self, client: Client) -> None:
        """Add a stranger; end the connection of the oldest one if there are too many."""
        self.strangers[client] = None
        if len(self.strangers) > MOST_STRANGERS:
            oldest = next(iter(self.strangers))
            del self.strangers[oldest]
            oldest.transport.abort()

    def admit(self, client: Client) -> bool:
        """Make a stranger a client; return False if there are too many clients."""
        if len(self.clients) >= MOST_CLIENTS:
            return False
        self.strangers.pop(client, None)
        self.clients.add(client)
        return True

    def leave(self, client: Client) -> None:
        """Forget a connection that is closed."""
        self.strangers.pop(client, None)
        self.clients.discard(client)


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
        self._request = 0
        self._room = float(MOST_RATE)
        self.arrived = -math.inf

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Join the crowd."""
        super().connection_made(transport)
        self._crowd.enter(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """Leave the crowd."""
        self._crowd.leave(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Note the time; end the connection of a stranger whose request is too long."""
        now = time.monotonic()
        self._room = min(MOST_RATE, self._room + MOST_RATE * (now - self.arrived))
        self.arrived = now
        if self not in self._crowd.clients:
            self._request += len(data)
            if self._request > MOST_REQUEST:
                self.transport.abort()
                return
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
