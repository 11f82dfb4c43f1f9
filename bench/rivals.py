"""The compared programs, each in a process and an environment of its own, with one thread; their tasks."""

import json
import os
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

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

BENCH = Path(__file__).parent
ENVIRONMENTS, WORKERS = BENCH / ".envs", BENCH / "workers"
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("RAYON", "OMP", "OPENBLAS", "MKL")} | {"MIDAIR_THREADS": "1"}


class Rival(NamedTuple):
    """A program's command, a file that it needs, and how to get that file."""

    name: str
    command: tuple[str, ...]
    needs: Path
    cure: str


def _library(name: str, cure: str, *arguments: str) -> Rival:
    folder = ENVIRONMENTS / name
    command = (str(folder / "bin" / "python"), str(WORKERS / f"{name}_worker.py"), *arguments)
    return Rival(name, command, folder / "ready", cure)


def _textbook(name: str, library: str) -> Rival:
    path = ENVIRONMENTS / f"{library}.so"
    command = (sys.executable, str(WORKERS / "textbook_worker.py"), str(path))
    return Rival(name, command, path, f"`make bench/.envs/{library}.so` compiles it")


def _crate(name: str) -> Rival:
    path = ENVIRONMENTS / name
    return Rival(name, (str(path),), path, f"`make bench/.envs/{name}` builds it")


RIVALS = (
    Rival("midair", (sys.executable, str(WORKERS / "midair_worker.py")), BENCH, ""),
    _library("autd3", "`make bench/.envs/autd3/ready` installs it"),
    _crate("autd3-rs"),
    _library("acoustools", "`make bench-peers ACOUSTOOLS=1` installs it (torch: some GB)", "-cpu"),
    _textbook("textbook f64", "textbook"),
    _textbook("textbook f32", "planar"),
)


class Worker:
    """The running process of a program; ends with the `with` block."""

    def __init__(self, rival: Rival) -> None:
        self.name = rival.name
        self._process = subprocess.Popen(
            rival.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
            env=os.environ | ONE_THREAD,
        )
        assert self._process.stdin
        assert self._process.stdout
        self._in, self._out = self._process.stdin, self._process.stdout
        hello = self._hear("it said what it offers")
        self.version: str = hello["version"]
        self.methods: list[str] = hello["methods"]
        self.forms: list[str] = hello["forms"]

    def __enter__(self) -> "Worker":
        return self

    def __exit__(self, *_: object) -> None:
        with self._process:
            self._process.kill()

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Sends a request and returns the reply (workers/serve.py)."""
        with suppress(BrokenPipeError):  # without the reply, `_hear` reports the failure
            self._in.write(json.dumps(request) + "\n")
            self._in.flush()
        return self._hear(f"it answered {request['method']}, M = {len(request['points'])}")

    def _hear(self, event: str) -> dict[str, Any]:
        line = self._out.readline()
        if not line:
            raise SystemExit(f"{self.name} ended before {event}; its own words are above")
        message: dict[str, Any] = json.loads(line)
        return message


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
