"""WebSocket and OSC (UDP) server by which other programs on this machine play points on a board.

docs/serve.md lists the messages. The path /adaptics has the protocol of Adaptics Engine. A client needs the
token. Web pages of other origins are refused, unless `origins` names them.

One thread has both ports. It only reads and writes, so each message is a sign of life at the time at which it
arrives. A second thread executes the messages, because some of them wait for the board.
"""

import asyncio
import hmac
import json
import logging
import re
import secrets
import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Hashable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, suppress
from functools import partial
from http import HTTPStatus
from typing import Any, cast
from urllib.parse import parse_qs, urlsplit

from websockets.asyncio.server import serve
from websockets.exceptions import ConnectionClosed

from .._boards.errors import BoardError
from .._boards.transport import before_what_computes
from .._midair import SceneError, stated
from .._support.arguments import refused, warnings_to
from . import osc
from .adaptics import Page, Player
from .live import Live
from .messages import Client, Talk, obey_osc

#: Largest size in bytes of a message, and of a pattern of Adaptics.
MOST_BYTES, MOST_PATTERN = 1 << 16, 1 << 20

#: Largest numbers of clients and of strangers; end of the head of a request, and its largest size in bytes.
MOST_CLIENTS, MOST_STRANGERS = 64, 64
END, MOST_HEAD = b"\r\n\r\n", 1 << 15

#: Largest number of messages of a client that wait to be executed.
MOST_WAITING = 4000

#: Time in s that a client has to show the token, and that it has to answer when its connection is closed.
OPENING, CLOSING = 2.0, 1.0

#: Bytes of a client that may wait in the system's buffer, unseen by this program.
RECEIVED = 1 << 16

#: What browsers send as the origin of a page.
ORIGIN = re.compile(r"[a-z][a-z0-9+.-]*://[^\s/?#@*]+", re.IGNORECASE)

#: Tokens that a user may choose.
TOKEN = re.compile(r"[\w-]{16,}", re.ASCII)

#: Strangers must not fill the terminal, so the library logs nothing.
SILENT = logging.Logger("midair.serve", logging.CRITICAL + 1)


class Stranger(asyncio.Protocol):
    """A connection that has not shown the token.

    The library would need three times as long for it, and leave garbage whose collection stops the frames.
    """

    def __init__(self, loop: "Loop", client: Callable[[], asyncio.Protocol]) -> None:
        self._loop, self._client = loop, client
        self._head = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Join the strangers; end the connection of the oldest one if there are too many."""
        self._transport = cast(asyncio.Transport, transport)
        strangers = self._loop.strangers
        strangers[self] = self._loop.call_later(OPENING, self.end)
        if len(strangers) > MOST_STRANGERS:
            next(iter(strangers)).end()

    def connection_lost(self, exc: Exception | None) -> None:
        """Leave the strangers."""
        if limit := self._loop.strangers.pop(self, None):
            limit.cancel()

    def end(self) -> None:
        """End the connection."""
        self.connection_lost(None)
        self._transport.abort()

    def data_received(self, data: bytes) -> None:
        """Answer, or become a client, when the head of a request has come."""
        self._head += data
        if END not in self._head[-len(data) - len(END) :] and len(self._head) <= MOST_HEAD:
            return
        if answer := self._loop.admit(self._head):
            self._transport.write(answer)
            self._transport.close()
            return
        self.connection_lost(None)
        client = self._client()
        self._transport.set_protocol(client)
        client.connection_made(self._transport)
        client.data_received(self._head)


class Loop(asyncio.SelectorEventLoop):
    """Event loop whose server's connections are strangers at first.

    `admit` returns the answer to a head, empty for a client.
    """

    def __init__(self, admit: Callable[[bytes], bytes]) -> None:
        super().__init__()
        self.admit = admit
        self.strangers: dict[Stranger, asyncio.TimerHandle] = {}

    async def create_server(  # type: ignore[override]  # its only caller gives a factory first
        self, factory: Any, *arguments: Any, **options: Any
    ) -> Any:
        """Listen; `factory` makes clients."""
        return await super().create_server(partial(Stranger, self, factory), *arguments, **options)


class PointServer(AbstractContextManager["PointServer"]):
    """Server that plays clients' messages on a board until it is closed.

    Parameters
    ----------
    live
        What plays. `close` closes it.
    port, osc_port
        Ports of 127.0.0.1 for WebSocket and for OSC; 0 chooses free ones.
    origins
        Origins of web pages that may connect, such as "http://localhost:8000".
    token
        The token; by default a random one.

    Raises
    ------
    SceneError
        If a port is not available, for what is no origin, and for a token that is easy to guess.
    """

    def __init__(
        self, live: Live, port: int = 0, osc_port: int = 0, origins: Iterable[str] = (), token: str = ""
    ) -> None:
        if token and not TOKEN.fullmatch(token):
            raise refused("token", token, "give at least 16 of A to Z, a to z, 0 to 9, - and _")
        self._live = live
        self._origins = [None, *map(_origin, origins)]
        self._player = Player(live)
        self._tcp, self._udp = _bound(port, osc_port)
        self.port, self.osc = (each.getsockname()[1] for each in (self._tcp, self._udp))
        self.token = token or secrets.token_urlsafe(16)
        live.warned = self._warn
        self._clients: set[Client] = set()
        #: Executes messages, and how many of each source wait.
        self._work = ThreadPoolExecutor(1, initializer=before_what_computes)
        self._waiting: Counter[Hashable] = Counter()
        self._loop = Loop(self._admit)
        self._over = asyncio.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """URL for WebSocket clients, with the token."""
        return f"ws://127.0.0.1:{self.port}/?token={self.token}"

    @property
    def adaptics(self) -> str:
        """URL for Adaptics Designer, with the token."""
        return f"ws://127.0.0.1:{self.port}/adaptics?token={self.token}"

    def close(self) -> None:
        """Turn the board off and close both ports."""
        self._live.close()
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._over.set)
        self._thread.join(2 * CLOSING)
        self._work.shutdown(wait=False, cancel_futures=True)

    def __exit__(self, *_: object) -> None:
        self.close()

    def _run(self) -> None:
        before_what_computes()
        self._loop.set_exception_handler(_reported)
        self._loop.run_until_complete(self._serve())
        self._loop.close()

    async def _serve(self) -> None:
        """Serve both ports until `close` is called."""
        self._loop.add_reader(self._udp, self._hear)
        async with serve(
            self._attend,  # type: ignore[arg-type]  # its clients are of the class below
            sock=self._tcp,
            origins=self._origins,  # type: ignore[arg-type]  # None: programs that are no web pages
            create_connection=partial(Client, self._clients),  # type: ignore[arg-type]
            max_size=MOST_PATTERN,
            compression=None,
            open_timeout=OPENING,
            close_timeout=CLOSING,
            server_header=None,
            logger=SILENT,
        ):
            await self._over.wait()
            for each in tuple(self._loop.strangers):
                each.end()
        self._loop.remove_reader(self._udp)
        self._udp.close()

    def _admit(self, head: bytes) -> bytes:
        """Return the answer to the head of a stranger's request; empty for a new client."""
        shown, path = "", head.partition(b"\r\n")[0].split(b" ")[1:2]
        if path and self.token.encode() in path[0]:
            with suppress(ValueError):
                shown = parse_qs(urlsplit(path[0].decode()).query).get("token", [""])[0]
        if not self._knows(shown):
            return _refusal(HTTPStatus.FORBIDDEN, "the token that midair serve printed is missing")
        if len(self._clients) >= MOST_CLIENTS:
            return _refusal(HTTPStatus.SERVICE_UNAVAILABLE, "there are too many clients")
        return b""

    async def _attend(self, client: Client) -> None:
        """Take a client's messages until it leaves."""
        adaptics = _of_adaptics(client)
        talk = Page(client, self._player) if adaptics else Talk(client, self._live)
        most = MOST_PATTERN if adaptics else MOST_BYTES
        code, reason = 1000, ""
        reports = self._loop.create_task(talk.report())
        try:
            async for message in client:
                if len(message) > most:
                    code, reason = 1009, "message is too big"
                    break
                if not self._take(client, client.arrived, talk.obey, message, client.arrived):
                    code, reason = 1008, "too many messages wait: send fewer"
                    break
        except ConnectionClosed:
            pass
        finally:
            with self._live.life() as life:
                life.leave(client)
            reports.cancel()
            await asyncio.gather(reports, return_exceptions=True)
        await client.close(code, reason)

    def _hear(self) -> None:
        """Take an OSC datagram; a damaged one, one without the token and one too many is dropped."""
        # Windows raises an OSError here if an earlier answer found no reader.
        with suppress(OSError, SceneError):
            content, sender = self._udp.recvfrom(MOST_BYTES)
            if self.token.encode() in content:
                parts = osc.messages(content)
                self._take(sender, time.monotonic(), self._obey_osc, parts, sender, count=len(parts))

    def _knows(self, shown: Any) -> bool:
        """Return whether this is the token."""
        return isinstance(shown, str) and hmac.compare_digest(shown.encode(), self.token.encode())

    def _take(self, source: Hashable, at: float, obey: Callable[..., None], *arguments: Any, count: int = 1) -> bool:
        """Note a sign of life, and let messages be executed; return False if too many of a source wait."""
        with self._live.life() as life:
            life.sign(source, at)
            if self._waiting[source] + count > MOST_WAITING:
                life.leave(source)
                return False
        self._waiting[source] += count
        executed = self._loop.run_in_executor(self._work, obey, *arguments)
        executed.add_done_callback(lambda _: self._forget(source, count))
        return True

    def _forget(self, source: Hashable, count: int) -> None:
        self._waiting[source] -= count
        if not self._waiting[source]:
            del self._waiting[source]

    def _warn(self, source: Hashable, text: str) -> None:
        """Send a warning to the program whose message caused it. The protocol of Adaptics has no warnings."""
        if isinstance(source, tuple):
            with suppress(OSError):
                self._udp.sendto(osc.written("warning", {"warning": text}), source)
        elif isinstance(source, Client) and not _of_adaptics(source):
            source.say(json.dumps({"warning": text}))

    def _obey_osc(self, messages: list[tuple[bytes, int]], sender: Any) -> None:
        for message in messages:
            try:
                name, (token, *values) = osc.read(*message)
                with warnings_to(partial(self._live.note, sender)):
                    answer = obey_osc(self._live, sender, name, values) if self._knows(token) else {}
                name = name if name == "metrics" else "state"
            except (SceneError, BoardError) as error:
                answer, name = {"error": str(error)}, "error"
            if answer:
                with suppress(OSError):
                    self._udp.sendto(osc.written(name, answer), sender)


def _of_adaptics(client: Client) -> bool:
    """Return whether a client uses the protocol of Adaptics."""
    return client.request is not None and urlsplit(client.request.path).path == "/adaptics"


def _origin(given: str) -> str:
    """Check the origin of a web page, as browsers write it."""
    if not ORIGIN.fullmatch(given):
        raise refused("origin", given, "give SCHEME://HOST:PORT, such as http://localhost:8000")
    return given


def _refusal(status: HTTPStatus, text: str) -> bytes:
    """Return an answer by HTTP, after which the connection ends."""
    head = f"HTTP/1.1 {status.value} {status.phrase}\r\nConnection: close\r\nContent-Length: {len(text) + 1}"
    return f"{head}\r\nContent-Type: text/plain\r\n\r\n{text}\n".encode()


def _bound(port: int, osc_port: int) -> tuple[socket.socket, socket.socket]:
    """Return the sockets for WebSocket, which listens, and for OSC."""
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        udp.bind(("127.0.0.1", osc_port))
        tcp = socket.create_server(("127.0.0.1", port), backlog=128)
    except (OSError, OverflowError) as error:
        udp.close()
        cure = f"{error}; give another one, or 0 for a free one"
        raise stated("", f"port {port} or {osc_port}", cure) from error
    udp.setblocking(False)
    # Connections inherit it.
    tcp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVED)
    return tcp, udp


def _reported(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Log an error of the loop, but not that there are no files left for a new connection: it tries again."""
    if not isinstance(context.get("exception"), OSError):
        loop.default_exception_handler(context)
