"""WebSocket and OSC (UDP) server by which other programs on this machine play points on a board.

docs/serve.md lists the messages. The path /adaptics has the protocol of Adaptics Engine. A client needs the
token. Web pages of other origins are refused, unless `origins` names them. The board turns off if the client
sends nothing for 0.2 s or disconnects.
"""

from __future__ import annotations

import hmac
import json
import secrets
import socket
import threading
from collections.abc import Iterable
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path
from types import TracebackType
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
from numpy.typing import NDArray

from .._boards.errors import BoardError
from .._boards.transport import before_what_computes
from .._midair import SceneError
from .._motion import document
from .._support.arguments import json_object, number, real, refused
from .adaptics import Client, Player
from .live import SILENCE, Live

#: Largest size in bytes of a message, and of an Adaptics pattern; numbers per point in a binary message (x,
#: y, z, pressure).
MOST_BYTES, MOST_PATTERN, ROW = 1 << 16, 1 << 20, 4

#: Keys of a JSON message, of which a message needs at least one.
KEYS = ("points", "path", "modulation", "off", "keep", "state", "metrics")

#: Shortest time in s between two reports of the metrics.
LEAST_REPORT = 0.01

MISSING = 'serve needs websockets and python-osc: pip install "midair[serve]"'


class PointServer:
    """Server that plays clients' messages on a board until it is closed.

    Parameters
    ----------
    port, osc
        Ports of 127.0.0.1 for WebSocket and for OSC; 0 chooses free ones.
    origins
        Origins of web pages that may connect, such as "http://localhost:8000".

    Raises
    ------
    SceneError
        If a port is not available, or websockets or python-osc is not installed.
    """

    def __init__(self, live: Live, port: int = 0, osc: int = 0, origins: Iterable[str] = ()) -> None:
        try:
            from pythonosc.osc_packet import OscPacket
            from websockets.exceptions import ConnectionClosed
            from websockets.sync.server import serve
        except ImportError as error:
            raise SceneError(MISSING) from error
        self._live = live
        self._packet, self._closed = OscPacket, ConnectionClosed
        self._player = Player(live)
        self.token = secrets.token_urlsafe(16)
        self._udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._udp.bind(("127.0.0.1", osc))
            self._server = serve(
                self._serve,
                "127.0.0.1",
                port,
                origins=[None, *origins],  # type: ignore[list-item]  # None: programs that are no web pages
                process_request=self._admit,
                max_size=MOST_PATTERN,
                compression=None,
            )
        except (OSError, OverflowError) as error:
            self._udp.close()
            raise SceneError(
                f"port {port} or {osc}: {error}; give another one, or 0 for a free one"
            ) from error
        self.port = self._server.socket.getsockname()[1]
        self.osc = self._udp.getsockname()[1]
        for serves in (self._accept, self._listen):
            threading.Thread(target=serves, daemon=True).start()

    @property
    def address(self) -> str:
        """URL for WebSocket clients, with the token."""
        return f"ws://127.0.0.1:{self.port}/?token={self.token}"

    @property
    def adaptics(self) -> str:
        """URL for Adaptics Designer, with the token."""
        return f"ws://127.0.0.1:{self.port}/adaptics?token={self.token}"

    def close(self) -> None:
        """Close both ports and turn the board off."""
        self._server.shutdown()
        self._udp.close()
        self._live.close()

    def __enter__(self) -> PointServer:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def obey(self, message: str | bytes, reports: Reports | None = None) -> dict[str, Any]:
        """Execute a message and return the answer. `reports` sends the metrics repeatedly if requested."""
        live = self._live
        if isinstance(message, bytes):
            return self._rows(np.frombuffer(_whole(message), "<f4").astype(np.float64))
        wanted = _read(message)
        if "modulation" in wanted:
            wave = wanted["modulation"]
            if isinstance(wave, list):
                wave = real("modulation", wave, "give a frequency in Hz, or numbers from 0 to 1")
            live.connection.modulate(wave)
        if "points" in wanted:
            points = real("points", wanted["points"], "give (M, 3) in m")
            if points.ndim != 2 or points.shape[1] != 3 or not len(points):
                raise refused("points", wanted["points"], "give (M, 3) in m")
            pressures = wanted.get("pressures")
            live.place(points, None if pressures is None else real("pressures", pressures, "give (M,) in Pa"))
        elif "path" in wanted:
            live.follow(_path(wanted["path"]))
        elif "off" in wanted:
            live.off()
        live.keep()
        if "metrics" in wanted:
            every = wanted["metrics"]
            if reports is not None and not isinstance(every, bool):
                reports.every(number("metrics", every, least=0))
            return live.metrics()
        return live.state() if "state" in wanted else {}

    def _rows(self, values: NDArray[np.float64]) -> dict[str, Any]:
        """Play points and pressures (M, 4).

        No rows turn the board off. Pressures that are all 0 mean as loud as possible.
        """
        rows = values.reshape(-1, ROW)
        if not len(rows):
            self._live.off()
            return {}
        self._live.place(rows[:, :3], rows[:, 3] if rows[:, 3].any() else None)
        return {}

    def _admit(self, connection: Any, request: Any) -> Any:
        """Refuse a client without the token."""
        given = parse_qs(urlsplit(request.path).query).get("token", [""])[0]
        if hmac.compare_digest(given.encode(), self.token.encode()):
            return None
        return connection.respond(HTTPStatus.FORBIDDEN, "the token that midair serve printed is missing\n")

    def _accept(self) -> None:
        """Serve WebSocket clients. Their threads start from this thread and inherit its priority."""
        before_what_computes()
        self._server.serve_forever()

    def _serve(self, client: Any) -> None:
        with suppress(self._closed):
            if urlsplit(client.request.path).path == "/adaptics":
                Client(client, self._player, self._live).talk()
            else:
                self._talk(client)

    def _talk(self, client: Any) -> None:
        board = self._live.connection.board
        greeting = {"board": board.name, "transducers": len(board.array), "rate": self._live.rate}
        client.send(json.dumps({**greeting, "silence": SILENCE}))
        reports = Reports(client, self._live)
        try:
            for message in client:
                if len(message) > MOST_BYTES:
                    client.close(1009, "message is too big")
                    return
                try:
                    answer = self.obey(message, reports)
                except (SceneError, BoardError) as error:
                    answer = {"error": str(error)}
                if answer:
                    client.send(json.dumps(answer))
        finally:
            reports.every(0)
            with suppress(BoardError):
                self._live.off()

    def _listen(self) -> None:
        """Execute OSC datagrams whose first argument is the token; others are ignored."""
        before_what_computes()
        while True:
            try:
                data, sender = self._udp.recvfrom(MOST_BYTES)
            except OSError:
                if self._udp.fileno() < 0:
                    return
                continue
            try:
                messages = [each.message for each in self._packet(data).messages]
            # The parser raises errors of many kinds for a damaged datagram.
            except Exception:
                continue
            for message in messages:
                token, *values = message.params or [""]
                if isinstance(token, str) and hmac.compare_digest(token.encode(), self.token.encode()):
                    self._answer(sender, message.address, values)

    def _answer(self, sender: Any, address: str, values: list[Any]) -> None:
        from pythonosc.osc_message_builder import OscMessageBuilder

        try:
            name = address.removeprefix("/midair/")
            answer = self._by_osc(name, values)
            name = name if name == "metrics" else "state"
        except (SceneError, BoardError) as error:
            answer, name = {"error": str(error)}, "error"
        if answer:
            built = OscMessageBuilder(f"/midair/{name}")
            for value in answer.values():
                built.add_arg("" if value is None else value)
            with suppress(OSError):
                self._udp.sendto(built.build().dgram, sender)

    def _by_osc(self, name: str, values: list[Any]) -> dict[str, Any]:
        """Execute an OSC message: /points x y z ..., /rows x y z pressure ..., /modulation hz, ..."""
        if name in ("points", "rows"):
            numbers = real(name, values, "give numbers")
            width = 3 if name == "points" else ROW
            if numbers.ndim != 1 or not numbers.size or numbers.size % width:
                raise SceneError(f"{name} are {numbers.size} numbers: give {width} a point")
            rows = np.zeros((numbers.size // width, ROW))
            rows[:, :width] = numbers.reshape(-1, width)
            return self._rows(rows.ravel())
        if name == "modulation":
            return self.obey(json.dumps({name: number(name, values[0], least=0) or None if values else None}))
        answer = self.obey(json.dumps({name: True}))
        answer.pop("points", None)
        reached = answer.pop("pressures", [])
        return answer | {f"pressure {k}": pressure for k, pressure in enumerate(reached)}


class Reports:
    """Sends the metrics to a client at regular times."""

    def __init__(self, client: Any, live: Live) -> None:
        self._client = client
        self._live = live
        self._stop = threading.Event()

    def every(self, seconds: float) -> None:
        """Send the metrics every `seconds` s from now on; 0 stops."""
        self._stop.set()
        if seconds:
            self._stop = threading.Event()
            given = self._stop, max(seconds, LEAST_REPORT)
            threading.Thread(target=self._send, args=given, daemon=True).start()

    def _send(self, stop: threading.Event, seconds: float) -> None:
        # An error of any kind ends the reports: the client or the board is gone.
        with suppress(Exception):
            while not stop.wait(seconds):
                self._client.send(json.dumps(self._live.metrics()))


def _whole(message: bytes) -> bytes:
    if len(message) % (4 * ROW):
        raise SceneError(f"message is {len(message)} bytes long: give float32 x, y, z, pressure a point")
    return message


def _read(message: str) -> dict[str, Any]:
    """Parse a message: a JSON object with known keys and without NaN."""
    wanted = json_object("message", message, 'give an object such as {"points": [[0, 0, 0.15]]}')
    if not wanted.keys() & set(KEYS):
        raise SceneError(f"message has none of the keys {', '.join(KEYS)}")
    for key in wanted:
        if key not in (*KEYS, "pressures"):
            raise refused("key", key, f"give {', '.join(KEYS)} or pressures")
    return wanted


def _path(table: Any) -> Any:
    """Return the path of a table as in a scene file. Tables that name files are refused, for safety."""
    if not isinstance(table, dict) or table.get("kind") == "svg" or "file" in table:
        raise SceneError("path reads a file, or is no object: give a table as in [[motion.path]], but no svg")
    return document.path_of(dict(table), Path())
