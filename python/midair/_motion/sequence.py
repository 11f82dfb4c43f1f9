"""`midair.Sequence`: frames that follow one another, their pictures and their files."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from .._midair import Plane, SceneError
from .._support.arguments import path_of
from .._support.slips import Later
from . import files
from .animation import animate
from .judged import JudgedFrames
from .picture import motion

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

    from .._pictures.colours import Map
    from .._pictures.sheet import Size
    from .picture import Panel


class Sequence(JudgedFrames):
    """Frames of points and drives that follow one another, wherever they come from.

    array : the midair.Array
    points : (T, M, 3) in m, the points of each frame
    targets : (T, M) in Pa, (M,) or one number; 0 where a point is not there in that frame
    drives : (T, N), complex of |q| <= 1, or whole numbers: codes l of the phases 2 pi l/L at full amplitude
    rate : frames a second; frame t is played from t/rate to (t + 1)/rate
    closed : whether the first frame follows the last
    change : the bound of the solve, in rad a frame, if any
    quantization : the board, as `midair.Array` takes it; left out, the array's own; codes need its phases
    solver : the name of what solved it
    medium : frequency, sound_speed or temperature, absorption, density, obstacles, signature and
        bead, as for `midair.Scene`

    A sequence does not change, compares by value and pickles. Raises SceneError for whatever is not in order.

    >>> import midair, numpy as np
    >>> array, angle = midair.Array.preset("autd3"), np.linspace(0, 2 * np.pi, 50, endpoint=False)
    >>> points = np.stack([0.01 * np.cos(angle), 0.01 * np.sin(angle), 0.15 + 0 * angle], axis=1)
    >>> gains = midair.Scene(array, points).propagation()
    >>> sequence = midair.Sequence(
    ...     array, points[:, None], 1000.0, (gains / abs(gains)).conj(), rate=5e3, closed=True
    ... )
    >>> sequence.metrics.uniformity
    1.0
    """

    def plot(
        self,
        ax: Axes | None = None,
        *,
        cmap: Map | None = None,
        panels: Panel | Iterable[Panel] | None = None,
        size: Size | None = None,
    ) -> Figure:
        """Waterfalls of |p| / target and of phase changes, and the spectrum of the radiation pressure.

        ax : axes of your own for one panel, the first of `panels`
        cmap : a colour map of matplotlib or its name
        panels : "pressures", "changes", "spectrum" or several; left out, all
        size : of the figure in inches, its width or (width, height)

        Returns the figure. Raises SceneError for another colour map, panel or size.
        """
        return motion(self, ax, cmap=cmap, panels=panels, size=size)

    def animate(
        self,
        path: str | PathLike[str],
        *,
        plane: Plane | None = None,
        frames: int | None = None,
        fps: int = 20,
        progress: Callable[[int, int], object] | None = None,
    ) -> None:
        """Write |p| in a plane, frame after frame, as .webp, .gif or, by ffmpeg, .mp4.

        plane : left out, one through the points of all frames
        frames : how many of the frames are shown, evenly chosen; left out, 100 at most
        fps : pictures a second
        progress : called with (pictures drawn, pictures)

        The file is written whole or not at all, and Ctrl-C leaves nothing.

        Raises SceneError for another ending, a path that cannot be written, or frames and fps that are not in
        order.
        """
        animate(self, path, plane, frames, fps, progress)

    exposure = Later("_judging.exposure", "exposure")

    def save(self, path: str | PathLike[str]) -> None:
        """Write it as .npz: points, targets, drives (or codes), scene (array and air) and setting as JSON.

        Raises SceneError for another ending, and for a path that cannot be written.
        """
        arrays = {"points": self._points, "targets": self._targets, "drives": self._drives.kept}
        files.save(path, arrays, self._scene, self.setting())

    @staticmethod
    def load(path: str | PathLike[str]) -> Sequence:
        """Read what `save` wrote, to the last bit. A file is never run.

        Raises SceneError for a file that is not in order, FileNotFoundError where there is none.
        """
        source = path_of("path", path)
        name = " ".join(str(source).split())
        try:
            return Sequence(**files.load(source))
        except SceneError as error:
            raise SceneError(f'sequence file "{name}": {error}') from error
        except FileNotFoundError:
            raise
        # Whatever a damaged file makes zip, NumPy and JSON raise.
        except Exception as error:
            raise SceneError(
                f'sequence file "{name}" is damaged, or none: give what sequence.save wrote'
            ) from error

    def to_xarray(self) -> Dataset:
        """Points, targets, pressures, changes and drives (or codes), with dimensions, as xarray.Dataset.

        Raises SceneError where xarray is missing.
        """
        return dataset(self)


def dataset(sequence: JudgedFrames) -> Dataset:
    """Points, targets, |p|, changes and drives over time, point and transducer."""
    try:
        import xarray
    except ImportError as error:
        raise SceneError('to_xarray needs xarray: pip install "midair[motion]"') from error
    board = {} if sequence.codes is None else {"phases": (sequence.quantization or {})["phases"]}
    drives = ("drives", sequence.drives, {}) if sequence.codes is None else ("codes", sequence.codes, board)
    variables: dict[str, tuple[tuple[str, ...], Any, dict[str, Any]]] = {
        "points": (("time", "point", "axis"), sequence.points, {"units": "m"}),
        "targets": (("time", "point"), sequence.targets, {"units": "Pa"}),
        "pressures": (("time", "point"), sequence.pressures, {"units": "Pa", "long_name": "|p|, peak"}),
        "changes": (("time",), sequence.changes, {"units": "rad", "long_name": "largest phase change"}),
        drives[0]: (("time", "transducer"), *drives[1:]),
        "positions": (("transducer", "axis"), sequence.array.positions, {"units": "m"}),
    }
    coordinates = {"time": ("time", sequence.times, {"units": "s"}), "axis": list("xyz")}
    reported = {"rate": sequence.rate, "closed": int(sequence.closed), "solver": sequence.solver}
    bound = {} if sequence.change is None else {"change": sequence.change}
    copies = {name: (dims, np.array(values), attrs) for name, (dims, values, attrs) in variables.items()}
    return xarray.Dataset(copies, coordinates, reported | bound)
