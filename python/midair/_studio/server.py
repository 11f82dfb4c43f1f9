"""Web server for the studio page and for a board that it plays; only browsers on this machine have access."""

import json
import os
import re
import sys
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from socketserver import TCPServer
from typing import Any

import numpy as np

from .._boards.connection import Connection
from .._boards.errors import BoardError
from .._midair import SceneError, stated
from .view import BUILT, file

#: Content types by file ending. Browsers require them, because the header "nosniff" forbids guessing.
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".json": "application/json",
    ".wasm": "application/wasm",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".jpeg": "image/jpeg",
    ".bin": "application/octet-stream",
}

#: Content security policy: the page may load only its own files, and no other page may embed it.
POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; worker-src 'self' blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

#: Headers that isolate the page from other pages, so that these cannot read its files or use serial ports.
HEADERS = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "serial=(self)",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}

#: Host names of this machine. A request for another host name comes from a foreign page (DNS rebinding).
HERE = re.compile(r"(127\.0\.0\.1|localhost)(:\d+)?", re.IGNORECASE)


#: Time in s without a message from the page after which the board turns off. The page sends its drive again
#: before that.
HOLD = 1.0


class PagesBoard:
    """A connection that plays the page's newest drive; the board turns off without messages for HOLD s."""

    def __init__(self, connection: Connection, scene: str) -> None:
        self.connection = connection
        #: The array, by which the page checks whether its drives are for this board.
        self._array: dict[str, Any] = json.loads(scene)["array"]
        self._lock = threading.Lock()
        self._last = 0.0

    def described(self) -> bytes:
        """Return the board's name and array as JSON."""
        return json.dumps({"name": self.connection.board.name, "array": self._array}).encode()

    @property
    def most(self) -> int:
        """Bytes of a drive: re and im of each transducer, as float32."""
        return 8 * len(self.connection.board.array)

    def take(self, at: float, content: bytes) -> None:
        """Play a drive, or turn the board off if the content is empty.

        `at` is the time of the drive in ms. A drive older than the last one is ignored. Raises SceneError for
        a drive of another array, BoardError if the board is gone.
        """
        if content and len(content) != self.most:
            board, cure = self.connection.board.name, "choose the array that midair studio began with"
            reported = f"has {len(content) / 8:g} transducers, {board} has {self.most // 8}"
            raise stated("drive", reported, cure)
        with self._lock:
            if not at > self._last:
                return
            self._last = at
            if content:
                parts = np.frombuffer(content, "<f4").astype(np.float32)
                self.connection.send(parts.view(np.complex64))
            else:
                self.connection.off()


class Server(ThreadingHTTPServer):
    """Serves the page, a scene's JSON text at /scene.json, and a board at /board, until it is stopped.

    Parameters
    ----------
    port
        Port of 127.0.0.1; 0 chooses a free one. Raises SceneError if it is in use, or if the page was not
        built.
    """

    daemon_threads = True
    request_queue_size = 64
    # With this option, a second server on Windows would take a port that is in use.
    allow_reuse_address = os.name != "nt"

    def __init__(
        self, scene: str | None = None, port: int = 0, folder: Path = BUILT, board: PagesBoard | None = None
    ) -> None:
        file("index.html", folder)
        # All files that the server sends.
        files = (path for path in folder.rglob("*") if path.is_file())
        self.files = {f"/{path.relative_to(folder).as_posix()}": path for path in files}
        self.files["/"] = self.files["/index.html"]
        self.scene = scene
        self.board = board
        try:
            super().__init__(("127.0.0.1", port), Answer)
        except (OSError, OverflowError) as error:
            reason = error.strerror if isinstance(error, OSError) else "no port has this number"
            raise stated("port", f"is {port}", f"{reason}; leave it out, and a free one is taken") from error

    @property
    def address(self) -> str:
        """URL of the page, with a query for the scene and the board if there are any."""
        parts = [name for name, there in (("scene", self.scene), ("board", self.board)) if there is not None]
        return f"http://127.0.0.1:{self.server_port}/{'?' * bool(parts)}{'&'.join(parts)}"

    def server_bind(self) -> None:
        """Bind the port without looking up the machine's name as HTTPServer does; that can take seconds."""
        TCPServer.server_bind(self)
        self.server_name, self.server_port = "127.0.0.1", self.socket.getsockname()[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore errors of browsers that disconnect during an answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


class Answer(BaseHTTPRequestHandler):
    """Handles one request: a file, the scene, or a drive for the board."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "midair", ""
    #: Time in s without data after which a connection is closed.
    timeout = 60

    def do_POST(self) -> None:
        """Play the page's drive on the board at /board?MS, or turn the board off if it is empty.

        A page of another origin is refused: its requests have another Origin header, or none.
        """
        board, (name, _, at) = self.server.board, self.path.partition("?")
        host = self.headers.get("Host", "")
        if board is None:
            self.send_error(HTTPStatus.NOT_IMPLEMENTED)
        elif not HERE.fullmatch(host) or self.headers.get("Origin") != f"http://{host}":
            self.send_error(HTTPStatus.FORBIDDEN, "only this server's own page plays the board")
        elif name != "/board":
            self.send_error(HTTPStatus.NOT_FOUND)
        elif self.headers.get("Content-Type") != TYPES[".bin"]:
            self.send_error(HTTPStatus.UNSUPPORTED_MEDIA_TYPE)
        elif not re.fullmatch(r"\d{1,6}", length := self.headers.get("Content-Length", "")):
            self.send_error(HTTPStatus.LENGTH_REQUIRED)
        elif not re.fullmatch(r"\d{1,15}(\.\d{1,9})?", at):
            self.send_error(HTTPStatus.BAD_REQUEST, "the time of the drive is missing")
        else:
            self._play(board, float(at), self.rfile.read(int(length)))

    def end_headers(self) -> None:
        """Add the policy headers to every answer, also to errors."""
        self.send_header("Content-Security-Policy", POLICY)
        for name, value in HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def log_message(self, format: str, *arguments: Any) -> None:
        """Print nothing."""

    def do_GET(self) -> None:
        """Answer with headers and content; HEAD with headers only."""
        if not HERE.fullmatch(self.headers.get("Host", "")):
            self.send_error(HTTPStatus.FORBIDDEN, "only 127.0.0.1 and localhost are served")
            return
        name = self.path.partition("?")[0]
        if name == "/scene.json" and self.server.scene is not None:
            kind, content = TYPES[".json"], self.server.scene.encode()
        elif name == "/board.json" and self.server.board is not None:
            kind, content = TYPES[".json"], self.server.board.described()
        elif name in self.server.files:
            path = self.server.files[name]
            kind, content = TYPES.get(path.suffix, TYPES[".bin"]), path.read_bytes()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        self._send(HTTPStatus.OK, kind, content)

    do_HEAD = do_GET

    def _play(self, board: PagesBoard, at: float, content: bytes) -> None:
        """Play a drive, and answer with the text of the error, or with an empty text."""
        try:
            board.take(at, content)
            status, line = HTTPStatus.OK, ""
        except (SceneError, BoardError) as error:
            status, line = HTTPStatus.CONFLICT, str(error)
        self._send(status, "text/plain; charset=utf-8", line.encode())

    def _send(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)
