"""Simulated AUTD3 boards: they accept unit numbers, and store and acknowledge steps (commands to boards).

They reply in either protocol as the makers' emulators do. `make test-boards` uses those emulators.
"""

from __future__ import annotations

import selectors
import socket
import struct
import threading
from typing import Any

HEADER, STEP = struct.Struct("<BBH"), struct.Struct("<BBI")


class Fake:
    """A chain of boards at `address`. `steps[k]` are the frames that board k received, without their header.

    Parameters
    ----------
    version
        Version of the boards' protocol: 5, or 3, which counts steps.
    firmware
        Six bytes: the versions of processor and FPGA that the boards report.
    """

    def __init__(self, version: int, boards: int, firmware: bytes = bytes([0, 13, 0, 0, 13, 0])) -> None:
        self.versions, self.firmware = [version] * boards, firmware
        self.steps: list[list[bytes]] = [[] for _ in range(boards)]
        #: `refusals`: status codes of the next replies, one per step. `flags`: bits that each reply's status
        #: flags have in addition to the usual ones.
        self.refusals: list[int] = []
        self.flags = 0
        #: For this many steps, the boards acknowledge the previous count: the sign that a step was dropped.
        self.skips = 0
        self._unit: list[int | None] = [None] * boards
        self._open = [False] * boards
        self._selector = selectors.DefaultSelector()
        self._group, *self._sockets = [self._socket(k) for k in range(-1, boards)]
        self.address = f"autd3:[::1]:{self._group.getsockname()[1]}"
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._running = False
        self._thread.join(2)
        for each in (self._group, *self._sockets):
            each.close()
        self._selector.close()

    def _socket(self, board: int) -> socket.socket:
        made = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
        made.bind(("::1", 0))
        self._selector.register(made, selectors.EVENT_READ, board)
        return made

    def _run(self) -> None:
        while self._running:
            for key, _ in self._selector.select(0.02):
                data, host = key.fileobj.recvfrom(2048)
                for board in self._reached() if key.data < 0 else [key.data]:
                    answer = self._answer(board, data)
                    if answer is not None:
                        number = HEADER.unpack_from(data)[2]
                        head = HEADER.pack(self.versions[board], data[1], number)
                        self._sockets[board].sendto(head + answer, host)

    def _reached(self) -> list[int]:
        """Returns the boards that a datagram to all boards reaches: up to the first with a closed port."""
        closed = self._open.index(False) if False in self._open else len(self._open) - 1
        return list(range(closed + 1))

    def _answer(self, board: int, data: bytes) -> bytes | None:
        """Returns the reply of a board to a datagram, None if it sends none."""
        version, kind, _ = HEADER.unpack_from(data)
        body = data[HEADER.size :]
        if version != self.versions[board]:
            return bytes([1])
        unit = self._unit[board]
        if kind in (0, 7):
            return self._step(board, body) if unit is not None else None
        if kind == 1:
            flags = self._flags(board)
            head = bytes([0, 255 if unit is None else unit, flags])
            return head + (bytes([0, 0]) + self.firmware[:3] + bytes(13) if version < 5 else bytes(4))
        if kind == 2:
            self._unit[board], self._open[board] = None, False
        if kind == 3 and unit is not None:
            return None
        if kind == 4:
            assert body[1] == (body[0] == 0)
            self._unit[board] = body[0]
        if kind == 5:
            self._open[board] = True
            return bytes([0, board + 1 < len(self._unit)])
        return bytes([0])

    def _flags(self, board: int) -> int:
        return (self._unit[board] is not None) | 0x18 | self.flags

    def _step(self, board: int, body: bytes) -> bytes:
        """Stores the step of a datagram, if it has one, and returns the reply."""
        count, data = 0, b""
        status = self.refusals.pop(0) if body and self.refusals else 0
        if body:
            count, command, at_once = STEP.unpack_from(body)
            assert at_once == 0
            self.steps[board].append(body)
            if self.skips:
                self.skips -= 1
                count -= 1
            data = self.firmware + bytes(2) if command == 0xEB else b""
        return struct.pack("<BBBBQ", count, status, self._flags(board), self._unit[board] or 0, 1) + data


def read(frame: bytes) -> tuple[int, int, bytes]:
    """Returns count, command and payload of a step."""
    count, command, _ = STEP.unpack_from(frame)
    return count, command, frame[STEP.size :]


def acts(boards: Any) -> list[Any]:
    """Returns the calls on a transport of two boards that golden/autd3 records, in order."""
    codes = bytes(k * k % 251 for k in range(2 * 498 * 7))
    frames = [codes[k : k + 2 * 498] for k in range(0, len(codes), 2 * 498)]
    return [
        lambda: None,
        lambda: boards.play(frames[0]),
        lambda: boards.upload(b"".join(frames[1:6]), 5, 40000 / 3),
        lambda: boards.modulate(150),
        lambda: boards.play(frames[6]),
        lambda: boards.modulate(None),
        boards.silence,
        boards.close,
    ]
