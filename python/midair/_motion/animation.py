"""Animations: |p| in a plane, frame after frame, as .gif or .mp4."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import suppress
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._midair import Plane, SceneError, SceneWarning, field
from .._pictures.panel import sides
from .._support.arguments import callback, whole
from . import files

if TYPE_CHECKING:
    from .judged import JudgedFrames

ENDINGS = (".gif", ".mp4")

#: Pictures where nobody says how many: some seconds.
PICTURES = 100

#: Points by which a plane is chosen; more would tell no more about where a path lies.
POINTS = 1000

#: Dots a inch; a picture is 5.2 x 4.6 inches, so that its pixels are even in number, as video needs.
DPI = 100


def animate(
    sequence: JudgedFrames,
    path: str | PathLike[str],
    plane: Plane | None,
    frames: int | None,
    fps: int,
    progress: Callable[[int, int], object] | None,
) -> None:
    """Draw frames, evenly chosen, and write them by the path's ending."""
    from matplotlib.figure import Figure

    callback(progress, "pictures drawn, pictures")
    count = min(len(sequence), PICTURES if frames is None else whole("frames", frames, least=1))
    fps = whole("fps", fps, least=1)
    if plane is not None and not isinstance(plane, Plane):
        raise TypeError(f"plane is no midair.Plane but {type(plane).__qualname__}")
    chosen = np.arange(count) * len(sequence) // count
    plane = plane or _plane(sequence)
    with files.whole(path, ENDINGS) as part, warnings.catch_warnings():
        # Points leave the plane, and what else is hardly meant was told when the sequence was made.
        warnings.simplefilter("ignore", SceneWarning)
        writer = _writer(part, fps)
        figure = Figure(figsize=(5.2, 4.6), dpi=DPI, layout="constrained")
        picture = _Picture(figure, sequence, plane, float(sequence.pressures[chosen].max()))
        writer.setup(figure, part, DPI)
        try:
            for done, frame in enumerate(chosen, start=1):
                picture.show(int(frame))
                writer.grab_frame()
                if progress is not None:
                    progress(done, count)
        except BaseException:
            # ffmpeg waits for pictures; what it has written is removed.
            if part.suffix == ".mp4":
                with suppress(Exception):
                    writer.finish()
            raise
        writer.finish()


def _writer(path: Path, fps: int) -> Any:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    if path.suffix == ".gif":
        return PillowWriter(fps=fps)
    if not FFMpegWriter.isAvailable():
        raise SceneError("output .mp4 needs ffmpeg, which is not there: install it, or give a .gif")
    return FFMpegWriter(fps=fps)


def _plane(sequence: JudgedFrames) -> Plane:
    """The plane that `midair.field` takes for the points of all frames."""
    points = sequence.points[sequence.targets > 0]
    some = points[:: -(-len(points) // POINTS)]
    scene = sequence.scene(0).replace(points=some, pressures=None)
    plane = field(scene, sequence.drive(0)).plane
    assert plane is not None
    return plane


class _Picture:
    """One panel whose image, points and title change."""

    def __init__(self, figure: Any, sequence: JudgedFrames, plane: Plane, top: float) -> None:
        self.sequence, self.plane = sequence, plane
        first = sequence.field(0, plane)
        self.axes = sides(first)
        across, up = ("xyz"[axis] for axis in self.axes)
        u, v = (1e3 * getattr(first, name) for name in (across, up))
        edge = (u[1] - u[0]) / 2 if len(u) > 1 else 0.5
        self.ax = figure.subplots()
        self.image = self.ax.imshow(
            np.zeros((len(v), len(u))),
            origin="lower",
            extent=(u[0] - edge, u[-1] + edge, v[0] - edge, v[-1] + edge),
            cmap="magma",
            vmin=0.0,
            vmax=top or 1.0,
        )
        self.dots = self.ax.scatter([], [], s=14, facecolors="none", edgecolors="deepskyblue", linewidths=1.1)
        self.ax.set(xlabel=f"{across} / mm", ylabel=f"{up} / mm")
        figure.colorbar(self.image, ax=self.ax, fraction=0.046, pad=0.03, label="|p| / Pa", extend="max")

    def show(self, frame: int) -> None:
        sequence = self.sequence
        self.image.set_data(np.abs(sequence.field(frame, self.plane).pressure))
        there = sequence.points[frame][sequence.targets[frame] > 0]
        self.dots.set_offsets(1e3 * there[:, self.axes])
        time = f"{1e3 * frame / sequence.rate:.2f} ms"
        self.ax.set_title(f"{self.plane.axis} = {1e3 * self.plane.at:.4g} mm, {time}", fontsize="medium")
