"""A relay between midair and an emulator of AUTD3 boards: it can drop datagrams, and stores the boards'
steps.

The client gets the relay's address instead of the emulator's. Each board replies from its own socket, so
the relay opens one socket per board towards the client, when the board first sends a datagram.
"""

from __future__ import annotations

import json
import selectors
import socket
import threading
from collections import defaultdict
from collections.abc import Callable
from typing import Any

from midair._boards.autd3 import Autd3Transport
from midair._boards.transport import open_transport

#: Number of boards in the tests.
BOARDS = 2

#: Kinds of datagrams, in their second byte: one with a step, and a heartbeat. PATTERN is the command of a
#: single pattern, in the second byte of a step. PAIRED is the protocol (first byte of a datagram) in which
#: a pattern's phase and intensity codes alternate.
FRAME, HEARTBEAT = 0, 7
PATTERN = 0x16
#: Lengths in bytes: of a datagram's header, and of all headers before a pattern's codes.
HEADER, CODES = 4, 20
PAIRED = 5


class Wire:
    """A relay to the emulator at "[::1]:PORT";
    it drops the datagrams, of both directions, for which `lose` is true.
    """

    def __init__(self, emulator: str, lose: Callable[[bytes], bool] = lambda _: False) -> None:
        self.lose = lose
        self.reported: dict[Any, list[bytes]] = defaultdict(list)
        self._steps: dict[Any, list[bytes]] = defaultdict(list)
        self.lost, self.carried, self.heartbeats = 0, 0, 0
        self._client: Any = None
        self._selector = selectors.DefaultSelector()
        self._towards_client: dict[Any, socket.socket] = {}
        group = ("::1", int(emulator.rpartition(":")[2]))
        self.address = f"[::1]:{self._face(group).getsockname()[1]}"
        self._towards_boards = self._socket(None)
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._running = False
        self._thread.join(2)
        for key in list(self._selector.get_map().values()):
            key.fileobj.close()
        self._selector.close()

    def steps(self) -> list[list[bytes]]:
        """Returns each board's received steps, first board first. (A step reaches the last board first.)"""
        return [list(each) for each in reversed(self._steps.values())]

    def _socket(self, board: Any) -> socket.socket:
        made = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
        made.bind(("::1", 0))
        self._selector.register(made, selectors.EVENT_READ, board)
        return made

    def _face(self, board: Any) -> socket.socket:
        """Returns the socket that sends the client the replies of a board, or of all boards."""
        if board not in self._towards_client:
            self._towards_client[board] = self._socket(board)
        return self._towards_client[board]

    def _run(self) -> None:
        while self._running:
            for key, _ in self._selector.select(0.05):
                data, source = key.fileobj.recvfrom(2048)
                if self.lose(data):
                    self.lost += 1
                    continue
                self.carried += 1
                if key.data is None:
                    self._face(source[:2]).sendto(data, self._client)
                else:
                    self._client = source
                    self._note(key.data, data)
                    self._towards_boards.sendto(data, key.data)

    def _note(self, board: Any, data: bytes) -> None:
        """Stores a step that goes to a board, and a pattern's codes: all phases, then all intensities."""
        self.heartbeats += data[1] == HEARTBEAT
        if data[1] == FRAME:
            self._steps[board].append(data[HEADER:])
            if data[HEADER + 1] == PATTERN:
                codes = data[CODES:]
                self.reported[board].append(codes[::2] + codes[1::2] if data[0] == PAIRED else codes)


def described(address: str) -> Autd3Transport:
    """Opens a transport from a JSON description, as the guard process does."""
    made = open_transport(json.loads(json.dumps({"kind": "udp", "address": address, "boards": BOARDS})))
    assert isinstance(made, Autd3Transport)
    return made
