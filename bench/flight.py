"""Beads in flight between two OpenMPD boards: shapes as in OptiTrap, and top speeds.

The shapes have the sizes and rates of V. Paneva et al., "OptiTrap", ACM TOG 2022, in the upright plane through
the boards' axis, but outlines of our own. One bead of 1 mm radius moves with 10,000 frames per second on the
board's phases. `path.fastest` computes each path at two margins (fractions of a trap's largest force): the
one that gives the paper's rate, and the largest that keeps the bead. `midair.fly` simulates each path for a
second and reports whether the bead stays, and its largest distance from the curve. Lines of 80 mm from rest
to rest, and rings of 40 mm diameter, show the top speeds at the largest margin.

    python bench/flight.py [record.csv]
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import midair

RATE, CHANGE, AIR = 10e3, np.pi / 4, {"temperature": 25}
#: The margins that are tried, in rising order.
MARGINS = np.round(np.arange(0.1, 0.95, 0.1), 2)


def mirrored(half: list[tuple[float, float]]) -> np.ndarray:
    """Returns a closed outline from one half and its mirror image."""
    points = np.array(half)
    return np.concatenate([points, (points[1:-1] * [-1, 1])[::-1]])


def petals() -> np.ndarray:
    """Returns the outline of five petals."""
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)[:, None]
    return (0.36 + 0.14 * np.cos(5 * angle)) * np.concatenate([np.cos(angle), np.sin(angle)], axis=1)


HEART = [(0, 30), (10, 43), (25, 50), (40, 46), (50, 30), (48, 10), (36, -10), (20, -30), (7, -45), (0, -50)]
CAT = [(0, 25), (15, 25), (30, 45), (38, 20), (42, 0), (36, -22), (20, -36), (0, -40)]
DOLPHIN = [
    *[(-50, -2), (-38, 6), (-30, 14), (-10, 20), (0, 30), (8, 18), (25, 10), (38, 4), (50, 16), (46, 0)],
    *[(48, -14), (36, -5), (20, -6), (5, -12), (-5, -24), (-10, -12), (-25, -12), (-38, -8)],
]

#: Shapes: outline, longer side in m, laps per second.
SHAPES = {
    "heart": (mirrored(HEART), 0.056, 10.0),
    "dolphin": (np.array(DOLPHIN, float), 0.047, 3.3),
    "cat": (mirrored(CAT), 0.024, 5.0),
    "flower": (petals(), 0.054, 10.0),
}


def runs() -> dict[str, np.ndarray]:
    """Returns points in m of lines up and across, and of an upright and a level ring."""
    line, angle = np.linspace(-0.04, 0.04, 9), np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring, none = 0.02 * np.stack([np.cos(angle), np.sin(angle)]), 0 * angle
    return {
        "line up": np.outer(line, [0, 0, 1]),
        "line across": np.outer(line, [1, 0, 0]),
        "ring upright": np.stack([ring[0], none, ring[1]], axis=1),
        "ring level": np.stack([*ring, none], axis=1),
    }


def outline(name: str) -> np.ndarray:
    """Returns points (K, 3) in m of a run, or of an upright shape around the middle between the boards."""
    if name not in SHAPES:
        return runs()[name]
    points, size, _ = SHAPES[name]
    points = points - (points.max(axis=0) + points.min(axis=0)) / 2
    points = points * size / np.ptp(points, axis=0).max()
    return np.stack([points[:, 0], 0 * points[:, 0], points[:, 1]], axis=1)


def margin_for(name: str, boards: midair.Array) -> float:
    """Returns the margin at which a shape is as fast as in the paper."""
    wanted, low, high = 1 / SHAPES[name][2], 0.01, 0.99
    for _ in range(10):
        middle = (low + high) / 2
        slow = midair.path.fastest(outline(name), boards, margin=middle, **AIR).duration > wanted
        low, high = (middle, high) if slow else (low, middle)
    return high


def flown(name: str, boards: midair.Array, margin: float) -> dict[str, object]:
    """Returns the row of a shape that is flown for a second at a margin."""
    points, closed = outline(name), not name.startswith("line")
    path = midair.path.fastest(points, boards, closed=closed, margin=margin, **AIR)
    sequence = midair.sequence(boards, path, rate=RATE, change=CHANGE, signature="trap", **AIR)
    flight = midair.fly(sequence, duration=max(1.0, 5 * path.duration) if closed else None)
    places, apart = flight.places[:, 0], flight.times[1] - flight.times[0]
    steps = np.diff(places, axis=0) / apart
    curve = path.frames(10 * RATE)[0][:, 0]
    off = max(np.linalg.norm(curve - place, axis=1).min() for place in places[~np.isnan(places[:, 0])])
    return {
        "shape": name,
        "size_mm": round(1e3 * float(np.ptp(points, axis=0).max()), 1),
        "margin": round(margin, 3),
        "rate_Hz": round(1 / path.duration, 2),
        "held": bool(flight.held[0]),
        "off_mm": round(1e3 * float(off), 3),
        "speed": round(float(np.nanmax(np.linalg.norm(steps, axis=1))), 2),
        "acceleration": round(float(np.nanmax(np.linalg.norm(np.diff(steps, axis=0), axis=1)) / apart), 1),
    }


def shapes() -> Iterator[dict[str, object]]:
    """Yields the rows of shapes at the paper's rate, and of all at the largest margin that keeps the bead."""
    boards = midair.Array.preset("openmpd_pair")
    for name in (*SHAPES, *runs()):
        if name in SHAPES:
            yield flown(name, boards, margin_for(name, boards))
        best = None
        for margin in MARGINS:
            found = flown(name, boards, float(margin))
            if not found["held"]:
                break
            best = found
        if best is not None:
            yield best


def main() -> None:
    """Flies the shapes, prints the rows and writes the record."""
    rows = []
    for row in shapes():
        rows.append(row)
        print(" ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    if len(sys.argv) > 1:
        import record

        record.write(Path(sys.argv[1]), rows, rows[0])


if __name__ == "__main__":
    main()
