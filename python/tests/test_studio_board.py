"""The board that the studio's page plays through its server:
only the page itself can, and it turns off in time.
"""

import http.client
import json
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import serve as command
from midair._studio.server import PagesBoard, Server
from midair._studio.view import greeting, scene_text
from pages import build

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60
BINARY = "application/octet-stream"


@pytest.fixture
def surface() -> Iterator[midair.Connection]:
    with midair.connect("sonicsurface:null", hold=1.0) as connection:
        yield connection


@pytest.fixture
def served(tmp_path: Path, surface: midair.Connection) -> Iterator[Server]:
    scene = scene_text(greeting(surface.board.array))
    board = PagesBoard(surface, scene)
    with Server(scene, folder=build(tmp_path / "built"), board=board) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def give(
    server: Server, content: bytes, at: float | str = 1, path: str = "/board", **headers: str | None
) -> tuple[int, str]:
    """Sends a request like the page's, apart from the given headers; returns its status and text."""
    own = f"127.0.0.1:{server.server_port}"
    all_headers = {"Host": own, "Origin": f"http://{own}", "Content-Type": BINARY} | {
        name.replace("_", "-"): value for name, value in headers.items()
    }
    line = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=HANG)
    try:
        kept = {name: value for name, value in all_headers.items() if value is not None}
        line.request("POST", f"{path}?{at}", content, kept)
        answer = line.getresponse()
        return answer.status, answer.read().decode()
    finally:
        line.close()


@pytest.fixture
def drive(surface: midair.Connection) -> np.ndarray:
    array = surface.board.array
    return midair.solve(midair.Scene(array, [[0, 0, 0.15]])).drive


def content(drive: np.ndarray) -> bytes:
    return drive.astype("<c8").tobytes()


def test_what_the_page_gives_is_played_until_it_gives_nothing(
    served: Server, surface: midair.Connection, drive: np.ndarray
) -> None:
    assert surface.state == "off"
    assert give(served, content(drive)) == (200, "")
    assert surface.state == "playing"
    np.testing.assert_allclose(surface.emitting, drive, atol=1e-5)
    assert give(served, b"", at=2) == (200, "")
    assert surface.state == "off"


def test_a_page_that_falls_silent_is_off_after_a_second(
    served: Server, surface: midair.Connection, drive: np.ndarray
) -> None:
    for at in range(1, 9):
        give(served, content(drive), at=at)
        time.sleep(0.25)
        assert surface.state == "playing"
    until = time.monotonic() + 3
    while surface.state == "playing" and time.monotonic() < until:
        time.sleep(0.05)
    assert surface.state == "off"


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": None},
        {"Origin": "null"},
        {"Origin": "http://example.org"},
        {"Origin": "http://127.0.0.1:1"},
        {"Origin": "http://localhost"},
        {"Host": "example.org", "Origin": "http://example.org"},
        {"Host": "evil.localhost", "Origin": "http://evil.localhost"},
    ],
)
def test_foreign_origins_are_refused(
    served: Server, surface: midair.Connection, drive: np.ndarray, headers: dict[str, str | None]
) -> None:
    assert give(served, content(drive), **headers)[0] == 403
    assert surface.state == "off"


def test_what_is_not_in_order_is_refused(served: Server, surface: midair.Connection, drive: np.ndarray) -> None:
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", None):
        assert give(served, content(drive), Content_Type=kind)[0] == 415
    for at in ("", "now", "-1", "1e3", "nan"):
        assert give(served, content(drive), at=at)[0] == 400
    assert give(served, content(drive), path="/midair.wasm")[0] == 404
    for wrong in (drive[:-1], np.append(drive, 1)):
        status, line = give(served, content(wrong))
        assert (status, "\n" in line) == (409, False)
        assert f"drive has {len(wrong)} transducers, sonicsurface has 256" in line
    status, line = give(served, content(np.full(256, np.nan, np.complex64)))
    assert (status, "\n" in line) == (409, False)
    assert surface.state == "off"


def test_what_was_overtaken_by_silence_is_not_played(
    served: Server, surface: midair.Connection, drive: np.ndarray
) -> None:
    assert give(served, b"", at=10) == (200, "")
    assert give(served, content(drive), at=9.5) == (200, "")
    assert surface.state == "off"


def test_a_board_that_is_gone_is_one_line(served: Server, surface: midair.Connection, drive: np.ndarray) -> None:
    surface.close()
    status, line = give(served, content(drive))
    assert status == 409
    assert line
    assert "\n" not in line


def test_the_page_knows_board_and_array(served: Server, tmp_path: Path) -> None:
    line = http.client.HTTPConnection("127.0.0.1", served.server_port, timeout=HANG)
    line.request("GET", "/board.json")
    reported = json.loads(line.getresponse().read())
    line.close()
    assert reported["name"] == "sonicsurface"
    assert reported["array"]["preset"] == "sonicsurface"
    assert served.address.endswith("/?scene&board")
    with Server(folder=tmp_path / "built") as other:
        assert other.address.endswith("/")


@pytest.mark.parametrize("preset", ["autd3", "sonicsurface_pair", "ultraino_flat8x8"])
def test_the_first_scene_of_a_board_can_be_solved(preset: str) -> None:
    scene = greeting(midair.Array.preset(preset))
    scene_text(scene)
    assert midair.solve(scene).metrics.uniformity > 0.9


def test_the_command_serves_a_board(monkeypatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    class Once(Server):
        def serve_forever(self, poll_interval: float = 0.5) -> None:
            assert self.board is not None
            assert self.board.connection.state == "off"

    monkeypatch.setattr(command, "Server", partial(Once, folder=build(tmp_path)))
    assert command.studio_command(browser=False, on="sonicsurface:null") == 0
    assert capsys.readouterr().out.strip().endswith("/?scene&board")
