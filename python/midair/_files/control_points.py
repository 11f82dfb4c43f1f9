"""`.csv` of control points without phases, for devices that compute drives themselves, such as Ultraleap's.

A row is t,x,y,z,intensity (s, m, 0 to 1) and, for modulated points, frequency in Hz. Rows with the same t are
the points of one frame. z is the distance from the array. Intensities are targets relative to the largest.
"""

import csv
from dataclasses import dataclass
from os import PathLike
from pathlib import Path as File
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import FARTHEST, numbers, read_table, stated
from .._sequence import Sequence
from .._support.arguments import frame_rate, number
from .._support.text import fault
from ..path import Path

COLUMNS = ("t", "x", "y", "z", "intensity")
FREQUENCY = "frequency"

Numbers = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ControlPoints:
    """Control points in time, as in a file.

    Attributes
    ----------
    times : (T,) ndarray
        Times in s.
    points : (T, M, 3) ndarray
        Points in m.
    intensities : (T, M) ndarray
        Intensities from 0 to 1.
    frequencies : (T, M) ndarray or None
        Frequency of the points' modulation in Hz.
    """

    times: Numbers
    points: Numbers
    intensities: Numbers
    frequencies: Numbers | None = None


def control_points(given: Any, rate: float | None, modulate: float | None) -> ControlPoints:
    """Return the control points of a Path, a Sequence, points (M, 3) or (T, M, 3), or ControlPoints."""
    if isinstance(given, ControlPoints):
        return given
    if isinstance(given, Sequence):
        times, points, targets = given.times, given.points, given.targets
    elif isinstance(given, Path):
        points, targets = given.frames(_rate(rate))
        times = np.arange(len(points)) / _rate(rate)
    else:
        points = _points(given)
        times = np.arange(len(points)) / (_rate(rate) if len(points) > 1 else 1.0)
        targets = np.ones(points.shape[:2])
    largest = targets.max(initial=0.0)
    frequencies = None
    if modulate is not None:
        frequencies = np.full(targets.shape, number("modulate", modulate, above=0))
    return ControlPoints(times, points, targets / largest if largest else targets, frequencies)


def _rate(rate: float | None) -> float:
    if rate is None:
        raise stated("rate", "is left out", "give frames a second", code="missing")
    return frame_rate(rate)


def _points(given: ArrayLike) -> Numbers:
    cure = "give a path, a Sequence, or points (M, 3) or (T, M, 3) in m"
    found = numbers("points", given, [(-1, 3), (-1, -1, 3)], cure, most=FARTHEST)
    return found[None] if found.ndim == 2 else found


def write(path: File, given: ControlPoints) -> None:
    """Write a row for each point of each frame."""
    modulated = given.frequencies is not None
    with path.open("w", encoding="ascii", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow([*COLUMNS, FREQUENCY] if modulated else COLUMNS)
        for frame, time in enumerate(given.times.tolist()):
            parts = [given.points[frame], given.intensities[frame][:, None]]
            if given.frequencies is not None:
                parts.append(given.frequencies[frame][:, None])
            table.writerows([time, *row] for row in np.concatenate(parts, axis=1).tolist())


def read(path: str | PathLike[str], data: bytes) -> ControlPoints:
    """Read the frames of a file: rows with the same t."""
    lines, values = read_table(data, f'file "{path}"', COLUMNS, [FREQUENCY], "in s and m", "0,0,0,0.15,1")
    if np.isnan(values[:, 5]).all():
        values = values[:, :5]
    _check(path, lines, values)
    starts = np.flatnonzero(np.diff(values[:, 0], prepend=-np.inf))
    counts = np.diff(np.append(starts, len(values)))
    if (counts != counts[0]).any():
        frame = int(np.argmax(counts != counts[0]))
        reported = f"{counts[frame]} points at t = {values[starts[frame], 0]:g}"
        cure = f"give {counts[0]} at every t, with intensity 0 where one is not there"
        raise fault(path, int(lines[starts[frame]]), reported, cure)
    frames = values.reshape(len(starts), counts[0], -1)
    frequencies = frames[:, :, 5] if frames.shape[2] == 6 else None
    return ControlPoints(frames[:, 0, 0], frames[:, :, 1:4], frames[:, :, 4], frequencies)


def _check(path: str | PathLike[str], lines: NDArray[np.uintp], values: Numbers) -> None:
    bad = {
        "t goes back": ("give times that rise", np.diff(values[:, 0], prepend=values[0, 0]) < 0),
        "intensity is {4:g}": ("give 0 to 1", (values[:, 4] < 0) | (values[:, 4] > 1)),
    }
    if values.shape[1] == 6:
        bad["frequency is {5:g}"] = ("give Hz, at least 0", values[:, 5] < 0)
    for reported, (cure, wrong) in bad.items():
        if wrong.any():
            row = int(wrong.argmax())
            raise fault(path, int(lines[row]), f"{reported.format(*values[row])}", cure)
