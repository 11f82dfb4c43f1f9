"""Strangers at the ports of `midair serve`: nothing that they send without the token plays, ends or logs."""

from __future__ import annotations

import json
import os
import random
import re
import resource
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import pytest

pytest.importorskip("websockets")
pytest.importorskip("pythonosc")

from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from websockets.sync.client import connect

import midair
from midair._serve import osc
from midair._serve.server import MOST_CLIENTS

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="limits files, reads /proc")

SLOW = bool(os.environ.get("MIDAIR_SLOW"))
CONNECTIONS = 10_000 if SLOW else 1_000

#: Most lines that the command may print after its own four.
LINES = 10

POINTS = json.dumps({"points": [[0, 0, 0.1]]})


class Served(NamedTuple):
    """A running `midair serve`; `log` has what it prints on the terminal."""

    program: subprocess.Popen[str]
    port: int
    osc: int
    token: str
    log: Path

    @property
    def address(self) -> str:
        return f"ws://127.0.0.1:{self.port}/?token={self.token}"

    def state(self) -> Any:
        """Returns the server's answer to a new client, which every test needs at its end."""
        with connect(self.address, open_timeout=10) as client:
            client.recv(timeout=10)
            client.send('{"state": true}')
            return json.loads(client.recv(timeout=10))

    def cpu(self) -> float:
        """Returns the CPU time in s that the server has used."""
        fields = Path(f"/proc/{self.program.pid}/stat").read_text("utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def serving(log: Path, on: str = "sonicsurface:loop", files: int = 1024) -> Iterator[Served]:
    """Runs the command until the block ends; it must still serve then, and have printed few lines."""
    limit = (files, resource.getrlimit(resource.RLIMIT_NOFILE)[1])
    with (
        log.open("w", encoding="utf-8") as errors,
        subprocess.Popen(
            [sys.executable, "-m", "midair", "serve", "--on", on],
            stdout=subprocess.PIPE,
            stderr=errors,
            encoding="utf-8",
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, limit),
        ) as program,
    ):
        try:
            assert program.stdout is not None
            address, datagrams, _ = (program.stdout.readline() for _ in range(3))
            port, token = re.findall(r":(\d+)/\?token=(.+)", address)[0]
            yield Served(program, int(port), int(re.findall(r":(\d+) ", datagrams)[0]), token, log)
            assert len(log.read_text("utf-8").splitlines()) <= LINES
        finally:
            program.kill()


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with serving(tmp_path / "log") as made:
        yield made
        assert made.state()["state"] in ("off", "playing")


def bundle(*parts: bytes, tag: int = 1) -> bytes:
    return b"#bundle\0" + struct.pack(">Q", tag) + b"".join(struct.pack(">i", len(each)) + each for each in parts)


def message(name: str, *values: Any) -> bytes:
    built = OscMessageBuilder(f"/midair/{name}")
    for value in values:
        built.add_arg(value)
    return built.build().dgram


def nested(content: bytes, levels: int) -> bytes:
    for _ in range(levels):
        content = bundle(content)
    return content


#: Requests of port scanners and of other protocols.
REQUESTS = (
    b"",
    b"\r\n\r\n",
    b"GET / HTTP/1.0\r\n\r\n",
    b"GET //[ HTTP/1.1\r\nHost: x\r\n\r\n",
    b"GET /?token=\xff\xfe%ff%00 HTTP/1.1\r\nHost: x\r\n\r\n",
    b"OPTIONS * RTSP/1.0\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n" + b"x" * 4096,
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(512),
    b"SSH-2.0-OpenSSH_9.6\r\n",
    b"\x00\x0c\x00\x00\x10\x00\x00\x00\x00\x00\x00\x00\x00\x00",
    b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 100_000,
    b"G" * 1_000_000,
    b"GET /?token=x HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: x\r\nSec-WebSocket-Version: 13\r\n\r\n",
)


@pytest.mark.slow
def test_a_port_scan_logs_nothing(served: Served) -> None:
    for request in REQUESTS * 3:
        with suppress(OSError), socket.create_connection(("127.0.0.1", served.port), 5) as client:
            client.sendall(request)
            if request:
                client.settimeout(0.2)
                client.recv(100)


#: Datagrams without the token: wrong sizes, deep bundles, odd types.
DATAGRAMS = (
    b"",
    b"#bundle\0",
    b"#bundle\0" + bytes(8),
    *(b"#bundle\0" + bytes(8) + struct.pack(">i", size) + b"aaaa" for size in (-4, -1, 0, 3, 5, 2**31 - 1)),
    b"#bundle\0" + bytes(8) + struct.pack(">i", -(2**31)) + b"aaaa",
    nested(message("points", 0.0, 0.0, 0.1), 3000),
    b"".join(b"#bundle\0" + bytes(8) + struct.pack(">i", 65_000 - 20 * k) for k in range(3000)),
    message("points", 0.0, 0.0, 0.1),
    message("points", "guess", 0.0, 0.0, 0.1),
    b"/midair/points\0\0,zzq\0\0\0\0",
    b"/midair/points\0\0,[[[[[[[[\0\0\0",
    b"/" + b"a" * 60_000,
    b"aaaa",
)


@pytest.mark.slow
def test_datagrams_without_the_token_are_cheap_and_silent(served: Served) -> None:
    random.seed(1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        place = "127.0.0.1", served.osc
        for datagram in DATAGRAMS:
            client.sendto(datagram, place)
        for _ in range(1000):
            client.sendto(random.choice((b"#bundle\0", b"/midair/", b"")) + random.randbytes(40), place)
        time.sleep(0.5)
        before = served.cpu()
        time.sleep(0.5)
        # Nothing spins.
        assert served.cpu() - before < 0.25
        # Nor does a damaged datagram that has the token.
        for datagram in (nested(message("state", served.token), 3000), b"#bundle\0" + served.token.encode()):
            client.sendto(datagram, place)
        client.settimeout(5)
        client.sendto(message("state", served.token), place)
        assert OscMessage(client.recv(4096)).address == "/midair/state"


def test_bundles_are_read_if_they_are_whole() -> None:
    one, other = message("points", "key", 1.0), message("points", "other", 1.0)
    assert osc.messages(bundle(one, bundle(other, one, tag=7))) == [(one, 1), (other, 7), (one, 7)]
    assert osc.messages(nested(one, osc.MOST_NESTED)) == [(one, 1)]
    damaged = [bundle(one)[:-1], bundle(one) + b"\0\0", nested(one, osc.MOST_NESTED + 1)]
    # Deeper than a datagram can be.
    damaged.append(nested(one, 10_000))
    for size in (-(2**31), -4, -1, 0, 2**31 - 1):
        damaged.append(bundle(one) + struct.pack(">i", size) + b"aaaa")
    for datagram in damaged:
        with pytest.raises(midair.SceneError, match="damaged"):
            osc.messages(datagram)
    assert osc.read(message("points", "key", 1.0), 0) == ("points", ["key", 1.0])
    for content in (b"", b"/", b"/midair/off\0", b"/midair/off\0,s\0\0"):
        with suppress(midair.SceneError):
            assert osc.read(content, 1)[1] in ([""], [])


@pytest.mark.slow
def test_a_bundle_for_later_is_answered_by_an_error(served: Served) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.settimeout(5)
        place, points = ("127.0.0.1", served.osc), message("points", served.token, 0.0, 0.0, 0.1)
        hour = int((time.time() + osc.EPOCH + 3600) * 2**32)
        client.sendto(bundle(points, tag=hour), place)
        told = OscMessage(client.recv(4096))
        assert told.address == "/midair/error"
        assert "send it at that time" in told.params[0]
        assert served.state()["frames"] == 0
        now = int((time.time() + osc.EPOCH) * 2**32)
        for tag in (1, now):
            client.sendto(bundle(points, message("state", served.token), tag=tag), place)
            assert OscMessage(client.recv(4096)).address == "/midair/state"


@pytest.mark.slow
def test_more_connections_than_files_end_nothing(tmp_path: Path) -> None:
    with serving(tmp_path / "log", files=64) as made:
        with connect(made.address) as player:
            strangers = [socket.create_connection(("127.0.0.1", made.port)) for _ in range(100)]
            time.sleep(0.5)
            player.send(POINTS)
            for each in strangers:
                each.close()
            time.sleep(1.5)
            player.send('{"state": true}')
            player.recv(timeout=5)
            assert "error" in player.recv(timeout=5)
        assert made.state()["frames"] > 0
        assert len(made.log.read_text("utf-8").splitlines()) <= LINES


@pytest.mark.slow
def test_many_connections_at_once_leave_room_for_the_token(served: Served) -> None:
    """Strangers connect all the time, some of them wait in silence; a client plays and another one comes."""
    waiting: list[socket.socket] = []
    with connect(served.address, max_queue=None) as player:
        for k in range(CONNECTIONS):
            with suppress(OSError):
                waiting.append(socket.create_connection(("127.0.0.1", served.port), 5))
                if k % 3 == 0:
                    waiting[-1].sendall(b"GET / HTTP/1.1\r\n")
            if len(waiting) > 200:
                waiting.pop(0).close()
            if k % 50 == 0:
                player.send(POINTS)
            if k % 500 == 0:
                assert served.state()["error"] is None
    for each in waiting:
        each.close()


@pytest.mark.slow
def test_one_client_too_many_is_told_so(served: Served) -> None:
    from websockets.exceptions import InvalidStatus

    clients = [connect(served.address) for _ in range(MOST_CLIENTS)]
    with pytest.raises(InvalidStatus, match="503"):
        connect(served.address)
    for each in clients:
        each.close()


@pytest.mark.slow
def test_a_lost_board_is_connected_again(tmp_path: Path) -> None:
    with serving(tmp_path / "log") as made, connect(made.address) as player:
        player.recv(timeout=5)
        children = Path(f"/proc/{made.program.pid}/task/{made.program.pid}/children").read_text("utf-8").split()
        for child in children:
            os.kill(int(child), 9)
        begin = time.monotonic()
        while True:
            player.send('{"points": [[0, 0, 0.1]], "state": true}')
            if json.loads(player.recv(timeout=10))["state"] == "playing":
                break
            assert time.monotonic() - begin < 20
            time.sleep(0.05)


@pytest.mark.slow
def test_a_board_that_stays_lost_ends_the_server_with_a_status(tmp_path: Path) -> None:
    from lines import Line

    line = Line()
    with serving(tmp_path / "log", f"sonicsurface:{line.port}") as made:
        with connect(made.address) as player:
            player.recv(timeout=5)
            line.unplug()
            begin = time.monotonic()
            with suppress(Exception):
                while time.monotonic() - begin < 20:
                    player.send(POINTS)
                    time.sleep(0.02)
        assert made.program.wait(20) == 2
        *_, told = made.log.read_text("utf-8").splitlines()
        assert line.port in told
