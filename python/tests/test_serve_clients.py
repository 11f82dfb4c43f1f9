"""The clients in examples/serve against `midair serve`:
the Python client, and the web page's script in Node.
"""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import midair

pytest.importorskip("websockets")
pytest.importorskip("pythonosc")

from pythonosc.osc_message_builder import OscMessageBuilder

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
    node = shutil.which("node")
    probe = ["--experimental-websocket", "--eval", "WebSocket"]
    if node is None or subprocess.run([node, *probe], capture_output=True, check=False).returncode:
        pytest.skip("there is no Node with WebSocket, 20.10 or newer")
    (script,) = re.findall(r"<script>(.*?)</script>", (CLIENTS / "client.html").read_text("utf-8"), re.S)
    page = tmp_path / "page.mjs"
    page.write_text(PAGE % script, "utf-8")
    command = [node, "--experimental-websocket", str(page), server.address]
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
