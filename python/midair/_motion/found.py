"""Found: frames of a sequence block after block, each from the last one or with some of the next in sight."""

from __future__ import annotations

from itertools import islice
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .._midair import Solver
from .ahead import Tracks
from .drives import coded
from .horizon import Horizon
from .request import Request

#: What a solver remembers of its last frame.
REMEMBERED = ("drives", "weights", "unevenness")


class Found(Protocol):
    """Finds frames in their order.

    board : the quantization of the drives, None for that of the array
    """

    board: dict[str, Any] | None

    def block(self, frames: slice) -> NDArray[Any]:
        """Drives or codes (frames, N) of the frames after those of the last block."""

    def state(self) -> dict[str, Any]:
        """What it has to know to go on after the last block."""

    def restore(self, done: int, state: dict[str, Any]) -> None:
        """Go on after the frame `done` - 1."""


class Followed:
    """By a solver, each frame from the last one; `exact` where its phases are the board's."""

    def __init__(self, asked: Request, solver: Solver, exact: bool) -> None:
        self.board: dict[str, Any] | None = asked.options.get("quantization")
        self._asked = asked
        self._solver = solver
        self._phases = asked.board.get("phases") if exact and asked.full else None

    def block(self, frames: slice) -> NDArray[Any]:
        drives = self._solver.follow(self._asked.points[frames], self._asked.targets[frames])
        return drives if self._phases is None else coded(drives, self._phases)

    def state(self) -> dict[str, Any]:
        last = self._solver.last()
        return {} if last is None else dict(zip(REMEMBERED, last, strict=True))

    def restore(self, done: int, state: dict[str, Any]) -> None:
        if state:
            self._solver.restore(state["drives"], state["weights"], float(state["unevenness"]))


class Foreseen:
    """By tracks, each frame with some of the next in sight."""

    def __init__(self, asked: Request, tracks: Tracks, ahead: int) -> None:
        self.board: dict[str, Any] | None = tracks.board
        self._asked = asked
        self._tracks = tracks
        self._ahead = ahead
        self._horizon = Horizon(tracks, zip(asked.points, asked.targets, strict=True), ahead)

    def block(self, frames: slice) -> NDArray[Any]:
        points, targets = self._asked.points[frames], self._asked.targets[frames]
        return self._tracks.played(points, targets, np.stack(list(islice(self._horizon, len(points)))))

    def state(self) -> dict[str, Any]:
        return self._horizon.state()

    def restore(self, done: int, state: dict[str, Any]) -> None:
        rest = zip(self._asked.points[done - 1 :], self._asked.targets[done - 1 :], strict=True)
        self._horizon = Horizon(self._tracks, rest, self._ahead, done, state)
