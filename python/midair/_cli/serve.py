"""`midair serve` plays points that other programs send; `midair studio` serves the studio's web page."""

import gc
import sys
import threading
import webbrowser
from contextlib import ExitStack
from pathlib import Path

from .. import Connection, connect
from .._boards.address import board_at, parse
from .._serve.life import SILENCE
from .._serve.live import Live
from .._studio.server import HOLD, PagesBoard, Server
from .._studio.view import greeting, scene_text
from .._support.arguments import needs
from .given import SceneFile
from .progress import tell

#: Longest time in s for which one of this program's threads computes while another one is to play a frame.
SWITCH = 5e-4


def serve_command(
    *,
    on: str,
    port: int = 0,
    osc: int = 0,
    origin: list[str] | None = None,
    rate: float | None = None,
    change: float | None = None,
    token: str = "",
) -> int:
    """Play points that other programs on this machine send by WebSocket or OSC. Ctrl-C ends it.

    Parameters
    ----------
    on
        The board and its place: autd3, sonicsurface:/dev/ttyUSB0, sonicsurface:loop (docs/boards.md).
    port
        Port of 127.0.0.1 for WebSocket; by default a free one.
    osc
        Port of 127.0.0.1 for OSC over UDP; by default a free one.
    origin
        Web page that may connect, such as http://localhost:8000; may be repeated. By default none.
    rate
        Frames per second; by default the board's highest rate.
    change
        Largest change of a phase between two frames, in rad; by default 1963 rad/s, and at most pi.
    token
        Key that clients show, at least 16 letters; by default a new random one. Other users of this computer
        may see it in the list of programs.
    """
    with needs("serve needs websockets and python-osc", "serve"):
        from .._serve.server import PointServer

    def connected() -> Connection:
        return connect(on, hold=SILENCE)

    sys.setswitchinterval(SWITCH)
    with connected() as connection:
        live = Live(connection, rate, change, again=connected)
        with PointServer(live, port, osc, origin or (), token) as server:
            print(server.address, flush=True)
            print(f"osc://127.0.0.1:{server.osc} token {server.token}", flush=True)
            print(f"{server.adaptics} for Adaptics Designer", flush=True)
            tell("Ctrl-C ends it")
            # Looking for garbage among all objects would stop the frames for 60 ms.
            gc.freeze()
            live.wait()
    return 0


def studio_command(scene: Path | None = None, *, port: int = 0, browser: bool = True, on: str | None = None) -> int:
    """Open the studio in the browser: drag points and see their field. Ctrl-C ends it.

    Parameters
    ----------
    scene
        Scene file to show first, TOML or JSON, or - for standard input.
    port
        Port of 127.0.0.1 for the page; by default a free one.
    browser
        Open the browser; otherwise only print the address.
    on
        A board that the page may play, and its place: autd3, sonicsurface:/dev/ttyUSB0 (docs/boards.md).
    """
    shown = None if scene is None else SceneFile(scene).scene()
    with ExitStack() as open_things:
        player = None
        if on is not None:
            board = board_at(parse(on), None if shown is None else shown.array)
            shown = shown or greeting(board.array)
            connection = open_things.enter_context(connect(on, board=board, hold=HOLD))
            player = PagesBoard(connection, scene_text(shown))
        text = None if shown is None else scene_text(shown)
        server = open_things.enter_context(Server(text, port, board=player))
        print(server.address, flush=True)
        tell("Ctrl-C ends it")
        if browser:
            # In a thread, because a text browser in the terminal returns only when it is closed.
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        server.serve_forever()
    return 0
