"""Simulated arrays with errors that no model has, and simulated microphones.
The field is eq. (5) in float64 with the directivity of a piston.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import j1

import midair

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]

#: The sound speed that the model assumes, and the true sound speed, in m/s.
BELIEVED, TRUE_SPEED = 340.0, 346.1


@dataclass
class Rig:
    """Transducers with random errors of gain, phase and position, some of them dead or reversed."""

    seed: int
    gain: float = 0.1
    phase: float = 20.0
    dead_part: float = 0.03
    reversed_part: float = 0.0
    jitter: float = 0.3e-3
    radius: float = 0.0
    microphones: int = 4
    array: midair.Array = field(default_factory=lambda: midair.Array.grid(16, 16, 10e-3))
    rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        """Draws the random errors."""
        self.rng = rng = np.random.default_rng(self.seed)
        n = len(self.array)
        self.positions = self.array.positions + rng.normal(0, self.jitter, (n, 3))
        phases = np.radians(self.phase) * rng.normal(size=n)
        self.response = (1 + self.gain * rng.normal(size=n)) * np.exp(1j * phases)
        drawn = rng.permutation(n)
        dead, turned = round(self.dead_part * n), round(self.reversed_part * n)
        self.dead, self.reversed = np.sort(drawn[:dead]), np.sort(drawn[dead : dead + turned])
        self.response[self.dead] = 0
        self.response[self.reversed] *= -1
        self.put()

    def put(self) -> None:
        """Draws the places of the microphones, and new points."""
        rng = self.rng
        corners = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])[: self.microphones] * 0.03
        drawn_places = corners + rng.uniform(-0.015, 0.015, corners.shape)
        self.places = np.c_[drawn_places, np.full(len(corners), 0.15)]
        self.new = np.c_[rng.uniform(-0.04, 0.04, (4, 2)), np.full(4, 0.15)]

    def matrix(self, points: Real) -> Complex:
        """Returns the true pressures (M, N) in Pa of each transducer at full drive."""
        rays = points[:, None] - self.positions
        r = np.linalg.norm(rays, axis=2)
        number = 2 * np.pi * 40e3 / TRUE_SPEED
        x = np.maximum(number * self.radius * np.linalg.norm(rays[..., :2], axis=2) / r, 1e-9)
        return np.asarray(4.386 / r * 2 * j1(x) / x * np.exp(1j * number * r) * self.response)

    def level(self) -> float:
        """Returns the balanced level of four foci, in Pa. The noise in decibels is relative to this level."""
        return float(np.abs(self.matrix(self.new)).sum(1).mean() / 2)

    def noise(self, decibels: float) -> float:
        """Returns a standard deviation in Pa, this many decibels below `level`."""
        return self.level() * 10 ** (-decibels / 20)

    def read(self, drives: NDArray[np.complexfloating], decibels: float, phased: bool = False) -> Complex:
        """Returns the readings (K, M) of K drives, with noise this many decibels below `level`."""
        p = drives @ self.matrix(self.places).T
        noise = self.noise(decibels) * self.rng.normal(size=(2, *p.shape))
        return p + (noise[0] + 1j * noise[1]) / np.sqrt(2) if phased else np.abs(np.abs(p) + noise[0])

    def kept(self, array: midair.Array, sound_speed: float) -> float:
        """Returns the mean pressure of a model's drive at points without microphones,
        relative to the mean pressure of the true model's drive.
        """
        truth = self.matrix(self.new)
        best = midair.solve(midair.Propagation(truth), "uniform").drive
        found = midair.solve(midair.Scene(array, self.new, sound_speed=sound_speed), "uniform").drive
        return float(np.abs(truth @ found).mean() / np.abs(truth @ best).mean())
