"""Results of calibration and tuning for arrays with faults that the model does not include.

Prints the tables of docs/measuring.md and draws docs/measuring.png. The arrays are simulated in float64:
transducers misplaced by 0.3 mm (standard deviation), errors of gain and phase, some dead, a piston's
directivity unknown to the fit, an echo of 5 % from a wall behind, and air with 346.1 m/s instead of 340.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import j1

import midair

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]

BELIEVED, SPEED, RADIUS, ECHO, WALL, JITTER = 340.0, 346.1, 4e-3, 0.05, 0.5, 0.3e-3
SEEDS = range(200, 210)
BAD = {"gain": 0.2, "phase": 40.0, "dead": 0.05, "turned": 0.05}


@dataclass
class Rig:
    """A simulated array with its faults, its microphones, and four new points."""

    seed: int
    array: midair.Array = field(default_factory=lambda: midair.Array.grid(16, 16, 10e-3))
    gain: float = 0.1
    phase: float = 20.0
    dead: float = 0.03
    turned: float = 0.0
    microphones: int = 4
    height: float = 0.15
    misplaced: float = 0.0
    fixed: bool = False

    def __post_init__(self) -> None:
        """Draws the random errors."""
        self.rng = rng = np.random.default_rng(self.seed)
        n = len(self.array)
        self.positions = self.array.positions + rng.normal(0, JITTER, (n, 3))
        phases = np.radians(self.phase) * rng.normal(size=n)
        self.response = (1 + self.gain * rng.normal(size=n)) * np.exp(1j * phases)
        drawn = rng.permutation(n)
        dead, turned = round(self.dead * n), round(self.turned * n)
        self.silent, self.reversed = drawn[:dead], drawn[dead : dead + turned]
        self.response[self.silent] = 0
        self.response[self.reversed] *= -1
        middle = self.array.positions.mean(axis=0)
        self.places = (
            middle + np.c_[self.spots(self.microphones, 0.05), np.full(self.microphones, self.height)]
        )
        off = np.random.default_rng([self.seed, 1]).normal(size=self.places.shape)
        self.given = self.places + self.misplaced * off
        self.new = middle + np.c_[self.spots(4, 0.04), np.full(4, self.height)]
        self.truth = self.matrix(self.new)
        self.best = np.abs(self.truth @ midair.solve(midair.Propagation(self.truth), "uniform").drive).mean()

    def spots(self, count: int, reach: float) -> Real:
        """Returns random places, at least 20 mm apart."""
        while True:
            found = self.rng.uniform(-reach, reach, (count, 2))
            apart = np.linalg.norm(found[:, None] - found, axis=2) + np.eye(count)
            if apart.min() > 0.02:
                return found

    def matrix(self, points: Real) -> Complex:
        """Returns pressures (M, N): eq. (5) with a piston's directivity, and the echo of a wall.

        The wall is behind the array; image sources give its echo.
        """
        number = 2 * np.pi * 40e3 / SPEED
        found = np.zeros((len(points), len(self.positions)), complex)
        for share, places in ((1.0, points), (ECHO, points * [1, 1, -1] + [0, 0, 2 * WALL])):
            rays = places[:, None] - self.positions
            r = np.linalg.norm(rays, axis=2)
            x = np.maximum(number * RADIUS * np.linalg.norm(rays[..., :2], axis=2) / r, 1e-9)
            found += share * 4.386 / r * 2 * j1(x) / x * np.exp(1j * number * r)
        return np.asarray(found * self.response)

    def noise(self, decibels: float) -> float:
        """Returns a standard deviation in Pa, this many decibels below the level of the four foci."""
        return float(self.best * 10 ** (-decibels / 20))

    def read(self, drives: Any, decibels: float, phased: bool) -> Any:
        """Returns readings (K, M) of drives (K, N), with noise."""
        p = drives @ self.matrix(self.places).T
        parts = self.noise(decibels) * self.rng.normal(size=(2, *p.shape))
        return p + (parts[0] + 1j * parts[1]) / np.sqrt(2) if phased else np.abs(np.abs(p) + parts[0])

    def kept(self, drive: Any) -> tuple[float, float]:
        """Returns mean |p| at the new points, relative to a solve with the true model, and min/max of |p|."""
        p = np.abs(self.truth @ drive)
        return float(p.mean() / self.best), float(p.min() / p.max())

    def solved(self, array: midair.Array, speed: float) -> tuple[float, float]:
        """Returns what `kept` returns, for a drive that is solved with this array and sound speed."""
        return self.kept(midair.solve(midair.Scene(array, self.new, sound_speed=speed), "uniform").drive)


def calibrated(
    rig: Rig, readings: float, decibels: float, phased: bool = False
) -> tuple[midair.Calibration, float]:
    """Returns a calibration and its CPU time in s."""
    drives = midair.calibration_drives(rig.array, readings, microphones=rig.microphones, seed=rig.seed)
    received = rig.read(drives, decibels, phased)
    began = time.process_time()
    error = 0 if rig.fixed else None
    found = midair.calibrate(rig.array, drives, received, microphones=rig.given, microphones_error=error)
    return found, time.process_time() - began


def row(
    name: str, readings: float, decibels: float, phased: bool = False, seeds: Any = SEEDS, **keywords: Any
) -> None:
    """Prints a row of the first table: medians over random arrays."""
    levels, evens, models, speeds, seconds, dead = [], [], [], [], [], np.zeros(3, int)
    for seed in seeds:
        rig = Rig(seed, **keywords)
        found, cpu = calibrated(rig, readings, decibels, phased)
        level, even = rig.solved(found.array, found.sound_speed)
        levels.append(level)
        evens.append(even)
        models.append(rig.solved(rig.array, BELIEVED)[0])
        speeds.append(abs(found.sound_speed - SPEED))
        seconds.append(cpu)
        right = len(np.intersect1d(found.dead, rig.silent))
        dead += [right, len(rig.silent), len(found.dead) - right]
    found_level = f"{np.mean(levels):.3f} | {min(levels):.3f} | {np.mean(evens):.2f}"
    found_dead = f"{dead[0]} of {dead[1]}, {dead[2]}"
    reported = f"{max(speeds):.1f} | {np.mean(seconds):.1f}"
    print(f"| {name} | {np.mean(models):.3f} | {found_level} | {found_dead} | {reported} |", flush=True)


def tuned(name: str, decibels: float | None, method: Any, **keywords: Any) -> None:
    """Prints a row of the second table: tuning with readings at the points themselves."""
    before, after, readings = [], [], 0
    for seed in SEEDS[:5]:
        rig = Rig(seed)
        sd = 0.0 if decibels is None else rig.noise(decibels)

        def read(drive: Any, rig: Rig = rig, sd: float = sd) -> Any:
            return np.abs(np.abs(rig.truth @ drive) + sd * rig.rng.normal(size=4))

        before.append(rig.solved(rig.array, BELIEVED))
        found = midair.tune(read, midair.Scene(rig.array, rig.new), method, **keywords)
        after.append(rig.kept(found.drive))
        readings = found.readings
    (level0, even0), (level, even) = np.mean(before, axis=0), np.mean(after, axis=0)
    reported = "-" if decibels is None else f"{decibels:g} dB"
    print(
        f"| {name} | {reported} | {readings} | {level0:.3f} / {even0:.2f} | {level:.3f} / {even:.2f} |",
        flush=True,
    )


def main() -> None:
    """Prints the tables and draws the picture."""
    rig = Rig(1, turned=0.03)
    calibrated(rig, 4, 60)[0].plot().savefig(Path(__file__).parents[1] / "docs" / "measuring.png", dpi=110)
    print("| readings | model | calibrated | worst | min/max | dead found, wrongly | m/s off | CPU s |")
    print("|---|---|---|---|---|---|---|---|")
    row("4 a transducer of \\|p\\|, 40 dB", 4, 40)
    row("4, 40 dB, microphones fixed", 4, 40, fixed=True)
    row("4, 40 dB, microphones 1 mm off", 4, 40, misplaced=1e-3)
    row("4, 30 dB, 15 % dead", 4, 30, dead=0.15)
    row("4, 60 dB", 4, 60)
    row("2, 40 dB", 2, 40)
    row("2, 60 dB", 2, 60)
    row("4, 40 dB, one microphone", 4, 40, microphones=1)
    row("4, 60 dB, one microphone", 4, 60, microphones=1)
    row("2 complex, 40 dB", 2, 40, phased=True)
    row("bad array, 4, 40 dB", 4, 40, **BAD)
    row("bad array, 4, 60 dB", 4, 60, **BAD)
    four = midair.Array(midair.Array.preset("autd3", (2, 2)).positions)
    row("four AUTD3 boards (996), 4, 60 dB", 4, 60, seeds=SEEDS[:2], array=four, height=0.2)
    print("\n| way | noise | readings | model: level / min/max | tuned |")
    print("|---|---|---|---|---|")
    tuned("greedy, 3 readings a turn", None, "greedy")
    tuned("greedy, all 16 tried (the paper's)", None, "greedy", tries=True)
    tuned("greedy, 3 readings a turn", 60, "greedy")
    tuned("greedy from the model's answer", 60, "greedy", start="model")
    tuned("greedy from the model's answer", 40, "greedy", start="model")
    tuned("feedback", 40, "feedback")
    tuned("spsa", 60, "spsa")
    tuned("spsa", 40, "spsa")


if __name__ == "__main__":
    main()
