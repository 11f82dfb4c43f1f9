"""Motion: evenness, level and phase changes of `glide` and of sequences.

Prints the tables of docs/motion.md and draws docs/motion.png. The forward model is independent of midair's,
and in f64.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import PowerNorm
from numpy.typing import NDArray

import midair

RATE = 10e3
FRAMES = 200
KINDS = ("circles", "lines", "along x", "around")
AHEAD = (0, 10, 30, "all")


def paths(kind: str, count: int, speed: float, seed: int) -> NDArray[np.float64]:
    """Returns points (T, M, 3) in m over four AUTD3 boards, 0.2 m above them."""
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
    return np.concatenate([flat, np.full((FRAMES, count, 1), 0.2)], axis=2)


def moduli(
    array: midair.Array, points: NDArray[np.float64], drives: NDArray[np.complex64], tau: float
) -> NDArray[np.float64]:
    """Returns |p| (T, M) at the frames' ends: eq. (5) in f64, for transducers with a time constant tau."""
    kept = np.exp(-1 / (RATE * tau)) if tau else 0.0
    number, received = 2 * np.pi * 40e3 / 340, np.zeros(points.shape[:2])
    envelope = drives[0].astype(complex)
    for frame, (places, drive) in enumerate(zip(points, drives, strict=True)):
        envelope = kept * envelope + (1 - kept) * drive
        distance = np.linalg.norm(places[:, None] - array.positions, axis=2)
        received[frame] = np.abs((np.exp(1j * number * distance) / distance) @ envelope)
    return received


def row(
    array: midair.Array, count: int, speed: float, parts: int, tau: float
) -> tuple[float, float, float, float, float]:
    """Returns results over all kinds of paths.

    They are the largest phase change relative to its bound, the least uniformity at rest and in motion, and
    the least and the mean level.
    """
    change = np.pi / parts
    ratios, even, moving, levels = [], [], [], []
    for index, kind in enumerate(KINDS):
        points = paths(kind, count, speed, 7 + index)
        points[..., :2] += array.positions.mean(axis=0)[:2]
        solver = midair.Solver(array, "glide", change=change, tau=tau, rate=RATE, aim="max", absorption=0)
        drives = solver.follow(points)
        turned = np.abs(np.angle(drives[1:] * drives[:-1].conj()))
        ratios.append(turned.max() / change)
        rest, motion = (moduli(array, points, drives, time)[10:] for time in (0.0, 0.2e-3))
        even.append((rest.min(axis=1) / rest.max(axis=1)).min())
        moving.append((motion.min(axis=1) / motion.max(axis=1)).min())
        cold = midair.solve_batch(array, points[10::19], solver="uniform", aim="max", absorption=0)
        known = moduli(array, points[10::19], cold.drives, 0.0)
        levels.append(rest[::19].mean() / known.mean())
    return max(ratios), min(even), min(moving), min(levels), float(np.mean(levels))


def foreseen(array: midair.Array, count: int, speed: float, parts: int) -> tuple[list[float], list[float]]:
    """Returns mean level and least uniformity of all kinds of paths, for each number of frames in AHEAD."""
    levels, even = np.empty((len(AHEAD), len(KINDS))), np.empty((len(AHEAD), len(KINDS)))
    for index, kind in enumerate(KINDS):
        points = paths(kind, count, speed, 7 + index)
        points[..., :2] += array.positions.mean(axis=0)[:2]
        cold = midair.solve_batch(array, points[10::19], solver="uniform", aim="max", absorption=0)
        known = moduli(array, points[10::19], cold.drives, 0.0).mean()
        for order, ahead in enumerate(AHEAD):
            own = midair.sequence(array, points, rate=RATE, change=np.pi / parts, ahead=ahead, absorption=0)
            rest = moduli(array, points, own.drives, 0.0)[10:]
            even[order, index] = (rest.min(axis=1) / rest.max(axis=1)).min()
            levels[order, index] = rest[::19].mean() / known
    return levels.mean(axis=1).tolist(), even.min(axis=1).tolist()


def draw(array: midair.Array, path: Path) -> None:
    """Draws each transducer's phase changes, and the evenness in motion, frame by frame, for two solvers."""
    points = paths("circles", 8, 0.5, 3)
    points[..., :2] += array.positions.mean(axis=0)[:2]
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
    figure.savefig(path, dpi=130)


def main() -> None:
    """Prints the tables and draws the picture."""
    # Point sources in the paper's medium, as in `moduli`.
    board = midair.Array.preset("autd3", (2, 2))
    array = midair.Array(board.positions, quantization=board.quantization)
    draw(array, Path(__file__).parents[1] / "docs" / "motion.png")
    print(
        "| M | speed | bound | tau | change / bound | uniformity | in motion | level, lowest | level, mean |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for count in (4, 16):
        for speed, parts, tau in ((0.5, 16, 0.0), (0.5, 32, 0.0), (2.0, 32, 0.0), (2.0, 8, 0.2e-3)):
            ratio, even, moving, least, mean = row(array, count, speed, parts, tau)
            reported = f"{tau * 1e3:g} ms" if tau else "-"
            print(
                f"| {count} | {speed:g} m/s | pi/{parts} | {reported} | {ratio:.3f} | {even:.4f} "
                f"| {moving:.3f} | {least:.3f} | {mean:.3f} |"
            )
    print("| M | speed | bound | " + " | ".join(f"ahead={ahead}" for ahead in AHEAD) + " |")
    print("|---|---|---" + "|---" * len(AHEAD) + "|")
    for count in (4, 16):
        for speed, parts in ((0.5, 16), (0.5, 32), (2.0, 16), (2.0, 32)):
            both = zip(*foreseen(array, count, speed, parts), strict=True)
            reported = " | ".join(f"{level:.3f} ({even:.4f})" for level, even in both)
            print(f"| {count} | {speed:g} m/s | pi/{parts} | {reported} |", flush=True)


if __name__ == "__main__":
    main()
