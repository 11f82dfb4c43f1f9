"""Server: the page, for browsers of this machine and for nobody else."""

from __future__ import annotations

import re
import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from socketserver import TCPServer
from typing import Any

from .._midair import SceneError
from .page import BUILT, file

#: Types by ending; a browser that may not guess asks for them.
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".json": "application/json",
    ".wasm": "application/wasm",
    ".svg": "image/svg+xml",
    ".png": "image/png",
}

#: The page may use nothing but its own files, and is in nobody's frame.
POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; worker-src 'self' blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

#: A page that opened this one has no hold of it, no other page takes its files or reaches the serial ports.
HEADERS = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "serial=(self)",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}

#: Names of this machine. Another one in a request is a foreign page that had its own name lead here.
HERE = re.compile(r"(127\.0\.0\.1|localhost)(:\d+)?", re.IGNORECASE)


class Server(ThreadingHTTPServer):
    """Serves the built page, and a scene's JSON text at /scene.json, until it is stopped.

    port : of 127.0.0.1; 0 for a free one. Raises SceneError where it cannot be had, or nothing is built.
    """

    daemon_threads = True
    request_queue_size = 64

    def __init__(self, scene: str | None = None, port: int = 0, folder: Path = BUILT) -> None:
        file("index.html", folder)
        # What is not in these is not served.
        self.files = {
            f"/{path.relative_to(folder).as_posix()}": path for path in folder.rglob("*") if path.is_file()
        }
        self.files["/"] = self.files["/index.html"]
        self.scene = scene
        try:
            super().__init__(("127.0.0.1", port), Answer)
        except (OSError, OverflowError) as error:
            reason = error.strerror if isinstance(error, OSError) else "no port has this number"
            raise SceneError(f"port is {port}: {reason}; leave it out, and a free one is taken") from error

    @property
    def address(self) -> str:
        """Where a browser finds the page, with the scene if there is one."""
        return f"http://127.0.0.1:{self.server_port}/{'' if self.scene is None else '?scene'}"

    def server_bind(self) -> None:
        """Takes the port; HTTPServer's own would look for the machine's name, which can take seconds."""
        TCPServer.server_bind(self)
        self.server_name, self.server_port = "127.0.0.1", self.socket.getsockname()[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Says nothing of browsers that leave in the middle of an answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


class Answer(BaseHTTPRequestHandler):
    """The answer to one request: a file, the scene, or a refusal; GET and HEAD alone."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "midair", ""
    #: Seconds without a word after which a connection is closed.
    timeout = 60

    def do_GET(self) -> None:
        """Answers with the content."""
        self._answer(with_content=True)

    def do_HEAD(self) -> None:
        """Answers without."""
        self._answer(with_content=False)

    def end_headers(self) -> None:
        """Puts the policy below every answer's headers, a refusal's, too."""
        self.send_header("Content-Security-Policy", POLICY)
        for name, value in HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def log_message(self, format: str, *arguments: Any) -> None:
        """Says nothing."""

    def _answer(self, *, with_content: bool) -> None:
        if not HERE.fullmatch(self.headers.get("Host", "")):
            self.send_error(HTTPStatus.FORBIDDEN, "only 127.0.0.1 and localhost are served")
            return
        name = self.path.partition("?")[0]
        if name == "/scene.json" and self.server.scene is not None:
            kind, content = TYPES[".json"], self.server.scene.encode()
        elif name in self.server.files:
            path = self.server.files[name]
            kind, content = TYPES.get(path.suffix, "application/octet-stream"), path.read_bytes()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if with_content:
            self.wfile.write(content)
