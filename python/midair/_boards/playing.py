"""Plays one drive for some time: `Solution.play` and `midair play`."""

import math
import time
from collections.abc import Callable
from itertools import count
from typing import Any

from .._midair import Solution, stated
from .._support.arguments import number
from . import connection as connections
from .connection import Connection

#: Time in s after which a drive is sent again, so that the connection's `hold` time does not expire.
AGAIN = 10.0

#: Seconds between two checks of the board's state.
LOOK = 0.1


def keep(
    connection: Connection,
    solution: Solution,
    seconds: float | None,
    show: Callable[[], object] = lambda: None,
) -> None:
    """Play one drive for a number of seconds, or until Ctrl-C if None. Calls `show` repeatedly."""
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

    Parameters
    ----------
    solution : midair.Solution
        The solution to play.
    address : str
        The board and its place, as for `midair.connect`.
    seconds : float, optional
        Duration in s; by default until Ctrl-C.
    **options
        Other arguments of `midair.connect`.

    Raises
    ------
    SceneError
        For a duration that is not above 0 and for a solution without a scene.
    BoardError
        As for `midair.connect` and `Connection.send`.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.1]])
    >>> midair.solve(scene).play("sonicsurface:loop", seconds=0.1)
    """
    duration = None if seconds is None else number("seconds", seconds, above=0)
    if solution.scene is None:
        cure = "give a solution of a Scene, whose array the board drives"
        raise stated("solution.scene", "is None", cure, code="missing")
    given = {} if "board" in options else {"array": solution.scene.array}
    with connections.connect(address, **{**given, **options}) as connection:
        keep(connection, solution, duration)
