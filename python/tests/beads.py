"""Simulates beads on a circle between two boards in double precision.

Written from the definitions, without the core: force and drag of `traps`, weight, buoyancy. The equation of
motion is integrated by the Runge-Kutta method of fourth order.
"""

import numpy as np

import traps
from oracle import Complex, Real

RADIUS = 0.018
#: Viscosity of air at 20 degrees Celsius, in Pa s.
VISCOSITY = 1.81e-5
#: Integration steps per frame, from 5 kHz: four of them change distances by .2 % at most.
STEPS = 1


def circle(count: int, speed: float, rate: float, laps: float = 1.0, start: float = 0.05) -> Real:
    """Returns points (T, M, 3) on a circle in the xz plane; their speed rises from 0 to `speed` within `start` s."""
    time = np.arange(round(rate * (start + laps * 2 * np.pi * RADIUS / speed))) / rate
    part = np.minimum(time / start, 1)
    way = speed * (start * (part**3 - part**4 / 2) + np.maximum(time - start, 0))
    angle = way[:, None] / RADIUS + 2 * np.pi * np.arange(count) / count
    return RADIUS * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=-1)


class Air:
    """The point sources of two boards, at their positions, and the physical properties of a bead."""

    def __init__(self, positions: Real, source: float = 4.386, radius: float = 1e-3, density: float = 29.0) -> None:
        self.positions, self.source, self.radius = positions, source, radius
        volume = 4 / 3 * np.pi * radius**3
        self.particle = {"radius": radius, "density": density}
        self.mass = (density + traps.DENSITY / 2) * volume
        self.weight = np.array([0, 0, -9.81]) * (density - traps.DENSITY) * volume

    def force(self, drive: Complex, places: Real) -> Real:
        """Returns the force (M, 3) in N."""
        return traps.force(self.source * drive, places[:, None] - self.positions, **self.particle)

    def stray(self, drives: Complex, points: Real, begin: Real, rate: float, speed: Real | float = 0.0) -> Real:
        """Returns distances (T, M) in m between points (T, M, 3) and beads that start at `begin` (M, 3)."""
        step, apart = 1 / (rate * STEPS), np.zeros(points.shape[:2])
        state = np.stack([begin, np.broadcast_to(speed, begin.shape)])

        air = traps.Drag(self.radius, VISCOSITY, state[1], step, STEPS * len(drives))

        def change(state: Real, drive: Complex, part: float) -> Real:
            force = self.force(drive, state[0]) + self.weight
            return np.stack([state[1], air.acceleration(force, state[1], self.mass, part)])

        for t, drive in enumerate(drives.astype(complex)):
            for _ in range(STEPS):
                one = change(state, drive, 0)
                two = change(state + step / 2 * one, drive, 0.5)
                three = change(state + step / 2 * two, drive, 0.5)
                four = change(state + step * three, drive, 1)
                before, state = state[1], state + step / 6 * (one + 2 * two + 2 * three + four)
                air.passed(before, state[1])
            ahead = points[min(t + 1, len(points) - 1)]
            apart[t] = np.linalg.norm(state[0] - ahead, axis=1)
        return apart
