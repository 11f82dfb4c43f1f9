"""Playing one drive: sent anew while it lasts, off at the end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, SceneError, Solution, field
from .._points.ear import Ear
from .._support.arguments import number, refused
from .connection import Connection, connect
from .errors import BoardError


class Limit:
    """Refuses drives that are too loud somewhere.

    given : {"positions": (K, 3) in m or a midair.Ear, "pressure": peak |p| in Pa, one or (K,)}; what else it
        holds is for `midair.Scene`: temperature, sound_speed, ...
    array : that plays
    """

    def __init__(self, given: Any, array: Array) -> None:
        form = (
            'give {"positions": [[x, y, z]], "pressure": 200}, positions in m or an ear, the pressure in Pa'
        )
        if not isinstance(given, Mapping) or not {"positions", "pressure"} <= given.keys():
            raise refused("limit", given, form)
        more = {**given}
        positions, pressure = more.pop("positions"), more.pop("pressure")
        try:
            points = positions.points if isinstance(positions, Ear) else np.atleast_2d(positions)
            self._scene = Scene(array, points, **more)
            most = np.asarray(pressure, np.float64)
            self._most = np.broadcast_to(most, len(self._scene.points))
        except TypeError as error:
            raise refused("limit", given, f"{error}; {form}") from error
        except ValueError as error:
            raise refused("limit", given, str(error)) from error
        if not (np.isfinite(self._most) & (self._most >= 0)).all():
            raise refused('limit["pressure"]', pressure, "give pressures of at least 0 Pa")

    def check(self, drive: NDArray[np.complex64]) -> None:
        """Raise BoardError where the drive's |p| is above the limit, naming the place that is worst."""
        pressures = np.abs(field(self._scene, drive, self._scene.points).pressure)
        above = pressures - self._most
        worst = int(np.argmax(above))
        if not above[worst] <= 0:
            place = ", ".join(f"{x:.4g}" for x in self._scene.points[worst])
            raise BoardError(
                f"limit at ({place}) m is {self._most[worst]:.4g} Pa, this drive makes "
                f"{pressures[worst]:.4g} Pa: ask for less, or for a quiet point there"
            )


#: A drive that stays is sent anew every so many seconds, well before a connection's `hold` runs out.
AGAIN = 10.0

#: Seconds between two looks at what the board does.
LOOK = 0.1


def keep(
    connection: Connection,
    solution: Solution,
    seconds: float | None,
    show: Callable[[], object] = lambda: None,
) -> None:
    """Play one drive for so many seconds; None plays it until Ctrl-C."""
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

    address, options : as `midair.connect` takes them
    seconds : how long; left out, until Ctrl-C

    Raises SceneError for a time that is not above 0 and for a solution without a scene, and what
    `midair.connect` and `send` raise.

    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.1]])
    >>> midair.solve(scene).play("sonicsurface:loop", seconds=0.1)
    """
    duration = None if seconds is None else number("seconds", seconds, above=0)
    if solution.scene is None:
        raise SceneError("solution.scene is None: give a solution of a Scene, whose array the board drives")
    given = {} if "board" in options else {"array": solution.scene.array}
    with connect(address, **{**given, **options}) as connection:
        keep(connection, solution, duration)
