"""README.md: a SonicSurface's phases, and the field of three foci that circle above it (10 s)."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

import midair
from midair._pictures.colours import table
from pictures import DOCS

#: Frames of a turn, of which the film repeats a third, and the step between drawn frames.
FRAMES, EVERY = 480, 5
SIDE, SIZE, HEIGHT = 280, 0.1, 0.12
BACK, GAP = (12, 15, 20), 16


def shades(parts: NDArray[np.floating], name: Literal["field", "phase"]) -> NDArray[np.uint8]:
    """Returns the colours of values from 0 to 1 in a colour map."""
    return table(name)[np.rint(255 * parts).astype(int)]


def board(drive: NDArray[np.complex64]) -> Image.Image:
    """Draws the transducers as discs in the colours of their phases."""
    picture = Image.new("RGB", (2 * SIDE, 2 * SIDE), BACK)
    pen = ImageDraw.Draw(picture)
    side = round(len(drive) ** 0.5)
    step = 2 * SIDE / side
    colours = shades(np.angle(drive) / (2 * np.pi) + 0.5, "phase")
    for i, colour in enumerate(colours):
        x, y = i % side + 0.5, side - i // side - 0.5
        box = [step * (x - 0.42), step * (y - 0.42), step * (x + 0.42), step * (y + 0.42)]
        pen.ellipse(box, fill=tuple(map(int, colour)))
    return picture.resize((SIDE, SIDE), Image.Resampling.LANCZOS)


def main() -> None:
    """Draws the film."""
    array = midair.Array.preset("sonicsurface")
    angle = 2 * np.pi * np.arange(FRAMES // 3) / FRAMES
    around = angle[:, None] + 2 * np.pi * np.arange(3) / 3
    points = np.stack([0.025 * np.cos(around), 0.025 * np.sin(around), np.full_like(around, HEIGHT)], axis=-1)
    sequence = midair.sequence(array, points, rate=1000, change=2 * np.pi / 16)
    places = SIZE * ((np.arange(SIDE // 2) + 0.5) / (SIDE // 2) - 0.5)
    x, y = np.meshgrid(places, places[::-1])
    plane = np.stack([x, y, np.full_like(x, HEIGHT)], axis=-1).reshape(-1, 3)
    scene = midair.Scene(array, points[0])
    drives = sequence.drives[::EVERY]
    fields = [np.abs(midair.field(scene, drive, plane).pressure).reshape(x.shape) for drive in drives]
    top = max(field.max() for field in fields)
    frames = []
    for drive, field in zip(drives, fields, strict=True):
        frame = Image.new("RGB", (2 * SIDE + GAP, SIDE), BACK)
        frame.paste(board(drive), (0, 0))
        seen = Image.fromarray(shades(field / top, "field"))
        frame.paste(seen.resize((SIDE, SIDE), Image.Resampling.BICUBIC), (SIDE + GAP, 0))
        frames.append(frame)
    path = DOCS / "moving.webp"
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=60, loop=0, quality=28, method=6)
    metrics = sequence.metrics
    print(f"{path}: largest change {metrics.largest_change:.3f} rad, uniformity {metrics.uniformity:.4f}")
