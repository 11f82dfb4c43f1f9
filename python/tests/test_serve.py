"""`midair serve`: points that other programs send by WebSocket and OSC, and messages that it rejects."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import midair

pytest.importorskip("websockets")
pytest.importorskip("pythonosc")

from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from midair._serve.live import SILENCE, Live
from midair._serve.server import PointServer, Reports

# A board with one amplitude warns that it plays louder than requested.
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")

POINT = [0.0, 0.0, 0.1]


@pytest.fixture
def server() -> Iterator[PointServer]:
    with midair.connect("sonicsurface:loop", hold=SILENCE) as board, PointServer(Live(board)) as found:
        yield found


def ask(client: Any, **message: Any) -> Any:
    client.send(json.dumps({**message, "state": True}))
    return json.loads(client.recv(timeout=5))


def until(server: PointServer, state: str, seconds: float = 2.0) -> float:
    """Waits until the board is in a state, and returns the time in s."""
    begin = time.monotonic()
    while server._live.connection.state != state:
        assert time.monotonic() - begin < seconds, server._live.state()
        time.sleep(0.005)
    return time.monotonic() - begin


def focus(server: PointServer) -> float:
    """Returns |p| of the playing drive at POINT, over the |p| of one full focus there."""
    gains = midair.Scene(server._live.connection.board.array, [POINT]).propagation()[0]
    return float(abs(gains @ server._live.connection.emitting) / abs(gains).sum())


@pytest.mark.slow
def test_points_are_played_and_silence_is_silent(server: PointServer) -> None:
    with connect(server.address) as client:
        greeting = json.loads(client.recv(timeout=5))
        assert (greeting["board"], greeting["transducers"]) == ("sonicsurface", 256)
        assert ask(client, points=[POINT])["error"] is None
        until(server, "playing")
        assert focus(server) > 0.9
        # A client that sends nothing more counts as gone.
        assert until(server, "off") < SILENCE + 0.3
        # A later `keep` does not bring the client's points back.
        assert ask(client, keep=True)["state"] == "off"
        time.sleep(0.1)
        assert server._live.connection.state == "off"
        client.send(np.array([[*POINT, 0.0]], "<f4").tobytes())
        until(server, "playing")
        client.send(b"")
        until(server, "off")
        ask(client, points=[POINT, [0.01, 0, 0.1]], pressures=[300, 100])
        until(server, "playing")
    # The board turns off when the client has gone.
    assert until(server, "off") < SILENCE + 0.3


@pytest.mark.slow
def test_a_path_goes_on_while_there_are_signs_of_life(server: PointServer) -> None:
    with connect(server.address) as client:
        client.recv(timeout=5)
        circle = {"kind": "circle", "center": POINT, "radius": 0.01, "frequency": 2}
        assert ask(client, path=circle)["error"] is None
        until(server, "playing")
        for _ in range(8):
            client.send('{"keep": true}')
            time.sleep(0.05)
        assert server._live.connection.state == "playing"
        client.send('{"off": true}')
        until(server, "off")


@pytest.mark.slow
def test_a_message_wakes_a_server_at_rest() -> None:
    with midair.connect("null", hold=SILENCE) as board:
        live = Live(board, rate=1.0, change=np.pi)
        live.place(np.array([POINT]))
        begin = time.monotonic()
        # One frame per second; the second repeats the first, and then nothing more is sent.
        while time.monotonic() - begin < 2.5:
            live.keep()
            time.sleep(0.02)
        frames, begin = board.stats.frames, time.monotonic()
        live.place(np.array([[0.02, 0, 0.1]]))
        while board.stats.frames == frames:
            assert time.monotonic() - begin < 0.5
            time.sleep(0.002)
        assert frames <= 2
        assert live.metrics()["points"] == [[0.02, 0, 0.1]]
        live.close()


@pytest.mark.slow
def test_metrics_come_once_or_again_and_again(server: PointServer) -> None:
    with connect(server.address) as client:
        client.recv(timeout=5)
        client.send(json.dumps({"points": [POINT], "pressures": [900]}))
        until(server, "playing")
        client.send('{"metrics": 0.02}')
        for _ in range(4):
            found = json.loads(client.recv(timeout=5))
            client.send('{"keep": true}')
        assert found["state"] == "playing"
        assert found["points"] == [POINT]
        (reached,) = found["pressures"]
        gains = midair.Scene(server._live.connection.board.array, [POINT]).propagation()[0]
        assert reached == pytest.approx(abs(gains @ server._live.connection.emitting), rel=1e-3)
        assert 0 <= found["delay"] < 500
        client.send('{"metrics": 0}')
        client.send('{"off": true}')
        until(server, "off")
        assert server._live.metrics()["pressures"] == []
    for bad in ("-1", "1e999", '"often"'):
        with pytest.raises(midair.SceneError, match="metrics"):
            server.obey('{"metrics": ' + bad + "}", Reports(None, server._live))


@pytest.mark.slow
def test_osc_plays_with_the_token_and_not_without(server: PointServer) -> None:
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.settimeout(5)

    def osc(name: str, *values: Any) -> None:
        built = OscMessageBuilder(f"/midair/{name}")
        for value in values:
            built.add_arg(value)
        sender.sendto(built.build().dgram, ("127.0.0.1", server.osc))

    osc("points", *POINT)
    osc("points", "guessed", *POINT)
    time.sleep(0.2)
    assert server._live.connection.state == "off"
    osc("points", server.token, *POINT)
    until(server, "playing")
    osc("points", server.token, 1.0)
    assert b"give 3 a point" in sender.recv(4096)
    osc("metrics", server.token)
    measured = OscMessage(sender.recv(4096))
    assert measured.address == "/midair/metrics"
    assert measured.params[0] == "playing"
    assert measured.params[-1] > 100
    osc("off", server.token)
    until(server, "off")
    sender.close()


def test_a_client_without_the_token_or_from_another_page_is_refused(server: PointServer) -> None:
    plain = server.address.partition("?")[0]
    for address, origin in (
        (plain, None),
        (plain + "?token=x", None),
        (server.address, "https://evil.example"),
    ):
        with pytest.raises(InvalidStatus, match="403"), connect(address, origin=origin):  # type: ignore[arg-type]
            pass


HOSTILE: tuple[str | bytes, ...] = (
    "",
    "{",
    "[" * 50_000,
    '{"points": ' + "[" * 30_000 + "]" * 30_000 + "}",
    "null",
    "[1]",
    '{"points": [[NaN, 0, 0.1]]}',
    '{"points": [[Infinity, 0, 0.1]]}',
    '{"points": [[1e999, 0, 0.1]]}',
    '{"points": [[1e300, 0, 0.1]]}',
    '{"points": []}',
    '{"points": [[0, 0]]}',
    '{"points": "all"}',
    '{"points": {"x": 1}}',
    '{"points": [[0, 0, 0.1]], "pressures": [-1]}',
    '{"points": [[0, 0, 0.1]], "pressures": [1, 2]}',
    '{"points": [[0, 0, 0.1]], "pressures": "loud"}',
    '{"points": [[0, 0, 0.1]], "volume": 11}',
    json.dumps({"points": [[0, 0, 0.1 + 1e-4 * k] for k in range(1000)]}),
    '{"path": {"kind": "svg", "file": "/etc/passwd"}}',
    '{"path": {"kind": "circle"}}',
    '{"path": {"kind": "circle", "center": [0, 0, 0.1], "radius": 1e9, "speed": 1}}',
    '{"path": 3}',
    '{"modulation": -5}',
    '{"modulation": "fast"}',
    '{"modulation": [[1]]}',
    b"\x00",
    b"\xff" * 16,
    np.full(4, np.nan, "<f4").tobytes(),
    b"\x00" * (16 * 1000),
)


@pytest.mark.slow
def test_hostile_messages_make_no_sound_and_end_nothing(server: PointServer) -> None:
    for message in HOSTILE * 34:
        with pytest.raises((midair.SceneError, midair.BoardError)):
            server.obey(message)
    with connect(server.address) as client:
        client.recv(timeout=5)
        for message in HOSTILE:
            client.send(message)
            assert "error" in json.loads(client.recv(timeout=10)), message[:60]
        assert server._live.connection.stats.frames == 0
        client.send("x" * 70_000)
        with pytest.raises(Exception, match=r"1009|too big"):
            client.recv(timeout=5)
    flood = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    random = np.random.default_rng(0)
    for k in range(1000):
        flood.sendto(b"/midair/points\0\0" * (k % 2) + random.bytes(k % 90), ("127.0.0.1", server.osc))
    flood.close()
    with connect(server.address) as client:
        client.recv(timeout=5)
        assert ask(client, points=[POINT])["error"] is None
        until(server, "playing")


@pytest.mark.slow
def test_the_command_prints_where_it_serves_and_ends_by_ctrl_c() -> None:
    command = [sys.executable, "-m", "midair", "serve", "--on", "sonicsurface:loop"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        address, osc = program.stdout.readline().strip(), program.stdout.readline()
        assert osc.startswith("osc://127.0.0.1:")
        with connect(address) as client:
            assert json.loads(client.recv(timeout=10))["board"] == "sonicsurface"
        program.send_signal(signal.SIGINT)
        _, printed = program.communicate(timeout=20)
    assert "interrupted" in printed
    assert program.returncode == 130
