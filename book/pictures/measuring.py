"""docs/measuring.md: calibration and tuning of simulated arrays with faults that the model lacks (10 min).

The transducers are misplaced by 0.3 mm (standard deviation) and have errors of gain and phase; some are dead.
The fit does not know their directivity, that of a piston. The wall behind them returns an echo of 5 %, and
the sound speed is 346.1 m/s instead of 340 m/s.
"""

import time
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

import microphones
import midair
from microphones import BELIEVED, TRUE_SPEED, Complex, Real
from pictures import DOCS, head, line

ECHO, WALL = 0.05, 0.5
SEEDS = range(200, 210)
BAD = {"gain": 0.2, "phase": 40.0, "dead_part": 0.05, "reversed_part": 0.05}


@dataclass
class Rig(microphones.Rig):
    """A simulated array with its faults and echo, its microphones, and four new points."""

    radius: float = 4e-3
    height: float = 0.15

    def put(self) -> None:
        """Draws the places of the microphones, and new points."""
        middle = self.array.positions.mean(axis=0)
        count = self.microphones
        self.places = middle + np.c_[self.spots(count, 0.05), np.full(count, self.height)]
        self.given = self.places
        self.new = middle + np.c_[self.spots(4, 0.04), np.full(4, self.height)]

    def spots(self, count: int, reach: float) -> Real:
        """Returns random places, at least 20 mm apart."""
        while True:
            found = self.rng.uniform(-reach, reach, (count, 2))
            apart = np.linalg.norm(found[:, None] - found, axis=2) + np.eye(count)
            if apart.min() > 0.02:
                return found

    def matrix(self, points: Real) -> Complex:
        """Returns pressures (M, N) with the echo of the wall behind the array, from image sources."""
        return super().matrix(points) + ECHO * super().matrix(points * [1, 1, -1] + [0, 0, 2 * WALL])

    @cached_property
    def truth(self) -> Complex:
        """The pressures (4, N) at the new points."""
        return self.matrix(self.new)

    @cached_property
    def best(self) -> float:
        """The mean |p| of the true model's drive at the new points."""
        drive = midair.solve(midair.Propagation(self.truth), "uniform").drive
        return float(np.abs(self.truth @ drive).mean())

    def level(self) -> float:
        """Returns the level to which the noise is relative: that of the true model's drive."""
        return self.best

    def judged(self, drive: Any) -> tuple[float, float]:
        """Returns mean |p| at the new points, relative to a solve with the true model, and min/max of |p|."""
        p = np.abs(self.truth @ drive)
        return float(p.mean() / self.best), float(p.min() / p.max())

    def solved(self, array: midair.Array, speed: float) -> tuple[float, float]:
        """Returns what `judged` returns, for a drive that is solved with this array and sound speed."""
        return self.judged(midair.solve(midair.Scene(array, self.new, sound_speed=speed), "uniform").drive)


def calibrated(rig: Rig, readings: float, decibels: float) -> tuple[midair.Calibration, float]:
    """Returns a calibration and its CPU time in s."""
    drives = midair.calibration_drives(rig.array, readings, microphones=rig.microphones, seed=rig.seed)
    received = rig.read(drives, decibels, False)
    began = time.process_time()
    found = midair.calibrate(rig.array, drives, received, microphones=rig.given)
    return found, time.process_time() - began


def row(name: str, readings: float, decibels: float, seeds: Any = SEEDS, **keywords: Any) -> None:
    """Prints a row of the first table: means over random arrays, and the worst."""
    results, models, dead = [], [], np.zeros(3, int)
    for seed in seeds:
        rig = Rig(seed, **keywords)
        found, cpu = calibrated(rig, readings, decibels)
        off = abs(found.sound_speed - TRUE_SPEED)
        results.append((*rig.solved(found.array, found.sound_speed), off, cpu))
        models.append(rig.solved(rig.array, BELIEVED)[0])
        right = len(np.intersect1d(found.dead, rig.dead))
        dead += [right, len(rig.dead), len(found.dead) - right]
    levels, evens, speeds, seconds = np.array(results).T
    quality = [f"{np.mean(models):.3f}", f"{levels.mean():.3f}", f"{levels.min():.3f}", f"{evens.mean():.2f}"]
    counts = f"{dead[0]} of {dead[1]}, {dead[2]}"
    line(name, *quality, counts, f"{speeds.max():.1f}", f"{seconds.mean():.1f}")


def tuned(name: str, decibels: float, method: Any, **keywords: Any) -> None:
    """Prints a row of the second table: tuning with readings at the points themselves."""
    results, readings = [], 0
    for seed in SEEDS[:5]:
        rig = Rig(seed)
        sd = rig.noise(decibels)

        def read(drive: Any, rig: Rig = rig, sd: float = sd) -> Any:
            return np.abs(np.abs(rig.truth @ drive) + sd * rig.rng.normal(size=4))

        before = rig.solved(rig.array, BELIEVED)
        found = midair.tune(read, midair.Scene(rig.array, rig.new), method, **keywords)
        results.append((before, rig.judged(found.drive)))
        readings = found.readings
    line(
        name,
        f"{decibels:g} dB",
        readings,
        *(f"{level:.3f} / {even:.2f}" for level, even in np.mean(results, axis=0)),
    )


def main() -> None:
    """Prints the tables and draws the picture."""
    calibrated(Rig(1, reversed_part=0.03), 4, 60)[0].plot().savefig(DOCS / "measuring.png", dpi=110)
    head("readings", "model", "calibrated", "worst", "min/max", "dead found, wrongly", "m/s off", "CPU s")
    row("4 a transducer of |p|, 40 dB", 4, 40)
    row("2, 40 dB", 2, 40)
    row("4, 40 dB, one microphone", 4, 40, microphones=1)
    row("bad array, 4, 40 dB", 4, 40, **BAD)
    four = midair.Array(midair.Array.preset("autd3", (2, 2)).positions)
    row("four AUTD3 boards (996), 4, 60 dB", 4, 60, seeds=SEEDS[:2], array=four, height=0.2)
    print()
    head("way", "noise", "readings", "model: level / min/max", "tuned")
    for decibels in (60, 40):
        tuned("greedy, 3 readings a turn", decibels, "greedy")
        tuned("greedy from the model's answer", decibels, "greedy", start="model")
        tuned("spsa", decibels, "spsa")
