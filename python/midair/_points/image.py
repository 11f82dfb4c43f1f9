"""Pictures as points: a grid of pixels, each with a target proportional to its brightness."""

from dataclasses import dataclass
from io import BytesIO
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from .._midair import MOST_POINTS, STEP, SceneError, memory_limit
from .._support.arguments import existing, flag, needs, number, refused, whole
from .._support.text import content

#: Formats that are read, whatever the file's ending. For others, such as .eps, Pillow starts programs
#: (Ghostscript).
FORMATS = ("PNG", "JPEG", "GIF", "BMP", "WEBP", "TIFF", "PPM")

#: Bytes of memory per pixel: four copies with red, green, blue and opacity.
EACH = 16

#: Pixels below this fraction of white (-26 dB) count as dark: no method makes such low pressures reliably.
DARK = 0.05


#: Default distance of pixels: half a wavelength at 40 kHz and 340 m/s, in m. Closer points cannot differ
#: much.
PITCH = 2 * STEP


@dataclass(frozen=True, eq=False)
class Picture:
    """Picture as points, from `midair.image`; `midair.Scene(array, **picture)` is its scene.

    Attributes
    ----------
    points : (M, 3) ndarray
        Places in m.
    pressures : (M,) ndarray
        Peak pressures in Pa, 0 of quiet points.
    weights : (M,) ndarray
        Weights, all 1.

    Examples
    --------
    >>> import midair, tempfile
    >>> import matplotlib.pyplot as plt
    >>> plt.imsave(f"{tempfile.gettempdir()}/ring.png", [[1, 1, 1], [1, 0, 1], [1, 1, 1]], cmap="gray")
    >>> picture = midair.image(f"{tempfile.gettempdir()}/ring.png", size=0.02, z=0.15, pixels=3)
    >>> len(midair.Scene(midair.Array.preset("autd3"), **picture).points)
    8
    """

    points: NDArray[np.float64]
    pressures: NDArray[np.float64]
    weights: NDArray[np.float64]

    def keys(self) -> tuple[str, ...]:
        """Return the names of its arrays, as `midair.Scene` calls them."""
        return ("points", "pressures", "weights")

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in self.keys():
            raise KeyError(name)
        found: NDArray[np.float64] = getattr(self, name)
        return found


def image(
    path: str | PathLike[str],
    *,
    size: float,
    z: float,
    pixels: int | None = None,
    pressure: float = 1000.0,
    quiet: bool = False,
) -> Picture:
    """Turn a picture into points of a grid in the plane at z, its middle at x = y = 0, y up.

    Parameters
    ----------
    path : str or path
        A picture; colours are read as their brightness, and what is transparent as black.
    size : float
        Longer side of the picture, in m.
    z : float
        Height of the plane in m.
    pixels : int, optional
        Pixels along the longer side, size / pixels apart. By default half a wavelength (4.25 mm at 40 kHz)
        apart, as targets of nearer neighbours contradict each other.
    pressure : float, optional
        Pressure of white in Pa; a grey pixel has the target brightness / 255 of it.
    quiet : bool, optional
        Whether dark pixels, below 5 % of white, are quiet points; otherwise they are left out.

    Returns
    -------
    midair.Picture
        Points, pressures and weights. With aim="max" only the ratios of the pressures count: the picture
        becomes as loud as the array can.

    Raises
    ------
    SceneError
        For a file that is missing, is no picture or is dark everywhere, for wrong numbers, and for more than
        100000 points.

    See Also
    --------
    midair.shape : points of lines, text and SVG drawings.

    Examples
    --------
    >>> import midair, tempfile
    >>> import matplotlib.pyplot as plt
    >>> plt.imsave(f"{tempfile.gettempdir()}/line.png", [[0, 0, 0], [1, 1, 1], [0, 0, 0]], cmap="gray")
    >>> midair.image(f"{tempfile.gettempdir()}/line.png", size=0.03, z=0.15, pixels=3).points[:, 0].round(3)
    array([-0.01,  0.  ,  0.01])
    """
    size, z, pressure = number("size", size, above=0), number("z", z), number("pressure", pressure, above=0)
    quiet = flag("quiet", quiet)
    # The tolerance prevents that rounding removes a pixel.
    pixels = max(int(size / PITCH * (1 + 1e-9)), 1) if pixels is None else whole("pixels", pixels, least=1)
    brightness = _brightness(path, pixels)
    rows, columns = np.indices(brightness.shape)
    pitch = size / pixels
    x = (columns - (brightness.shape[1] - 1) / 2) * pitch
    y = ((brightness.shape[0] - 1) / 2 - rows) * pitch
    light = brightness >= DARK
    if not light.any():
        raise refused("path", path, "it is dark everywhere (black or transparent), give white on black")
    kept = light | quiet
    points = np.stack([x[kept], y[kept], np.full(int(kept.sum()), z)], axis=1)
    pressures = pressure * np.where(light, brightness, 0.0)[kept]
    return Picture(points, pressures, np.ones(len(points)))


def _brightness(path: str | PathLike[str], pixels: int) -> NDArray[np.float64]:
    """Return the brightness, 0 to 1, of squares (rows, columns), with `pixels` squares on the longer side."""
    file = existing("path", path, "give a picture such as a .png")
    with needs("image needs Pillow", "shapes"):
        from PIL import Image, ImageOps
    try:
        with Image.open(BytesIO(content(file)), formats=FORMATS) as opened:
            longer = max(opened.size)
            needed, most = opened.width * opened.height * EACH, memory_limit()
            if needed > most:
                memory = f"{needed / 1e6:.0f} MB of {most / 1e6:.0f} allowed"
                cure = f"{opened.width} x {opened.height} pixels need {memory}, make it smaller"
                raise refused("path", file, cure)
            few = [max(round(side * pixels / longer), 1) for side in opened.size]
            if few[0] * few[1] > MOST_POINTS:
                raise refused("pixels", pixels, f"more than {MOST_POINTS} points, give fewer")
            # Cameras store photographs rotated, with a tag for the correct orientation.
            upright = ImageOps.exif_transpose(opened)
            if upright.size != opened.size:
                few.reverse()
            if upright.mode == "F":
                raise refused("path", file, "its pixels are fractions, save it with 8 bits a colour")
            if upright.mode.startswith("I"):
                # Pillow would clip 16-bit values at 255.
                upright = Image.fromarray((np.asarray(upright) / 257).clip(0, 255).astype(np.uint8))
            colours = upright.convert("RGBA")
            black = Image.new("RGBA", colours.size, (0, 0, 0, 255))
            grey = Image.alpha_composite(black, colours).convert("L")
            small = grey.resize((few[0], few[1]), Image.Resampling.BOX)
    except SceneError:
        raise
    except Image.DecompressionBombError as error:
        raise refused("path", file, "it has more than 178 million pixels, make it smaller") from error
    # Pillow raises errors of many kinds for a damaged file.
    except Exception as error:
        cure = f"it cannot be read as a picture, give a file of {', '.join(FORMATS[:-1])} or {FORMATS[-1]}"
        raise refused("path", file, cure) from error
    return np.asarray(small, np.float64) / 255
