"""Arguments of paths: targets, times and sets of points, each checked; errors state name, value and cure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import SceneError
from .._support.arguments import real, refused

#: Functions of times (T,): ways (T, M), places (T, M, 3), targets (T, M).
Numbers: TypeAlias = NDArray[np.float64]

#: Rounding of times, in parts of a frame or of a period, never decides the side of a step.
ROUNDING = 1e-9


def mixed(before: Numbers, after: Numbers, shares: Numbers) -> Numbers:
    """Before at share 0, after at share 1, linear between; exact at both and at rest."""
    return np.where(shares == 1, after, before + shares * (after - before))


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece(ABC):
    """M points that move for a time; `place`, `pace` and `level` get times within it only."""

    #: M.
    points: int
    #: A time in s.
    duration: float
    #: Whether the end joins the start: a time after the end is one after the start.
    closed: bool
    #: Whether targets are in Pa, or relative to full.
    pascals: bool
    #: Highest frequency of amplitude modulation, in Hz.
    modulation: float = 0.0

    @abstractmethod
    def place(self, times: Numbers) -> Numbers:
        """Places (T, M, 3) in m."""

    @abstractmethod
    def pace(self, times: Numbers) -> Numbers:
        """Speeds (T, M) in m/s."""

    @abstractmethod
    def level(self, times: Numbers) -> Numbers:
        """Targets (T, M)."""

    def within(self, times: Numbers) -> Numbers:
        """Map times into the piece: repeated if it is closed, else limited to its start or its end."""
        return times % self.duration if self.closed else times.clip(0.0, self.duration)


#: A distance in m; a scene rejects nearer ones for another reason.
FARTHEST = 1e6


def instants(value: ArrayLike) -> Numbers:
    """Check times (T,), finite."""
    cure = "give a list of finite times in s"
    found = real("times", value, cure)
    if found.ndim != 1 or not np.isfinite(found).all():
        raise refused("times", value, cure)
    return found


def constant_pressures(value: ArrayLike | None, points: int) -> Numbers:
    """Targets (M,): one for all points or one for each, in Pa; 1 by default."""
    return np.ones(points) if value is None else _pressures(value, (points,))


def changing_pressures(value: ArrayLike | None, frames: int, points: int) -> Numbers:
    """Targets (T, M): one for all, one for each point or one for each frame and point; else as above."""
    return np.ones((frames, points)) if value is None else _pressures(value, (frames, points))


def _pressures(value: ArrayLike, shape: tuple[int, ...]) -> Numbers:
    sizes = [shape[k:] for k in range(len(shape))]
    forms = ["one number", *(" x ".join(map(str, size)) for size in reversed(sizes))]
    cure = f"give numbers of at least 0 in Pa: {' or '.join(forms)}"
    found = real("pressures", value, cure)
    if found.shape not in ((), *sizes):
        raise SceneError(f"pressures has shape {found.shape}: {cure}")
    wrong = found[~(np.isfinite(found) & (found >= 0))]
    if wrong.size:
        raise refused("pressures", value, f"{wrong[0]:g} is among them, {cure}")
    return np.broadcast_to(found, shape)


def point_sets(item: str, value: Any) -> Numbers:
    """Frames (T, M, 3) of points: at least two, each of as many points."""
    cure = "give frames x points x 3 numbers in m, at least two frames of at least one point"
    if not isinstance(value, np.ndarray):
        value = _stacked(item, value, cure)
    found = real(item, value, cure)
    if found.ndim != 3 or found.shape[2] != 3 or len(found) < 2 or not found.shape[1]:
        raise SceneError(f"{item} has shape {found.shape}: {cure}")
    wrong = np.argwhere(~(np.abs(found) <= FARTHEST).all(axis=2))
    if len(wrong):
        frame, point = wrong[0]
        raise refused(
            f"point {point} of frame {frame}",
            found[frame, point],
            f"give three finite numbers, at most {FARTHEST:g}",
        )
    return found


def _stacked(item: str, value: Any, cure: str) -> Any:
    """Frames in a list as one array, where all have as many points."""
    try:
        frames = [np.asarray(frame) for frame in value]
    except (TypeError, ValueError):
        raise refused(item, value, cure) from None
    for index, frame in enumerate(frames):
        if frame.ndim != 2 or frame.shape[1] != 3:
            raise refused(f"frame {index} of {item}", frame, "give points x 3 numbers in m")
        if len(frame) != len(frames[0]):
            change = f"M changes from {len(frames[0])} to {len(frame)} at frame {index}"
            raise SceneError(f"{change}: join paths with a fade, a.then(b, fade=)")
    return np.stack(frames) if frames else np.zeros(0)
