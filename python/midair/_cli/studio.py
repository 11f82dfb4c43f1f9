"""`midair studio`: the page where one touches the field, served to a browser of this machine."""

from __future__ import annotations

import threading
import webbrowser
from pathlib import Path

from .._studio.page import scene_text
from .._studio.server import Server
from .progress import tell
from .scene import SceneFile


def studio_command(scene: Path | None = None, *, port: int = 0, browser: bool = True) -> int:
    """Open the studio in the browser: points that can be dragged, and their field. Ctrl-C ends it.

    Parameters
    ----------
    scene
        Scene file to begin with, TOML or JSON, or - for standard input.
    port
        Of 127.0.0.1, where the page is served; left out, a free one.
    browser
        Open the browser; without, the address is printed alone.
    """
    text = None if scene is None else scene_text(SceneFile(scene).scene())
    with Server(text, port) as server:
        print(server.address, flush=True)
        tell("Ctrl-C ends it")
        if browser:
            # Apart, because a browser in the terminal comes back only when it is left.
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        server.serve_forever()
    return 0
