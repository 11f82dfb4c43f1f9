"""`midair serve` plays points that other programs send."""

import sys

from .. import Connection, connect
from .._serve.life import SILENCE
from .._serve.live import Live
from .._support.arguments import needs
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
        Largest change of a phase between two frames, in rad; by default pi/16.
    """
    with needs("serve needs websockets and python-osc", "serve"):
        from .._serve.server import PointServer

    def connected() -> Connection:
        return connect(on, hold=SILENCE)

    sys.setswitchinterval(SWITCH)
    with connected() as connection:
        live = Live(connection, rate, change, again=connected)
        with PointServer(live, port, osc, origin or ()) as server:
            print(server.address, flush=True)
            print(f"osc://127.0.0.1:{server.osc} token {server.token}", flush=True)
            print(f"{server.adaptics} for Adaptics Designer", flush=True)
            tell("Ctrl-C ends it")
            live.wait()
    return 0
