"""Tracks over many frames, found by the core, and the amplitudes that bring them down to the targets."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, SceneError, tracks
from .._support.arguments import refused
from .drives import Drives, narrow, sounding
from .propagation import pressures

#: Phases where the board has any.
PHASES = 256

#: Rounds of tracks, point phases and weights: after ten the level grows by less than a thousandth a round.
ROUNDS = 10

#: The same for a closed curve, which is played for ever: up to two thousandths louder than after ten.
ROUNDS_CLOSED = 20

#: The same where tracks go on from others: after five.
ROUNDS_MORE = 5


@dataclass(frozen=True)
class Tracks:
    """How tracks are found and played, for frames of the array and the air of a scene.

    change : the bound in rad a frame
    board : the board's quantization, which has phases
    lowered : whether amplitudes bring frames down to their targets
    coded : whether codes tell all
    """

    scene: Scene
    change: float
    board: dict[str, Any]
    lowered: bool
    coded: bool

    def find(
        self,
        points: NDArray[np.float64],
        targets: NDArray[np.float64],
        *,
        closed: bool = False,
        start: NDArray[np.uint16] | None = None,
        first: int = 0,
        progress: Callable[[int, int], object] | None = None,
    ) -> NDArray[np.uint16]:
        """Codes (T, N) for points (T, M, 3) and targets (T, M).

        start : codes (T, N) to begin with, the first of which stay
        first : the number of frames before these, by which errors name them
        """
        if not (targets > 0).any():
            still = np.zeros((1, len(self.scene.array)), np.uint16) if start is None else start[:1]
            return np.repeat(still, len(points), axis=0)
        if len(points) == 1:
            # A frame alone is one that stands still.
            twice = [np.repeat(table, 2, axis=0) for table in (points, targets)]
            return self.find(*twice, first=first, progress=progress)[:1]
        rounds = ROUNDS_CLOSED if closed else ROUNDS
        try:
            return tracks(
                self.scene,
                points,
                targets,
                change=self.change,
                phases=self.board["phases"],
                closed=closed,
                rounds=rounds if start is None else ROUNDS_MORE,
                start=start,
                progress=None if progress is None else lambda step, steps, _: progress(step, steps),
            )
        except SceneError as error:
            found = re.match(r"(points|targets)\[(\d+)(.*)", str(error), re.DOTALL)
            if found is None:
                raise
            raise SceneError(f"{found[1]}[{int(found[2]) + first}{found[3]}") from None

    def played(
        self, points: NDArray[np.float64], targets: NDArray[np.float64], codes: NDArray[np.uint16]
    ) -> NDArray[Any]:
        """The codes themselves where they tell all, else drives (T, N): silent where no point is there."""
        if self.coded:
            return narrow(codes, self.board["phases"])
        full = Drives(codes, sounding(self.scene.array), self.board["phases"])
        over = np.zeros(len(targets))
        if self.lowered:
            got = pressures(self.scene, points, full)
            with np.errstate(divide="ignore", invalid="ignore"):
                over = np.where(targets > 0, got / targets, 0).max(axis=1)
        part = np.where((targets > 0).any(axis=1), 1 / np.maximum(over, 1), 0)
        if self.board.get("amplitudes") is not None:
            table = np.asarray(self.board["amplitudes"])
            part = np.r_[0.0, table][np.searchsorted(table, part * (1 + 1e-9), side="right")]
        return full[:] * part[:, None].astype(np.float32)


def board_of(quantization: dict[str, Any] | None) -> dict[str, Any]:
    """A board on which tracks are found: as given, with phases."""
    board = dict(quantization or {})
    return {**board, "phases": board.get("phases") or PHASES}


def check(solver: str, tau: Any, aim: Any, options: Iterable[str]) -> None:
    """Refuse what tracks do not know."""
    if solver != "glide":
        raise refused("solver", solver, "with ahead the tracks are found by themselves, leave it out")
    if tau is not None:
        raise refused("tau", tau, "with ahead the tracks take no account of it: leave out tau, or ahead")
    if aim not in (None, "target", "max"):
        raise refused("aim", aim, 'give "target" or "max"')
    if unknown := set(options) - {"quantization"}:
        raise SceneError(f"{min(unknown)} is given: with ahead there is no such option, leave it out")
