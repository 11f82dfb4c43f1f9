"""docs/motion.md: evenness, level and phase changes of `glide` and of sequences (5 min)."""

from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import PowerNorm
from numpy.typing import NDArray

import midair
import oracle
from pictures import head, line, save

RATE = 10e3
FRAMES = 200
KINDS = ("circles", "lines", "along x", "around")
AHEAD = (0, 10, 30, "all")


def paths(array: midair.Array, kind: str, count: int, speed: float, seed: int) -> NDArray[np.float64]:
    """Returns points (T, M, 3) in m over the middle of an array, 0.2 m above it."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(-0.05, 0.05, (count, 2))
    t = np.arange(FRAMES)[:, None] / RATE
    if kind == "circles":
        radius, phase = rng.uniform(0.01, 0.02, count), rng.uniform(0, 2 * np.pi, count)
        angle = speed / radius * t + phase
        flat = start + np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    elif kind == "lines":
        angle = rng.uniform(0, 2 * np.pi, count)
        flat = start + speed * (t - t.mean())[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    elif kind == "along x":
        flat = start + speed * (t - t.mean())[..., None] * [1.0, 0.0]
    else:
        angle = speed / 0.04 * t[..., None]
        turned = np.stack([-start[:, 1], start[:, 0]], axis=-1)
        flat = np.cos(angle) * start + np.sin(angle) * turned
    flat = flat + array.positions.mean(axis=0)[:2]
    return np.concatenate([flat, np.full((FRAMES, count, 1), 0.2)], axis=2)


def moduli(
    array: midair.Array, points: NDArray[np.float64], drives: NDArray[np.complex64], tau: float = 0.0
) -> NDArray[np.float64]:
    """Returns |p| (T, M) at the frames' ends: eq. (5) in f64, for transducers with a time constant tau."""
    kept = np.exp(-1 / (RATE * tau)) if tau else 0.0
    received = np.zeros(points.shape[:2])
    envelope = drives[0].astype(complex)
    for frame, (places, drive) in enumerate(zip(points, drives, strict=True)):
        envelope = kept * envelope + (1 - kept) * drive
        received[frame] = np.abs(oracle.propagation(array.positions, places) @ envelope)
    return received


def cases(array: midair.Array, count: int, speed: float) -> Iterator[tuple[NDArray[np.float64], float]]:
    """Yields the points of each kind of path, and the mean |p| of some of its frames, solved alone."""
    for index, kind in enumerate(KINDS):
        points = paths(array, kind, count, speed, 7 + index)
        cold = midair.solve_batch(array, points[10::19], solver="uniform", aim="max", absorption=0)
        yield points, moduli(array, points[10::19], cold.drives).mean()


def evenness(received: NDArray[np.float64]) -> float:
    """Returns the least uniformity of all frames."""
    return float((received.min(axis=1) / received.max(axis=1)).min())


def glided(array: midair.Array, count: int, speed: float, parts: int, tau: float) -> Iterator[list[float]]:
    """Yields results of `glide` for each kind of path.

    They are the largest phase change relative to its bound, the uniformity at rest and in motion, and the
    level relative to frames that are solved alone.
    """
    change = np.pi / parts
    for points, known in cases(array, count, speed):
        solver = midair.Solver(array, "glide", change=change, tau=tau, rate=RATE, aim="max", absorption=0)
        drives = solver.follow(points)
        turned = np.abs(np.angle(drives[1:] * drives[:-1].conj())).max()
        rest, motion = (moduli(array, points, drives, time)[10:] for time in (0.0, 0.2e-3))
        yield [turned / change, evenness(rest), evenness(motion), rest[::19].mean() / known]


def foreseen(array: midair.Array, count: int, speed: float, parts: int) -> Iterator[list[tuple[float, float]]]:
    """Yields level and uniformity of sequences for each number of frames in AHEAD, for each kind of path."""
    for points, known in cases(array, count, speed):
        found = []
        for ahead in AHEAD:
            own = midair.sequence(array, points, rate=RATE, change=np.pi / parts, ahead=ahead, absorption=0)
            rest = moduli(array, points, own.drives)[10:]
            found.append((rest[::19].mean() / known, evenness(rest)))
        yield found


def draw(array: midair.Array) -> None:
    """Draws each transducer's phase changes, and the evenness in motion, frame by frame, for two solvers."""
    points = paths(array, "circles", 8, 0.5, 3)
    cold = midair.Solver(array, "uniform", aim="max", absorption=0)
    drives = {
        "uniform, each frame by itself": np.array([cold(frame).drive for frame in points]),
        "glide, bound pi/16": midair.Solver(array, "glide", aim="max", absorption=0).follow(points),
    }
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained", width_ratios=(1, 1, 1.1))
    time = np.arange(FRAMES) / RATE * 1e3
    for axis, (name, own) in zip(axes, drives.items(), strict=False):
        changes = np.abs(np.angle(own[1:] * own[:-1].conj()))
        image = axis.imshow(
            changes.T,
            aspect="auto",
            norm=PowerNorm(0.4, 0, np.pi),
            origin="lower",
            extent=(0, time[-1], 0, len(array)),
            cmap="magma",
        )
        axis.set(title=name, xlabel="time / ms", ylabel="transducer")
        received = moduli(array, points, own, 0.2e-3)
        axes[2].plot(time, received.min(axis=1) / received.max(axis=1), label=name)
    figure.colorbar(image, ax=axes[:2], label="phase change / rad a frame")
    axes[2].set(
        title="8 foci at 0.5 m/s, envelopes of 0.2 ms",
        xlabel="time / ms",
        ylabel="weakest / loudest focus",
        ylim=(0, 1.05),
    )
    axes[2].legend(loc="lower right")
    axes[2].grid(alpha=0.3)
    save(figure, "motion")


def main() -> None:
    """Prints the tables and draws the picture."""
    # Point sources in the paper's medium, as in `moduli`.
    board = midair.Array.preset("autd3", (2, 2))
    array = midair.Array(board.positions, quantization=board.quantization)
    draw(array)
    results = ("change / bound", "uniformity", "in motion", "level, lowest", "level, mean")
    head("M", "speed", "bound", "tau", *results)
    for count in (4, 16):
        for speed, parts, tau in ((0.5, 16, 0.0), (0.5, 32, 0.0), (2.0, 32, 0.0), (2.0, 8, 0.2e-3)):
            ratio, even, moving, level = np.array([*glided(array, count, speed, parts, tau)]).T
            results = [f"{ratio.max():.3f}", f"{even.min():.4f}", f"{moving.min():.3f}"]
            results += [f"{level.min():.3f}", f"{level.mean():.3f}"]
            line(count, f"{speed:g} m/s", f"pi/{parts}", f"{tau * 1e3:g} ms" if tau else "-", *results)
    head("M", "speed", "bound", *(f"ahead={ahead}" for ahead in AHEAD))
    for count in (4, 16):
        for speed, parts in ((0.5, 16), (0.5, 32), (2.0, 16), (2.0, 32)):
            level, even = np.moveaxis(np.array([*foreseen(array, count, speed, parts)]), 2, 0)
            cells = zip(level.mean(axis=0), even.min(axis=0), strict=True)
            line(count, f"{speed:g} m/s", f"pi/{parts}", *(f"{both[0]:.3f} ({both[1]:.4f})" for both in cells))
