"""The tasks of all compared programs: arrays, seeded points, targets, grid of the drives."""

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import midair

sys.path.append(str(Path(__file__).resolve().parents[1] / "python" / "tests"))
import oracle

SOUND_SPEED = 340.0  # m/s
WAVENUMBER = 2 * np.pi * 40e3 / SOUND_SPEED  # rad/m
HEIGHT = 0.15  # m
HALF = 0.1  # m, half the side of the square of points

METHODS = ("greedy 16 phases", "fast", "uniform", "best", "lm", "gspat", "gs", "wgs", "naive")
SEARCHES = METHODS[:2]
#: For tasks on a board, midair's greedy uses the board's phases and amplitudes by default.
BOARD_METHODS = ("greedy 256 x 16", *METHODS)
#: The grid of the drives: none (any |q| <= 1), or that of the preset's board.
NONE, BOARD = "none", "board"
#: Target of a single point relative to p1; it is within reach anywhere in the square.
ALONE = 0.85


@dataclass(frozen=True)
class Task:
    """M points with equal targets p1 / sqrt M; p1 is the array's highest pressure at (0, 0, HEIGHT)."""

    preset: str
    tiles: tuple[int, int] | None
    count: int
    methods: tuple[str, ...]
    rivals: tuple[str, ...]
    grid: str = NONE

    @cached_property
    def array(self) -> midair.Array:
        return midair.Array.preset(self.preset, self.tiles)

    def propagation(self, points: oracle.Real) -> oracle.Complex:
        """Returns G (M, N) in Pa in f64, of point sources."""
        return oracle.propagation(
            self.array.positions, points, source_pressure=self.array.source_pressure, sound_speed=SOUND_SPEED
        )

    def points(self, scene: int) -> oracle.Real:
        """Returns points (M, 3) in m, the same for the same scene number."""
        rng = np.random.default_rng([len(self.array), self.count, scene])
        flat = rng.uniform(-HALF, HALF, (self.count, 2))
        return np.column_stack([flat, np.full(self.count, HEIGHT)])

    @cached_property
    def targets(self) -> oracle.Real:
        """Returns targets (M,) in Pa."""
        p1 = np.abs(self.propagation(np.array([[0, 0, HEIGHT]]))).sum()
        return np.full(self.count, p1 * (ALONE if self.count == 1 else 1 / np.sqrt(self.count)))

    def request(self, scene: int) -> dict[str, Any]:
        """Returns a request of workers/serve.py without method, form and repeat."""
        return {
            "preset": self.preset,
            "tiles": self.tiles,
            "grid": self.grid,
            "positions": self.array.positions.tolist(),
            "source_pressure": self.array.source_pressure,
            "wavenumber": WAVENUMBER,
            "sound_speed": SOUND_SPEED,
            "points": self.points(scene).tolist(),
            "pressures": self.targets.tolist(),
            "seed": scene,
        }


_SEARCHERS = ("midair", "textbook f64", "textbook f32")
_ANY = (*_SEARCHERS, "acoustools")
#: autd3 always returns codes of its boards.
_BOARD = ("midair", "autd3", "autd3-rs")

TASKS = (
    *[Task("autd3", (2, 2), count, BOARD_METHODS, _BOARD, BOARD) for count in (1, 4, 8, 16, 64, 256)],
    *[Task("autd3", (2, 2), count, METHODS, _ANY) for count in (1, 4, 8, 16, 64)],
    Task("autd3", (2, 2), 256, METHODS, ("midair", "acoustools")),
    *[Task("paper20", None, count, SEARCHES, _SEARCHERS) for count in (4, 16, 64)],
    Task("paper36", None, 38, SEARCHES, _SEARCHERS),
)
