"""The clients in examples/serve against `midair serve`: programs in Python, web pages' scripts in Node.

A drawn track of a palm replaces the cameras: its places in m are known.
"""

from __future__ import annotations

import json
import re
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import midair

pytest.importorskip("websockets")
pytest.importorskip("pythonosc")

from pythonosc.osc_message_builder import OscMessageBuilder
from websockets.sync.server import ServerConnection, serve

from midair._serve.life import SILENCE
from midair._serve.live import Live
from midair._serve.server import PointServer

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore::midair.SceneWarning")]

CLIENTS = Path(__file__).parents[2] / "examples" / "serve"

#: A page around the script of client.html: the mouse moves for 0.4 s, then leaves.
PAGE = """
const parts = { hand: {}, state: {}, address: {} };
globalThis.document = { getElementById: (name) => parts[name] };
%s
parts.address.onchange({ target: { value: process.argv[2] } });
setTimeout(() => hand.onpointermove({ offsetX: 250, offsetY: 150 }), 300);
setTimeout(() => { hand.onpointerleave(); console.log(parts.state.textContent); }, 1500);
setTimeout(() => process.exit(), 1800);
"""

#: A page around the script of hand.html: a landmarker that returns the track in place of MediaPipe's.
HAND_PAGE = """
import { readFileSync } from "node:fs";
const track = JSON.parse(readFileSync(process.argv[3], "utf8"));
const picture = { videoWidth: 640, videoHeight: 480, play() {} };
const parts = { address: { value: process.argv[2] }, state: {}, camera: picture };
globalThis.document = { getElementById: (name) => parts[name] };
const mediaDevices = { getUserMedia: async () => ({}) };
Object.defineProperty(globalThis, "navigator", { value: { mediaDevices } });
const detectForVideo = () => track.length ? track.shift() : process.exit();
const bundle = {
  FilesetResolver: { forVisionTasks: async () => ({}) },
  HandLandmarker: { createFromOptions: async () => ({ detectForVideo }) },
};
%s
await parts.address.onchange();
if (parts.state.textContent) throw new Error(parts.state.textContent);
"""

#: Places of a palm in m of the array: it comes from the side, presses the button, leaves it and is away.
TRACK = [
    *([0.06 - 0.001 * step, 0.01, 0.15] for step in range(50)),
    *([0.01, 0.01, 0.15 - 0.001 * step] for step in range(25)),
    *[None] * 15,
]


def felt(places: np.ndarray) -> np.ndarray:
    """Returns whether the button is felt at places: within 3 cm of the axis, 13 to 17 cm above the array."""
    return (np.hypot(places[:, 0], places[:, 1]) < 0.03) & (abs(places[:, 2] - 0.15) < 0.02)


def check_button(found: list[list[float]]) -> None:
    """Checks that the board played the track's palm where the button is felt, and nothing else."""
    wanted = np.array([place for place in TRACK if place is not None])
    wanted = wanted[felt(wanted)]
    distances = np.linalg.norm(np.array(found)[:, None] - wanted, axis=2)
    assert distances.min(axis=1).max() < 1e-6
    assert len(found) > 10


def node() -> str:
    """Returns Node's program; skips the test without a Node that has WebSocket."""
    found = shutil.which("node")
    probe = ["--experimental-websocket", "--eval", "WebSocket"]
    if found is None or subprocess.run([found, *probe], capture_output=True, check=False).returncode:
        pytest.skip("there is no Node with WebSocket, 20.10 or newer")
    return found


@pytest.fixture
def server() -> Iterator[PointServer]:
    with midair.connect("sonicsurface:loop", hold=SILENCE) as board, PointServer(Live(board)) as found:
        yield found


def places(server: PointServer, program: subprocess.Popen[str]) -> list[list[float]]:
    """Returns the points that the board played while a client ran; then the board must turn off."""
    found: list[list[float]] = []
    begin = time.monotonic()
    while program.poll() is None and time.monotonic() - begin < 60:
        if server._live._wanted is not None and server._live._played is not None:
            (point,) = server._live._played[0].points.tolist()
            if not found or found[-1] != point:
                found.append(point)
        time.sleep(0.005)
    assert program.wait(10) == 0
    begin = time.monotonic()
    while server._live.connection.state != "off":
        assert time.monotonic() - begin < SILENCE + 0.3
        time.sleep(0.01)
    return found


def test_python(server: PointServer) -> None:
    command = [sys.executable, str(CLIENTS / "client.py"), server.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8") as program:
        found = np.array(places(server, program))
        assert program.stdout is not None
        greeting, state = program.stdout.read().splitlines()
    assert '"board": "sonicsurface"' in greeting
    assert '"error": null' in state
    assert len(found) > 50
    np.testing.assert_allclose(np.hypot(found[:, 0], found[:, 1]), 0.02, atol=1e-9)
    np.testing.assert_allclose(found[:, 2], 0.15)


def test_a_web_page(server: PointServer, tmp_path: Path) -> None:
    (script,) = re.findall(r"<script>(.*?)</script>", (CLIENTS / "client.html").read_text("utf-8"), re.S)
    page = tmp_path / "page.mjs"
    page.write_text(PAGE % script, "utf-8")
    command = [node(), "--experimental-websocket", str(page), server.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8") as program:
        found = places(server, program)
        assert program.stdout is not None
        assert '"transducers": 256' in program.stdout.read()
    np.testing.assert_allclose(found, [[0.01, 0.01, 0.15]], atol=1e-8)


def test_processing_sends_what_the_server_reads(server: PointServer) -> None:
    """Checks the message that oscP5 builds: text as s, floats as f, in the order of the calls."""
    program = (CLIENTS / "client.pde").read_text("utf-8")
    assert re.findall(r"OscMessage\(\"(.*?)\"\)", program) == ["/midair/points"]
    added = re.findall(r"message\.add\((.*)\);", program)
    assert added == ["TOKEN", "(mouseX - 200) / 5000.0", "(200 - mouseY) / 5000.0", "0.15"]
    built = OscMessageBuilder("/midair/points")
    for value in (server.token, *(float(eval(each, {"mouseX": 250, "mouseY": 150})) for each in added[1:])):
        built.add_arg(value)
    assert built.build().dgram.count(b",sfff") == 1
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    begin = time.monotonic()
    while server._live.connection.state != "playing":
        assert time.monotonic() - begin < 5
        sender.sendto(built.build().dgram, ("127.0.0.1", server.osc))
        time.sleep(0.02)
    sender.close()


def test_a_palm_that_a_leap_tracks_feels_the_button(server: PointServer) -> None:
    said = []

    def leap(client: ServerConnection) -> None:
        """Sends what UltraleapTrackingWebSocket sends: the version, a device, frames in mm."""
        client.send('{"version":6}')
        said.append(client.recv())
        client.send('{"event":{"type":"deviceEvent","state":{"attached":true,"id":1,"streaming":true}}}')
        for place in TRACK:
            hands = []
            if place is not None:
                x, y, z = 1e3 * (np.array(place) - [0, -0.12, 0])
                hands = [{"id": 1, "confidence": 1, "palmPosition": [x, z, -y]}]
            client.send(json.dumps({"id": 1, "timestamp": 1, "hands": hands, "pointables": []}))
            time.sleep(0.02)

    with serve(leap, "127.0.0.1", 0) as service:
        threading.Thread(target=service.serve_forever, daemon=True).start()
        address = f"ws://127.0.0.1:{service.socket.getsockname()[1]}/v6.json"
        with subprocess.Popen([sys.executable, str(CLIENTS / "leap.py"), server.address, address]) as program:
            found = places(server, program)
        service.shutdown()
    assert said == ['{"background":true}']
    check_button(found)


def test_a_palm_before_a_camera_feels_the_button(server: PointServer, tmp_path: Path) -> None:
    # A flat hand in m, in the camera's axes: to the right, down, away.
    rng = np.random.default_rng(1)
    hand = np.c_[rng.uniform(-0.05, 0.05, (21, 2)), np.zeros(21)]
    hand -= hand[[0, 5, 9, 13, 17]].mean(axis=0)
    track = []
    for place in TRACK:
        if place is None:
            track.append({"landmarks": [], "worldLandmarks": []})
            continue
        x, y, z = np.array(place) - [0, -0.12, 0]
        seen = (hand + np.array([-x, -y, z])) / np.tan(np.pi / 3)
        across, down = 0.5 + seen[:, 0] / z / 2, 0.5 + seen[:, 1] / z / 2 * 640 / 480
        middle = np.array([across, down])[:, [0, 5, 9, 13, 17]].mean(axis=1)
        assert ((middle > 0) & (middle < 1)).all(), "the camera sees the palm"
        rows = [{"x": u, "y": v, "z": 0.0} for u, v in zip(across, down, strict=True)]
        world = [{"x": u, "y": v, "z": w} for u, v, w in hand.tolist()]
        track.append({"landmarks": [rows], "worldLandmarks": [world]})
    (script,) = re.findall(r"<script type=\"module\">(.*?)</script>", (CLIENTS / "hand.html").read_text("utf-8"), re.S)
    assert script.count("await import(`${MEDIAPIPE}/vision_bundle.mjs`)") == 1
    (tmp_path / "track.json").write_text(json.dumps(track), "utf-8")
    page = tmp_path / "page.mjs"
    page.write_text(HAND_PAGE % script.replace("await import(`${MEDIAPIPE}/vision_bundle.mjs`)", "bundle"), "utf-8")
    words = [
        "--experimental-websocket",
        "--no-warnings",
        str(page),
        server.address,
        str(tmp_path / "track.json"),
    ]
    with subprocess.Popen([node(), *words]) as program:
        found = places(server, program)
    check_button(found)
