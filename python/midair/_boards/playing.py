"""Playing one drive: repeats it while it lasts, and turns off at the end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from itertools import count
from typing import Any

from .._midair import SceneError, Solution
from .._support.arguments import number
from . import connection as connections
from .connection import Connection

#: Time in s after which a drive is sent again, well before a connection's `hold` expires.
AGAIN = 10.0

#: Seconds between two checks of the board's state.
LOOK = 0.1


def keep(
    connection: Connection,
    solution: Solution,
    seconds: float | None,
    show: Callable[[], object] = lambda: None,
) -> None:
    """Play one drive for a number of seconds; None plays it until Ctrl-C."""
    begin = time.monotonic()
    for k in count():
        if k % round(AGAIN / LOOK) == 0:
            connection.send(solution)
        left = math.inf if seconds is None else begin + seconds - time.monotonic()
        if left <= 0:
            return
        time.sleep(min(LOOK, left))
        show()


def play(solution: Solution, address: str, *, seconds: float | None = None, **options: Any) -> None:
    """Play a solution on a board, then turn the board off: `solution.play("autd3", seconds=5)`.

    address, options : arguments of `midair.connect`
    seconds : how long; by default until Ctrl-C

    Raises SceneError for a time that is not above 0 and for a solution without a scene, and the errors of
    `midair.connect` and `send`.

    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.1]])
    >>> midair.solve(scene).play("sonicsurface:loop", seconds=0.1)
    """
    duration = None if seconds is None else number("seconds", seconds, above=0)
    if solution.scene is None:
        raise SceneError("solution.scene is None: give a solution of a Scene, whose array the board drives")
    given = {} if "board" in options else {"array": solution.scene.array}
    with connections.connect(address, **{**given, **options}) as connection:
        keep(connection, solution, duration)
