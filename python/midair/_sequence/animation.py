"""Animations as .gif, .webp or .mp4: |p| in a plane, frame after frame."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable, Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from .._midair import Plane, field, stated
from .._pictures.colours import MAPS
from .._pictures.panel import POINT, sides
from .._support.arguments import callback, whole, without_warnings
from . import files

if TYPE_CHECKING:
    from .judged import JudgedFrames

ENDINGS = (".gif", ".webp", ".mp4")

#: Default number of pictures in an animation.
PICTURES = 100

#: Number of points of a path that are used to choose the plane; more would not change it.
POINTS = 1000

#: Dots per inch. A picture of 5.2 x 4.6 inches has an even number of pixels on each side, as video encoders
#: need.
DPI = 100


def animate(
    sequence: JudgedFrames,
    path: str | PathLike[str],
    plane: Plane | None,
    frames: int | None,
    fps: int,
    progress: Callable[[int, int], object] | None,
) -> None:
    """Draw frames at equal intervals of a sequence, and write them in the format of the path's ending."""
    callback(progress, "pictures drawn, pictures")
    count = min(len(sequence), PICTURES if frames is None else whole("frames", frames, least=1))
    fps = whole("fps", fps, least=1)
    if plane is not None and not isinstance(plane, Plane):
        raise TypeError(f"plane is no midair.Plane but {type(plane).__qualname__}")
    chosen = np.arange(count) * len(sequence) // count
    plane = plane or _plane(sequence)
    with without_warnings():
        # Points of some frames lie outside the plane. The sequence has already warned of probable mistakes.
        write(path, fps, count, _shown(sequence, plane, chosen.tolist()), progress)


def write(
    path: str | PathLike[str],
    fps: int,
    count: int,
    pictures: Iterable[Any],
    progress: Callable[[int, int], object] | None,
) -> None:
    """Write pictures (height, width, 3), each when it is drawn, in the format of the path's ending."""
    with files.whole(path, ENDINGS) as part:
        film = (_Film if part.suffix == ".mp4" else _Pictures)(part, fps)
        try:
            for done, picture in enumerate(pictures, start=1):
                film.add(picture)
                if progress is not None:
                    progress(done, count)
            film.finish()
        finally:
            film.close()


class _Pictures:
    """Writes a .gif or .webp. It collects all pictures and writes them together."""

    def __init__(self, path: Path, fps: int) -> None:
        from PIL import Image

        self.path, self.fps = path, fps
        self.pictures: list[Any] = []
        self.palette = Image.new("P", (1, 1))
        self.palette.putpalette(_palette())

    def add(self, pixels: Any) -> None:
        """Append a picture (height, width, 3)."""
        from PIL import Image

        picture = Image.fromarray(pixels)
        if self.path.suffix == ".gif":
            picture = picture.quantize(palette=self.palette, dither=Image.Dither.NONE)
        self.pictures.append(picture)

    def finish(self) -> None:
        first, *others = self.pictures
        pace: dict[str, Any] = {"duration": 1000 / self.fps, "loop": 0}
        # These settings of the .webp encoder are its fastest ones with good pictures.
        quality = {} if self.path.suffix == ".gif" else {"quality": 80, "method": 0}
        first.save(self.path, save_all=True, append_images=others, **pace, **quality)

    def close(self) -> None:
        """Do nothing: no file is open."""


def _palette() -> bytes:
    """Return the 256 colours of a .gif: those of the colour map, greys for text, and the points' colour."""
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb

    greys = np.repeat(np.linspace(0, 1, 32)[:, None], 3, axis=1)
    shades = np.asarray(colormaps[MAPS["pressure"]](np.linspace(0, 1, 223)))[:, :3]
    colours = np.rint(255 * np.vstack([shades, greys, to_rgb(POINT)]))
    return bytes(colours.astype(np.uint8).tobytes())


class _Film:
    """Writes an .mp4: each picture is sent to ffmpeg as soon as it is drawn."""

    def __init__(self, path: Path, fps: int) -> None:
        from matplotlib.animation import FFMpegWriter

        if not FFMpegWriter.isAvailable():
            cure = "install it, or give a .webp or .gif"
            raise stated("output .mp4", "needs ffmpeg, which is not there", cure, code="missing")
        self.program = FFMpegWriter.bin_path()
        self.path, self.fps = path, fps
        self.process: subprocess.Popen[bytes] | None = None

    def add(self, pixels: Any) -> None:
        """Append a picture (height, width, 3)."""
        if self.process is None:
            height, width, _ = pixels.shape
            given = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {self.fps} -i -"
            made = "-loglevel error -c:v h264 -pix_fmt yuv420p -y"
            command = [self.program, *given.split(), *made.split(), str(self.path)]
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(pixels.tobytes())
        except BrokenPipeError:
            # ffmpeg has ended early; `finish` reports its error.
            self.finish()

    def finish(self) -> None:
        assert self.process is not None
        _, reported = self.process.communicate()
        if self.process.returncode:
            line = " ".join(reported.decode(errors="replace").split()) or f"code {self.process.returncode}"
            raise stated("ffmpeg", "ended with", f"{line}; give a .webp or .gif")

    def close(self) -> None:
        """End ffmpeg if it still waits for pictures."""
        if self.process is not None and self.process.poll() is None:
            self.process.kill()
            self.process.communicate()


def _shown(sequence: JudgedFrames, plane: Plane, frames: list[int]) -> Iterator[Any]:
    picture = _Picture(sequence, plane, float(sequence.pressures[frames].max()))
    yield from map(picture.show, frames)


def _plane(sequence: JudgedFrames) -> Plane:
    """Return the plane that `midair.field` chooses for the points of all frames."""
    points = sequence.points[sequence.targets > 0]
    some = points[:: -(-len(points) // POINTS)]
    scene = sequence.scene(0).replace(points=some, pressures=None)
    plane = field(scene, sequence.drive(0)).plane
    assert plane is not None
    return plane


class _Picture:
    """A picture of |p| in a plane.

    Fixed parts are drawn once; image, points and title for each frame.
    """

    def __init__(self, sequence: JudgedFrames, plane: Plane, top: float) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self.sequence, self.plane = sequence, plane
        first = sequence.field(0, plane)
        self.axes = sides(first)
        across, up = ("xyz"[axis] for axis in self.axes)
        u, v = (1e3 * getattr(first, name) for name in (across, up))
        edge = (u[1] - u[0]) / 2 if len(u) > 1 else 0.5
        figure = Figure(figsize=(5.2, 4.6), dpi=DPI, layout="constrained")
        self.canvas = cast(Any, FigureCanvasAgg)(figure)
        self.ax = figure.subplots()
        self.image = self.ax.imshow(
            np.zeros((len(v), len(u))),
            origin="lower",
            extent=(u[0] - edge, u[-1] + edge, v[0] - edge, v[-1] + edge),
            cmap=MAPS["pressure"],
            vmin=0.0,
            vmax=top or 1.0,
            interpolation="bicubic",
        )
        self.dots = self.ax.scatter([], [], s=14, facecolors="none", edgecolors=POINT, linewidths=1.1)
        self.ax.set(xlabel=f"{across} / mm", ylabel=f"{up} / mm")
        figure.colorbar(self.image, ax=self.ax, fraction=0.046, pad=0.03, label="|p| / Pa", extend="max")
        self.title = self._place(0)
        self.moving = (self.image, self.dots, *self.ax.spines.values(), self.title)
        for artist in self.moving:
            artist.set_animated(True)
        self.canvas.draw()
        figure.set_layout_engine("none")
        self.still = self.canvas.copy_from_bbox(figure.bbox)

    def show(self, frame: int) -> Any:
        """Return the pixels (height, width, 3) of a frame."""
        sequence = self.sequence
        self.image.set_data(np.abs(sequence.field(frame, self.plane).pressure))
        there = sequence.points[frame][sequence.targets[frame] > 0]
        self.dots.set_offsets(1e3 * there[:, self.axes])
        self._place(frame)
        self.canvas.restore_region(self.still)
        for artist in self.moving:
            self.ax.draw_artist(artist)
        return np.asarray(self.canvas.buffer_rgba())[..., :3].copy()

    def _place(self, frame: int) -> Any:
        time = f"{1e3 * frame / self.sequence.rate:.2f} ms"
        place = f"{self.plane.axis} = {1e3 * self.plane.at:.4g} mm, {time}"
        return self.ax.set_title(place, fontsize="medium")
