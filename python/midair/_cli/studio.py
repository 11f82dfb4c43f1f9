"""`midair studio` serves the studio's web page."""

import threading
import webbrowser
from contextlib import ExitStack
from pathlib import Path

from .. import Board, connect
from .._boards.address import DEFAULT, parse
from .._studio.page import greeting, scene_text
from .._studio.server import HOLD, PagesBoard, Server
from .progress import tell
from .scene import SceneFile


def studio_command(
    scene: Path | None = None, *, port: int = 0, browser: bool = True, on: str | None = None
) -> int:
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
            name = parse(on).board or DEFAULT
            board = Board(name, None if shown is None else shown.array)
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
