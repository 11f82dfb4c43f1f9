"""`midair serve`: points that other programs send by WebSocket and OSC, and messages that it rejects."""

from __future__ import annotations

import base64
import json
import math
import re
import signal
import socket
import struct
import subprocess
import sys
import threading
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

from midair._cli.serve import serve_command
from midair._serve.life import SILENCE
from midair._serve.live import Frame, Live, Wanted
from midair._serve.messages import obey
from midair._serve.server import PointServer

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


def osc(name: str, *values: Any) -> bytes:
    built = OscMessageBuilder(f"/midair/{name}")
    for value in values:
        built.add_arg(value)
    return built.build().dgram


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
@pytest.mark.parametrize("question", ['{"state": true}', '{"metrics": true}', '{"keep": true}', "osc"])
def test_questions_of_others_are_no_signs_of_life(server: PointServer, question: str) -> None:
    monitor = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with monitor, connect(server.address) as game, connect(server.address, max_queue=None) as other:
        game.send(json.dumps({"points": [POINT]}))
        until(server, "playing")
        begin = time.monotonic()
        while server._live.connection.state != "off":
            assert time.monotonic() - begin < SILENCE + 0.3
            if question == "osc":
                monitor.sendto(osc("state", server.token), ("127.0.0.1", server.osc))
            else:
                other.send(question)
            time.sleep(0.02)


@pytest.mark.slow
@pytest.mark.parametrize("board", ["sonicsurface:null", "sonicsurface:loop", "openmpd:null", "null"])
@pytest.mark.parametrize("by", ["json", "osc"])
def test_a_point_at_rest_that_comes_again_and_again_plays_on(board: str, by: str) -> None:
    phone = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with (
        midair.connect(board, hold=SILENCE) as connection,
        PointServer(Live(connection)) as server,
        phone,
        connect(server.address) as game,
    ):
        for pause in (0.01, 0.016, 0.03, 0.05):
            begin, last, slowest = time.monotonic(), time.monotonic(), 0.0
            while time.monotonic() - begin < 0.5:
                if by == "osc":
                    phone.sendto(osc("points", server.token, *POINT), ("127.0.0.1", server.osc))
                else:
                    game.send(json.dumps({"points": [POINT]}))
                time.sleep(pause)
                slowest, last = max(slowest, time.monotonic() - last), time.monotonic()
                if slowest < SILENCE / 2 and time.monotonic() - begin > 0.3:
                    assert connection.state == "playing", (pause, server._live.state())
            if slowest < SILENCE / 2:
                assert abs(connection.emitting).max() > 0.9
        assert connection.stats.lapses == 0 or slowest > SILENCE / 2


@pytest.mark.slow
def test_a_board_that_has_gone_off_by_itself_plays_again_while_the_point_comes(server: PointServer) -> None:
    with connect(server.address) as game:
        game.send(json.dumps({"points": [POINT]}))
        until(server, "playing")
        # As after a suspended computer: the guard has switched the board off.
        server._live.connection.off()
        for _ in range(20):
            game.send(json.dumps({"points": [POINT]}))
            time.sleep(0.02)
        assert server._live.connection.state == "playing"


@pytest.mark.slow
@pytest.mark.parametrize("flood", ['{"state": 1}', '{"keep": 1}'])
def test_a_backlog_counts_by_its_time_of_arrival(server: PointServer, flood: str) -> None:
    """A client floods the server for 2 s, reads nothing, then hangs with its connection open."""
    with socket.create_connection(("127.0.0.1", server.port)) as client:
        key = base64.b64encode(bytes(16)).decode()
        client.sendall(
            f"GET /?token={server.token} HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        client.recv(4096)
        client.sendall(masked(json.dumps({"points": [POINT]})))
        until(server, "playing")
        client.setblocking(False)
        frames, begin = masked(flood) * 100, time.monotonic()
        while time.monotonic() - begin < 2:
            try:
                client.send(frames)
            except BlockingIOError:
                time.sleep(0.001)
            except OSError:
                # The server has ended the connection.
                break
        assert until(server, "off") < SILENCE + 0.5


@pytest.mark.slow
def test_at_most_4000_messages_of_a_sender_wait(server: PointServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """While the server is busy, a sender lets 8 bundles of 1,000 messages wait: the last 4 are dropped."""
    from midair._serve import server as module

    obeyed: list[str] = []
    monkeypatch.setattr(module, "obey_osc", lambda live, sender, name, values: obeyed.append(name) or {})
    one, go = osc("keep", server.token), threading.Event()
    bundle = b"#bundle\0" + bytes(8) + 1000 * (struct.pack(">i", len(one)) + one)
    server._work.submit(go.wait)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as phone:
        for _ in range(8):
            phone.sendto(bundle, ("127.0.0.1", server.osc))
            time.sleep(0.1)
        go.set()
        server._work.submit(int).result(20)
        # Then there is room again.
        phone.sendto(osc("off", server.token), ("127.0.0.1", server.osc))
        time.sleep(0.3)
    assert obeyed == [*["keep"] * 4000, "off"]


def masked(text: str) -> bytes:
    """Returns a text frame of WebSocket from a client, with a mask of zeros."""
    assert len(text) < 126
    return bytes([0x81, 0x80 | len(text), 0, 0, 0, 0]) + text.encode()


@pytest.mark.slow
def test_points_and_off_in_quick_succession_lose_no_board(server: PointServer) -> None:
    with connect(server.address, max_queue=None) as game:
        for _ in range(300):
            game.send(json.dumps({"points": [POINT]}))
            game.send('{"off": true}')
        ask(game, state=True)
        game.send(json.dumps({"points": [POINT]}))
        until(server, "playing")


@pytest.mark.slow
def test_a_path_that_is_too_short_in_time_is_refused(server: PointServer) -> None:
    circle = {"kind": "circle", "center": POINT, "radius": 1e-5, "frequency": 1e308}
    with pytest.raises(midair.SceneError, match=r"path\.duration is .*: give a number of at least 0\.001"):
        obey(server._live, "me", json.dumps({"path": circle}))


def test_an_open_path_stays_at_its_end_and_a_closed_one_repeats(
    server: PointServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted: list[Wanted] = []
    monkeypatch.setattr(server._live, "play", wanted.append)
    line = midair.path.line(POINT, [0.02, 0, 0.1], speed=0.1)
    for path in (line, midair.path.line(POINT, [0.02, 0, 0.1], speed=0.1, there_and_back=True)):
        server._live.follow("me", path)
    places = [[each.at(time).points[0][0] for time in (0.1, 0.2, 0.35, 0.45)] for each in wanted]
    np.testing.assert_allclose(places, [[0.01, 0.02, 0.02, 0.02], [0.01, 0.02, 0.005, 0.005]], atol=1e-12)


@pytest.mark.slow
def test_metrics_are_of_what_the_board_emits() -> None:
    point = np.array([POINT])
    with midair.connect("sonicsurface:null", hold=SILENCE) as board:
        live, begin, reached = Live(board), time.monotonic(), []
        while not reached:
            assert time.monotonic() - begin < 5
            with live.life() as life:
                life.sign("me", time.monotonic())
            # The board has one amplitude, and plays louder than requested.
            live.play(Wanted("me", lambda time: Frame(point, loudness=0.7), constant=True))
            time.sleep(0.02)
            reached = live.metrics()["pressures"]
        gains = midair.Scene(board.board.array, point).propagation()[0]
        assert reached == pytest.approx([abs(gains @ board.emitting)], rel=1e-3)
        live.close()


@pytest.mark.slow
def test_a_board_that_is_connected_again_is_modulated_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(drive: Any) -> None:
        raise midair.BoardLost("it is gone")

    with midair.connect("null", hold=SILENCE) as first, midair.connect("null", hold=SILENCE) as second:
        waves: list[tuple[str, Any]] = []
        monkeypatch.setattr(first, "send", lost)
        for name, board in (("first", first), ("second", second)):
            monkeypatch.setattr(board, "modulate", lambda wave, name=name: waves.append((name, wave)))
        live, begin = Live(first, again=lambda: second), time.monotonic()
        live.modulate(200.0)
        while live.connection is not second or len(waves) < 2:
            assert time.monotonic() - begin < 5, waves
            with live.life() as life:
                life.sign("me", time.monotonic())
            live.place("me", np.array([POINT]))
            time.sleep(0.02)
        assert waves == [("first", 200.0), ("second", 200.0)]
        live.close()


@pytest.mark.slow
def test_a_message_wakes_a_server_at_rest() -> None:
    with midair.connect("null", hold=SILENCE) as board:
        live = Live(board, rate=1.0, change=np.pi)
        with live.life() as life:
            life.sign("me", time.monotonic())
        live.place("me", np.array([POINT]))
        begin = time.monotonic()
        # One frame per second; the second repeats the first, and then nothing more is sent.
        while time.monotonic() - begin < 2.5:
            with live.life() as life:
                life.sign("me", time.monotonic())
            time.sleep(0.02)
        frames, begin = board.stats.frames, time.monotonic()
        live.place("me", np.array([[0.02, 0, 0.1]]))
        while board.stats.frames == frames:
            assert time.monotonic() - begin < 0.5
            time.sleep(0.002)
        assert frames <= 2
        assert live.metrics()["points"] == [[0.02, 0, 0.1]]
        live.close()


@pytest.mark.slow
def test_frames_that_come_late_are_counted(server: PointServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each frame of this slow board comes later than two periods after it is due."""
    board = server._live.connection
    send, sent = board.send, 0

    def slow(drive: Any) -> None:
        nonlocal sent
        time.sleep(2.5 / server._live.rate)
        send(drive)
        sent += 1

    monkeypatch.setattr(board, "send", slow)
    with connect(server.address, max_queue=None) as game:
        for k in range(20):
            game.send(json.dumps({"points": [[1e-3 * k, 0, 0.1]]}))
            time.sleep(0.02)
        server._live.off()
        assert server._live.state()["late"] == sent > 5


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
            obey(server._live, "me", '{"metrics": ' + bad + "}")


@pytest.mark.slow
def test_a_warning_goes_to_the_program_that_caused_it(server: PointServer) -> None:
    far = {"points": [[0, 0, 150]]}
    with connect(server.address) as one, connect(server.address) as other:
        for client in (one, other):
            client.recv(timeout=5)
        for _ in range(3):
            one.send(json.dumps(far))
        told = json.loads(one.recv(timeout=5))["warning"]
        assert told.startswith("points[0].position is [0, 0, 150]")
        # Each kind of warning comes once within a second, and not to others.
        assert "state" in ask(one, keep=True)
        assert "state" in ask(other, keep=True)
    monitor = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with monitor:
        monitor.settimeout(5)
        monitor.sendto(osc("points", server.token, 0.0, 0.0, 150.0), ("127.0.0.1", server.osc))
        found = OscMessage(monitor.recv(4096))
    assert (found.address, found.params[0][:18]) == ("/midair/warning", "points[0].position")


@pytest.mark.slow
@pytest.mark.parametrize(("board", "change"), [("sonicsurface", None), ("autd3", None), ("sonicsurface", 0.2)])
def test_a_focus_follows_a_hand_or_a_warning_says_why_not(board: str, change: float | None) -> None:
    with (
        midair.connect(f"{board}:loop", hold=SILENCE) as link,
        PointServer(Live(link, change=change)) as server,
        connect(server.address) as client,
    ):
        client.recv(timeout=5)
        levels: list[float] = []
        told: list[str] = []
        begin = time.monotonic()
        while (now := time.monotonic() - begin) < 1.5:
            # 0.5 m/s on a circle of 2 cm, 90 messages a second.
            angle = 0.5 / 0.02 * now
            place = [0.02 * math.cos(angle), 0.02 * math.sin(angle), 0.15]
            client.send(json.dumps({"points": [place], "metrics": True}))
            answer = json.loads(client.recv(timeout=5))
            if "warning" in answer:
                told.append(answer["warning"])
            elif answer["points"] and now > 0.3:
                whole = np.abs(midair.Scene(link.board.array, answer["points"]).propagation()).sum()
                levels.append(answer["pressures"][0] / whole)
            time.sleep(1 / 90)
    if change is None:
        assert np.median(levels) > 0.9
    else:
        assert np.median(levels) < 0.8
        assert any("a point moves by" in line and "the level falls" in line for line in told)


@pytest.mark.slow
def test_osc_plays_with_the_token_and_not_without(server: PointServer) -> None:
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.settimeout(5)

    def send(name: str, *values: Any) -> None:
        sender.sendto(osc(name, *values), ("127.0.0.1", server.osc))

    send("points", *POINT)
    send("points", "guessed", *POINT)
    time.sleep(0.2)
    assert server._live.connection.state == "off"
    send("points", server.token, *POINT)
    until(server, "playing")
    send("points", server.token, 1.0)
    assert b"give 3 a point" in sender.recv(4096)
    send("metrics", server.token)
    measured = OscMessage(sender.recv(4096))
    assert measured.address == "/midair/metrics"
    assert measured.params[0] == "playing"
    assert measured.params[-1] > 100
    send("off", server.token)
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
            obey(server._live, "me", message)
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


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"change": -1.0}, "change is -1.0: give a number above 0"),
        ({"change": math.nan}, "change is nan: give a finite number"),
        ({"rate": math.nan}, "rate is nan: give a finite number"),
        ({"token": "short"}, 'token is "short": give at least 16'),
        *(({"origin": [origin]}, "give SCHEME://HOST") for origin in ("nonsense", "*", "http://", "http://a/b")),
    ],
)
def test_options_that_let_nothing_play_are_refused(options: dict[str, Any], told: str) -> None:
    with pytest.raises(midair.SceneError, match=re.escape(told)):
        serve_command(on="sonicsurface:null", **options)


@pytest.mark.slow
def test_the_command_prints_where_it_serves_and_ends_by_ctrl_c() -> None:
    command = [sys.executable, "-m", "midair", "serve", "--on", "sonicsurface:loop", "--token", "a" * 16]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8") as program:
        assert program.stdout is not None
        address, osc = program.stdout.readline().strip(), program.stdout.readline()
        assert osc.startswith("osc://127.0.0.1:")
        assert address.endswith("token=aaaaaaaaaaaaaaaa")
        with connect(address) as client:
            assert json.loads(client.recv(timeout=10))["board"] == "sonicsurface"
        program.send_signal(signal.SIGINT)
        _, printed = program.communicate(timeout=20)
    assert "interrupted" in printed
    assert program.returncode == 130
