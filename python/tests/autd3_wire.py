"""A wire between midair and an emulator of AUTD3 boards: loses datagrams, and stores the boards' steps.

The client is given the wire's address for the emulator's. Each board answers from a socket of its own, so the
wire has one for each, too, towards the client, made when the board first speaks.
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

#: Boards of the tests.
BOARDS = 2

#: Kinds of datagrams, by their second byte; and the command of a frame with one pattern, by its second byte.
FRAME, HEARTBEAT = 0, 7
PATTERN = 0x16
#: Bytes of a datagram's header, and of all headers before the codes of a pattern; protocols of paired codes.
HEADER, CODES = 4, 20
PAIRED = 5


class Wire:
    """A wire to the emulator at "[::1]:PORT"; `lose` says which datagrams, of both directions, are lost."""

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
        """The steps that each board received, the first board first: the last one receives first."""
        return [list(each) for each in reversed(self._steps.values())]

    def _socket(self, board: Any) -> socket.socket:
        made = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
        made.bind(("::1", 0))
        self._selector.register(made, selectors.EVENT_READ, board)
        return made

    def _face(self, board: Any) -> socket.socket:
        """The socket that stands for a board, or for all of them, towards the client."""
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
        """Keep a step that is on its way to a board, and the codes of a pattern: phases, then intensities."""
        self.heartbeats += data[1] == HEARTBEAT
        if data[1] == FRAME:
            self._steps[board].append(data[HEADER:])
            if data[HEADER + 1] == PATTERN:
                codes = data[CODES:]
                self.reported[board].append(codes[::2] + codes[1::2] if data[0] == PAIRED else codes)


def described(address: str) -> Autd3Transport:
    """A transport as a guard makes it, from JSON."""
    made = open_transport(json.loads(json.dumps({"kind": "udp", "address": address, "boards": BOARDS})))
    assert isinstance(made, Autd3Transport)
    return made
