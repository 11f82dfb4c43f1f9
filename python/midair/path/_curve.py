"""Curves by arc length: where one is after a way along a circle or along straight lines."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from ..shape._contour import measured, reached
from ._piece import Numbers


@dataclass(frozen=True, eq=False)
class Curve(ABC):
    """A curve of a length in m that closes or not."""

    length: float
    closed: bool

    @abstractmethod
    def after(self, ways: Numbers) -> Numbers:
        """Places (..., 3) after ways (...) in m from its start; those of lines end where the lines do."""


@dataclass(frozen=True, eq=False)
class Circle(Curve):
    """center + radius (cos(a) across + sin(a) up), a = angle + way / radius."""

    center: Numbers
    across: Numbers
    up: Numbers
    angle: float

    def after(self, ways: Numbers) -> Numbers:
        """Places on the circle."""
        radius = self.length / (2 * math.pi)
        angles = (self.angle + ways / radius)[..., None]
        return self.center + radius * (np.cos(angles) * self.across + np.sin(angles) * self.up)


@dataclass(frozen=True, eq=False)
class Lines(Curve):
    """Straight lines between vertices, and the way along them to each."""

    vertices: Numbers
    along: Numbers

    def after(self, ways: Numbers) -> Numbers:
        """Places on the lines."""
        return reached(self.vertices, self.along, ways)


def lines(vertices: Numbers, closed: bool) -> Lines:
    """Straight lines between vertices (K, 3), not all in one place."""
    # A length beyond all numbers is refused as a way that nobody walks.
    with np.errstate(over="ignore", invalid="ignore"):
        vertices, along = measured(vertices, closed)
        moved = np.concatenate([[True], np.diff(along) > 0])
    return Lines(float(along[-1]), closed, vertices[moved], along[moved])
