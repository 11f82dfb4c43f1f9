"""Pictures of a sequence over time, the spectrum of its pressure, and animations (.gif, .webp, .mp4)."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from .._midair import Plane, field, stated
from .._pictures.colours import MAPS, Axes, Figure, Size
from .._pictures.panel import POINT, sides
from .._support.arguments import callback, whole, without_warnings
from .._support.text import counted
from . import files
from .drives import blocks
from .felt import BANDS, rms, spectrum

if TYPE_CHECKING:
    from .frames import Frames

#: The panels of a sequence's picture.
Panel = Literal["pressures", "changes", "spectrum"]
PANELS = get_args(Panel)

#: Largest number of places of a line over time: about what a screen can show. Values are combined, not
#: skipped.
COLUMNS = 1000

#: Least range of the scale of |p| / target, relative to its top.
SPAN = 0.15

#: Colours of lines, which differ in a grey print.
TEAL, RED = "#2b6f6b", "#b8402a"


def motion(
    sequence: Frames, ax: Axes | None = None, *, panels: Panel | Iterable[Panel] | None = None, size: Size | None = None
) -> Figure:
    """Draw |p| / target of the points and phase changes over time, and the spectrum of |p|^2.

    Frames that share a place show their least and largest |p| / target and their largest change.
    """
    from .._pictures.figures import chosen, head, new_figure, whole

    names = chosen(panels, PANELS, ax)
    if ax is not None:
        DRAWN[names[0]](sequence, ax)
        return whole(ax)
    heights = [HEIGHTS[name] for name in names]
    figure = new_figure(9.6, 0.6 + 2.3 * sum(heights), size)
    axes = figure.subplots(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
    for name, one in zip(names, axes, strict=True):
        DRAWN[name](sequence, one)
    over_time = [one for name, one in zip(names, axes, strict=True) if name != "spectrum"]
    for one in over_time[:-1]:
        one.sharex(over_time[-1])
        one.tick_params(labelbottom=False)
        one.set_xlabel("")
    head(figure, *_heading(sequence))
    return figure


#: Heights of the panels, relative to each other.
HEIGHTS: dict[Panel, float] = {"pressures": 1.0, "changes": 0.9, "spectrum": 1.2}


def _groups(sequence: Frames) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return the boundaries of groups of neighbouring frames, and the time in ms in the middle of each."""
    count = len(sequence)
    edges = np.linspace(0, count, min(count, COLUMNS) + 1).astype(np.intp)
    return edges, 1e3 * (edges[:-1] + edges[1:]) / 2 / sequence.rate


def _heading(sequence: Frames) -> list[str]:
    metrics = sequence.metrics
    frames, count = sequence.targets.shape
    by = f", {sequence.solver}" if sequence.solver else ""
    seam = "" if metrics.seam is None else f", {metrics.seam:.3f} rad from the last frame to the first"
    return [
        f"{counted(frames, 'frame')} at {sequence.rate:g} Hz, {counted(count, 'point')}{by}",
        f"level {metrics.level:.3f}, uniformity {metrics.uniformity:.3f}, dip {metrics.dip:.3f}, "
        f"noise {metrics.noise:.0f} dB, largest change {metrics.largest_change:.3f} rad{seam}",
    ]


def _pressures(sequence: Frames, ax: Axes) -> None:
    """Draw the band from the least to the largest |p| / target of the points, and the mean of both."""
    there = sequence.targets > 0
    part = np.full(there.shape, np.nan)
    np.divide(100 * sequence.pressures, sequence.targets, out=part, where=there)
    edges, times = _groups(sequence)
    least, most = (extreme.reduceat(extreme.reduce(part, axis=1), edges[:-1]) for extreme in (np.fmin, np.fmax))
    ax.axhline(100, color="grey", linestyle=":", linewidth=0.9)
    ax.fill_between(times, least, most, color=TEAL, alpha=0.35, linewidth=0)
    ax.plot(times, (least + most) / 2, color=TEAL, linewidth=1.1)
    top = float(np.nanmax([100.0, *most])) + 2
    bottom = min(float(np.nanmin([100.0, *least])) - 2, (1 - SPAN) * top)
    ax.set(ylabel="|p| / target, %", xlabel="time / ms", ylim=(bottom, top))
    if (count := sequence.points.shape[1]) > 1:
        ax.set_title(f"all {count} points lie within the band", loc="left", fontsize="small")


def _changes(sequence: Frames, ax: Axes) -> None:
    """Draw the largest phase change of all transducers in each frame, and the bound."""
    largest = np.zeros(len(sequence), np.float32)
    for frames in blocks(len(sequence), len(sequence.array)):
        largest[frames] = sequence.each_change(frames.start, frames.stop).max(axis=1)
    # The change to the first frame is the seam, which the heading states.
    edges, times = _groups(sequence)
    shown = np.maximum.reduceat(largest, edges[:-1])
    shown[0] = largest[1 : edges[1]].max(initial=0.0) if edges[1] > 1 else np.nan
    ax.plot(times, shown, color=TEAL, linewidth=1.1)
    bound = sequence.change if sequence.change is not None and sequence.change < np.pi else None
    if bound is not None:
        ax.axhline(bound, color=RED, linestyle="--", linewidth=0.9, zorder=1)
        part = np.pi / bound if bound else 0.5
        name = f"\u03c0/{part:.0f}" if abs(part - round(part)) < 1e-6 else f"{bound:.3g} rad"
        where: dict[str, Any] = {"transform": ax.get_yaxis_transform(), "ha": "right", "va": "bottom"}
        ax.text(0.99, bound, f"bound {name}", color=RED, fontsize="small", **where)
    ax.set(ylabel="largest phase\nchange / rad", xlabel="time / ms")
    ax.set_ylim(0, 1.35 * max(float(np.nan_to_num(shown).max()), bound or 0.0) or 1.0)


def _spectrum(sequence: Frames, ax: Axes) -> None:
    """Draw the spectrum of the radiation pressure, averaged over the points that are present."""
    there = sequence.targets > 0
    values = (sequence.radiation * there).sum(axis=1) / np.maximum(there.sum(axis=1), 1)
    frequencies, lines = spectrum(values, sequence.rate)
    ax.plot(frequencies[1:], lines[1:], color="black", linewidth=0.9)
    for band, colour in zip(BANDS, ("tab:blue", "tab:orange"), strict=True):
        reported = f"{band[0]:g} to {band[1]:g} Hz: {rms(frequencies, lines, band):.3g} Pa rms"
        ax.axvspan(*band, color=colour, alpha=0.15, linewidth=0, label=reported)
    ax.axhline(lines[0], color="grey", linestyle="--", linewidth=0.9, label=f"static: {lines[0]:.3g} Pa")
    if lines[1:].any():
        ax.set(xscale="log", yscale="log")
    ax.set(xlabel="frequency / Hz", ylabel="radiation pressure / Pa")
    ax.grid(alpha=0.3)
    ax.legend(loc="best")


#: The function that draws each panel.
DRAWN: dict[Panel, Callable[[Frames, Axes], None]] = {
    "pressures": _pressures,
    "changes": _changes,
    "spectrum": _spectrum,
}

ENDINGS = (".gif", ".webp", ".mp4")

#: Default number of pictures in an animation.
PICTURES = 100

#: Number of points of a path that are used to choose the plane; more would not change it.
POINTS = 1000

#: Dots per inch. A picture of 5.2 x 4.6 inches has an even number of pixels on each side, as video encoders
#: need.
DPI = 100


def animate(
    sequence: Frames,
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
        write(path, fps, count, _pictures(sequence, plane, chosen.tolist()), progress)


def write(
    path: str | PathLike[str],
    fps: int,
    count: int,
    pictures: Iterable[Any],
    progress: Callable[[int, int], object] | None,
) -> None:
    """Write pictures (height, width, 3), each when it is drawn, in the format of the path's ending."""
    with files.whole(path, ENDINGS) as part, (_film if part.suffix == ".mp4" else _images)(part, fps) as add:
        for done, picture in enumerate(pictures, start=1):
            add(picture)
            if progress is not None:
                progress(done, count)


@contextmanager
def _images(path: Path, fps: int) -> Iterator[Callable[[Any], None]]:
    """Yield a function that takes the pictures (height, width, 3) of a .gif or .webp, written at the end."""
    from PIL import Image

    pictures: list[Any] = []
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    is_gif = path.suffix == ".gif"

    def add(pixels: Any) -> None:
        picture = Image.fromarray(pixels)
        pictures.append(picture.quantize(palette=palette, dither=Image.Dither.NONE) if is_gif else picture)

    yield add
    # These settings of the .webp encoder are its fastest ones with good pictures.
    quality = {} if is_gif else {"quality": 80, "method": 0}
    pace = {"duration": 1000 / fps, "loop": 0}
    pictures[0].save(path, save_all=True, append_images=pictures[1:], **pace, **quality)


def _palette() -> bytes:
    """Return the 256 colours of a .gif: those of the colour map, greys for text, and the points' colour."""
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb

    greys = np.repeat(np.linspace(0, 1, 32)[:, None], 3, axis=1)
    shades = np.asarray(colormaps[MAPS["pressure"]](np.linspace(0, 1, 223)))[:, :3]
    colours = np.rint(255 * np.vstack([shades, greys, to_rgb(POINT)]))
    return bytes(colours.astype(np.uint8).tobytes())


@contextmanager
def _film(path: Path, fps: int) -> Iterator[Callable[[Any], None]]:
    """Yield a function that sends each picture (height, width, 3) of an .mp4 to ffmpeg."""
    from matplotlib.animation import FFMpegWriter

    if not FFMpegWriter.isAvailable():
        cure = "install it, or give a .webp or .gif"
        raise stated("output .mp4", "needs ffmpeg, which is not there", cure, code="missing")
    process: subprocess.Popen[bytes] | None = None

    def add(pixels: Any) -> None:
        nonlocal process
        if process is None:
            height, width, _ = pixels.shape
            given = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {fps} -i -"
            made = "-loglevel error -c:v h264 -pix_fmt yuv420p -y"
            command = [FFMpegWriter.bin_path(), *given.split(), *made.split(), str(path)]
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        assert process.stdin is not None
        try:
            process.stdin.write(pixels.tobytes())
        except BrokenPipeError:
            # ffmpeg has ended early; `finish` reports its error.
            finish()

    def finish() -> None:
        assert process is not None
        _, reported = process.communicate()
        if process.returncode:
            line = " ".join(reported.decode(errors="replace").split()) or f"code {process.returncode}"
            raise stated("ffmpeg", "ended with", f"{line}; give a .webp or .gif")

    try:
        yield add
        finish()
    finally:
        # After an error, ffmpeg still waits for pictures.
        if process is not None and process.poll() is None:
            process.kill()
            process.communicate()


def _plane(sequence: Frames) -> Plane:
    """Return the plane that `midair.field` chooses for the points of all frames."""
    points = sequence.points[sequence.targets > 0]
    some = points[:: -(-len(points) // POINTS)]
    scene = sequence.scene(0).replace(points=some, pressures=None)
    plane = field(scene, sequence.drive(0)).plane
    assert plane is not None
    return plane


def _pictures(sequence: Frames, plane: Plane, frames: list[int]) -> Iterator[Any]:
    """Yield pictures (height, width, 3) of |p| in a plane.

    Fixed parts are drawn once; image, points and title for each frame.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Picture

    first = sequence.field(0, plane)
    axes = sides(first)
    across, up = ("xyz"[axis] for axis in axes)
    u, v = (1e3 * getattr(first, name) for name in (across, up))
    edge = (u[1] - u[0]) / 2 if len(u) > 1 else 0.5
    figure = Picture(figsize=(5.2, 4.6), dpi=DPI, layout="constrained")
    canvas = cast(Any, FigureCanvasAgg)(figure)
    ax = figure.subplots()
    image = ax.imshow(
        np.zeros((len(v), len(u))),
        origin="lower",
        extent=(u[0] - edge, u[-1] + edge, v[0] - edge, v[-1] + edge),
        cmap=MAPS["pressure"],
        vmin=0.0,
        vmax=float(sequence.pressures[frames].max()) or 1.0,
        interpolation="bicubic",
    )
    dots = ax.scatter([], [], s=14, facecolors="none", edgecolors=POINT, linewidths=1.1)
    ax.set(xlabel=f"{across} / mm", ylabel=f"{up} / mm")
    figure.colorbar(image, ax=ax, fraction=0.046, pad=0.03, label="|p| / Pa", extend="max")

    def titled(frame: int) -> Any:
        time = f"{1e3 * frame / sequence.rate:.2f} ms"
        return ax.set_title(f"{plane.axis} = {1e3 * plane.at:.4g} mm, {time}", fontsize="medium")

    moving = (image, dots, *ax.spines.values(), titled(0))
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()
    figure.set_layout_engine("none")
    still = canvas.copy_from_bbox(figure.bbox)
    for frame in frames:
        image.set_data(np.abs(sequence.field(frame, plane).pressure))
        there = sequence.points[frame][sequence.targets[frame] > 0]
        dots.set_offsets(1e3 * there[:, axes])
        titled(frame)
        canvas.restore_region(still)
        for artist in moving:
            ax.draw_artist(artist)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()
