"""`midair.Sequence`: consecutive frames, their pictures and files."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from .._midair import Plane
from .._pictures.colours import Axes, Figure, Size
from .._support.arguments import needs, path_of
from .._support.slips import Later
from .._support.text import reading
from . import files
from .frames import Frames
from .picture import animate, motion

if TYPE_CHECKING:
    from xarray import Dataset

    from .picture import Panel


class Sequence(Frames):
    """Frames of points and drives that follow one another, from any source.

    Parameters
    ----------
    array : midair.Array
        N transducers.
    points : (T, M, 3) array_like
        Points of each frame in m.
    targets : (T, M) or (M,) array_like, or float
        Peak pressures in Pa; 0 in frames where a point is absent.
    drives : (T, N) array_like
        Complex, |q| <= 1. Or whole numbers: codes l of the phases 2 pi l/L at full amplitude.
    rate : float
        Frames per second; frame t is played from t/rate to (t + 1)/rate.
    closed : bool, optional
        Whether the first frame follows the last.
    change : float, optional
        Bound of the solve, in rad per frame.
    quantization : mapping, optional
        The board, as `midair.Array` takes it; by default the array's own; codes need its phases.
    solver : str, optional
        Name of the solver.
    **medium
        frequency, sound_speed or temperature, absorption, density, obstacles, signature and bead, as for
        `midair.Scene`.

    Raises
    ------
    SceneError
        For wrong arguments.

    See Also
    --------
    midair.sequence : solves for points that move.

    Notes
    -----
    A sequence does not change, compares by value and pickles.

    Examples
    --------
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
        self, ax: Axes | None = None, *, panels: Panel | Iterable[Panel] | None = None, size: Size | None = None
    ) -> Figure:
        """Draw |p| / target and phase changes over time, and the spectrum of the radiation pressure.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        panels : {"pressures", "changes", "spectrum"} or list of them, optional
            The panels to draw; by default all.
        size : float or (float, float), optional
            Size of the figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        SceneError
            If a panel or the size is invalid.
        """
        return motion(self, ax, panels=panels, size=size)

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

        Parameters
        ----------
        path : str or path
            File to write, whole or not at all; Ctrl-C leaves nothing.
        plane : midair.Plane, optional
            Plane to show; by default one through the points of all frames.
        frames : int, optional
            Number of frames shown, evenly chosen; by default at most 100.
        fps : int, optional
            Pictures per second.
        progress : callable, optional
            Called with (pictures drawn, pictures).

        Raises
        ------
        SceneError
            If the ending is unknown, the path cannot be written, or `frames` or `fps` is invalid.
        """
        animate(self, path, plane, frames, fps, progress)

    exposure = Later("_judging.exposure", "exposure")
    """Compute sound pressure levels at named places: `midair.exposure` of the sequence."""

    def save(self, path: str | PathLike[str]) -> None:
        """Write the sequence as .npz: points, targets, drives (or codes), scene (array and air) and settings.

        As .csv, only the drives: rows frame,index,x,y,z,amplitude,phase.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        SceneError
            If the file's ending is unknown, or the path cannot be written.
        """
        if path_of("path", path).suffix.lower() == ".csv":
            with files.whole(path, (".csv",)) as part:
                each = (self.drive(frame) for frame in range(len(self)))
                files.write_csv(part, self.array, each, len(self))
            return
        arrays = {"points": self._points, "targets": self._targets, "drives": self._drives.kept}
        files.save(path, arrays, self._scene, self.setting())

    @staticmethod
    def load(path: str | PathLike[str]) -> Sequence:
        """Read a file of `save`; values are equal to the last bit. Never executes a file.

        Parameters
        ----------
        path : str or path
            File to read.

        Returns
        -------
        midair.Sequence
            An equal sequence.

        Raises
        ------
        SceneError
            For a file with an error; FileNotFoundError for a missing one.
        """
        source = path_of("path", path)
        with reading("sequence", source, "give what sequence.save wrote"):
            return Sequence(**files.load(source))

    def to_xarray(self) -> Dataset:
        """Return points, targets, pressures, changes and drives (or codes), with named dimensions.

        Returns
        -------
        xarray.Dataset
            The arrays over time, point, transducer and axis.

        Raises
        ------
        SceneError
            If xarray is not installed.
        """
        return dataset(self)


def dataset(sequence: Frames) -> Dataset:
    """Return points, targets, |p|, changes and drives as a dataset over time, point and transducer."""
    with needs("to_xarray needs xarray", "motion"):
        import xarray
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
