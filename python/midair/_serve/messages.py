"""WebSocket clients, whose unread bytes are bounded, and their messages (docs/serve.md).

Each message is checked, executed on a `Live` and answered.
"""

import asyncio
import json
import math
import time
from collections.abc import Callable, Hashable
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from websockets.asyncio.connection import broadcast
from websockets.asyncio.server import ServerConnection

from .._boards.errors import BoardError
from .._midair import SceneError, numbers, stated
from .._support.arguments import json_object, number, refused, vectors, warnings_to
from ..path import Path
from .life import SILENCE
from .live import Live

#: Largest number of bytes that a client leaves unread.
MOST_UNREAD = 1 << 20

#: Numbers per point in a binary message: x, y, z, pressure.
ROW = 4

#: Shortest time in s between two reports of the metrics; and between two looks whether a client wants them.
LEAST_REPORT, IDLE = 0.01, 0.05

#: Keys of a JSON message, of which a message needs at least one.
KEYS = ("points", "path", "modulation", "off", "keep", "state", "metrics")


class Client(ServerConnection):
    """A connection that has shown the token.

    Attributes
    ----------
    arrived
        When its last bytes came, by `time.monotonic`.
    """

    def __init__(self, clients: "set[Client]", *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._clients = clients
        self.arrived = -math.inf

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Join the clients."""
        super().connection_made(transport)
        self._clients.add(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """Leave the clients."""
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


class Talk:
    """Executes the messages of a WebSocket client, and sends it the metrics as often as it asks for them."""

    def __init__(self, client: Client, live: Live) -> None:
        self._client = client
        self._live = live
        self._every = 0.0

    def obey(self, message: str | bytes, _: float) -> None:
        """Execute a message and answer."""
        try:
            with warnings_to(partial(self._live.note, self._client)):
                answer = obey(self._live, self._client, message, self._repeat)
        except (SceneError, BoardError) as error:
            answer = {"error": str(error)}
        if answer:
            self._client.say(json.dumps(answer))

    async def report(self) -> None:
        """Greet the client, then send the metrics as often as it requested."""
        board = self._live.connection.board
        greeting = {"board": board.name, "transducers": len(board.array), "rate": self._live.rate}
        self._client.say(json.dumps({**greeting, "silence": SILENCE}))
        while True:
            await asyncio.sleep(self._every or IDLE)
            if self._every:
                # In a thread, because the board answers in its own time.
                self._client.say(json.dumps(await asyncio.to_thread(self._live.metrics)))

    def _repeat(self, seconds: float) -> None:
        self._every = seconds and max(seconds, LEAST_REPORT)


def obey(
    live: Live, source: Hashable, message: str | bytes, repeat: Callable[[float], object] = lambda _: None
) -> dict[str, Any]:
    """Execute a message of a source and return the answer.

    `repeat` is called with the time in s after which the metrics are to be sent again and again; 0 ends it.
    """
    if isinstance(message, bytes):
        if len(message) % (4 * ROW):
            raise stated("message", f"is {len(message)} bytes long", "give float32 x, y, z, pressure a point")
        return _rows(live, source, np.frombuffer(message, "<f4").astype(np.float64))
    wanted = _read(message)
    if "modulation" in wanted:
        wave = wanted["modulation"]
        if isinstance(wave, list):
            wave = numbers("modulation", wave, [(-1,)], "give a frequency in Hz, or numbers from 0 to 1")
        live.modulate(wave)
    if "points" in wanted:
        points, pressures = vectors("points", wanted["points"], least=1), wanted.get("pressures")
        if pressures is not None:
            pressures = numbers("pressures", pressures, [(), (len(points),)], "give (M,) in Pa")
        live.place(source, points, pressures)
    elif "path" in wanted:
        live.follow(source, _path(wanted["path"]))
    elif "off" in wanted:
        live.off()
    if "metrics" in wanted:
        every = wanted["metrics"]
        if not isinstance(every, bool):
            repeat(number("metrics", every, least=0))
        return live.metrics()
    return live.state() if "state" in wanted else {}


def obey_osc(live: Live, source: Hashable, name: str, values: list[Any]) -> dict[str, Any]:
    """Execute an OSC message of a source: points x y z ..., rows x y z pressure ..., modulation hz, ..."""
    if name in ("points", "rows"):
        width = 3 if name == "points" else ROW
        given = numbers(name, values, [(-1,)], f"give {width} numbers a point")
        if given.size % width:
            raise stated(name, f"are {given.size} numbers", f"give {width} a point")
        rows = np.zeros((given.size // width, ROW))
        rows[:, :width] = given.reshape(-1, width)
        return _rows(live, source, rows.ravel())
    if name == "modulation":
        hz = number(name, values[0], least=0) or None if values else None
        return obey(live, source, json.dumps({name: hz}))
    answer = obey(live, source, json.dumps({name: True}))
    answer.pop("points", None)
    reached = answer.pop("pressures", [])
    return answer | {f"pressure {k}": pressure for k, pressure in enumerate(reached)}


def _rows(live: Live, source: Hashable, values: NDArray[np.float64]) -> dict[str, Any]:
    """Play points and pressures (M, 4).

    No rows turn the board off. Pressures that are all 0 mean as loud as possible.
    """
    rows = values.reshape(-1, ROW)
    if not len(rows):
        live.off()
        return {}
    live.place(source, rows[:, :3], rows[:, 3] if rows[:, 3].any() else None)
    return {}


def _read(message: str) -> dict[str, Any]:
    """Parse a message: a JSON object with known keys and without NaN."""
    wanted = json_object("message", message, 'give an object such as {"points": [[0, 0, 0.15]]}')
    if not wanted.keys() & set(KEYS):
        raise stated("message", f"has none of the keys {', '.join(KEYS)}", "", code="missing")
    for key in wanted:
        if key not in (*KEYS, "pressures"):
            raise refused("key", key, f"give {', '.join(KEYS)} or pressures")
    return wanted


def _path(table: Any) -> Any:
    """Return the path of a table as in a scene file. Tables that name files are refused, for safety."""
    if not isinstance(table, dict) or table.get("kind") == "svg" or "file" in table:
        cure = "give a table as in [[motion.path]], but no svg"
        raise stated("path", "reads a file, or is no object", cure)
    return Path._of(table)
