"""`midair.Flight`: tracks of beads, their pictures and animations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from .._sequence import animation
from .._support import text
from .._support.arguments import callback, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .._pictures.figures import Size

#: The panels of a flight's picture.
Way = Literal["path", "distance"]


@dataclass(frozen=True, eq=False)
class Flight:
    """Tracks of beads in flight; from `midair.fly`.

    Attributes
    ----------
    times : (T,) ndarray
        Times in s.
    places, points : (T, B, 3) ndarray
        Places in m of the beads (NaN after they are lost), and of their points.
    lost : (B,) ndarray
        Time in s when each bead is lost; NaN if it stays trapped.
    beads : (B,) ndarray of int
        Number of each bead's point in the sequence.

    Examples
    --------
    >>> import midair
    >>> boards = midair.Array.preset("openmpd_pair", quantization={})
    >>> still = midair.path.still([0, 0, 0], duration=0.02)
    >>> flight = midair.fly(midair.sequence(boards, still, rate=1000, signature="trap"))
    >>> flight.places.shape[1:], bool(flight.farthest[0] < 2e-3)
    ((1, 3), True)
    """

    times: NDArray[np.float64]
    places: NDArray[np.float64]
    points: NDArray[np.float64]
    lost: NDArray[np.float64]
    beads: NDArray[np.intp]

    @property
    def held(self) -> NDArray[np.bool_]:
        """Whether each bead (B,) stays trapped to the end."""
        return np.isnan(self.lost)

    @property
    def distances(self) -> NDArray[np.float64]:
        """Distances (T, B) in m of the beads from their points; NaN after a bead is lost."""
        found: NDArray[np.float64] = np.linalg.norm(self.places - self.points, axis=2)
        return found

    @property
    def farthest(self) -> NDArray[np.float64]:
        """Largest distance (B,) in m of each bead from its point before it is lost."""
        found: NDArray[np.float64] = np.fmax.reduce(self.distances, axis=0, initial=0.0)
        return found

    def plot(
        self,
        ax: Axes | None = None,
        *,
        panels: Way | Iterable[Way] | None = None,
        size: Size | None = None,
    ) -> Figure:
        """Draw tracks of beads and points along the axis of least extent, and distances over time.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        panels : {"path", "distance"} or list of them, optional
            The panels to draw; by default both. A cross marks where a bead was lost.
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
        from .._pictures.figures import row

        figure, axes = row(panels, get_args(Way), ax, size, width=4.8, height=4.0)
        for name, one in axes.items():
            _draw(self, name, one)
        return figure

    def animate(
        self,
        path: str | PathLike[str],
        *,
        frames: int | None = None,
        fps: int = 20,
        progress: Callable[[int, int], object] | None = None,
    ) -> None:
        """Write an animation of the beads in flight as .webp, .gif or, by ffmpeg, .mp4.

        Parameters
        ----------
        path : str or path
            File to write, whole or not at all.
        frames, fps : int, optional
            Number of pictures, evenly chosen, by default at most 100; pictures per second.
        progress : callable, optional
            Called with (pictures drawn, pictures).

        Raises
        ------
        SceneError
            If the ending is unknown, the path cannot be written, or `frames` or `fps` is invalid.
        """
        callback(progress, "pictures drawn, pictures")
        most = animation.PICTURES if frames is None else whole("frames", frames, least=1)
        count = min(len(self.times), most)
        fps = whole("fps", fps, least=1)
        animation.write(path, fps, count, self._pictures(count), progress)

    def _pictures(self, count: int) -> Iterator[Any]:
        """Yield pictures (height, width, 3) of the tracks, with the beads at equal intervals of time."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(5.2, 4.6), dpi=animation.DPI, layout="constrained")
        canvas = cast(Any, FigureCanvasAgg)(figure)
        ax = figure.subplots()
        _draw(self, "path", ax)
        first, second = _across(self)
        (dots,) = ax.plot([], [], "o", color="black", markersize=5)
        for k in np.arange(count) * len(self.times) // count:
            dots.set_data(1e3 * self.places[k, :, first], 1e3 * self.places[k, :, second])
            ax.set_title(f"{1e3 * self.times[k]:.1f} ms", fontsize="medium")
            canvas.draw()
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()

    def __repr__(self) -> str:
        lasts = 1e3 * (self.times[-1] - self.times[0])
        head = f"Flight of {lasts:.4g} ms: {int(self.held.sum())} of {len(self.lost)} held"
        return f"{head}\n{text.plain(self._cells())}"

    def _repr_html_(self) -> str:
        return text.html(self._cells())

    def _cells(self) -> dict[str, list[str]]:
        return {
            "bead": [str(one + 1) for one in range(len(self.lost))],
            "point": [str(point + 1) for point in self.beads],
            "largest distance": [f"{1e3 * far:.3f} mm" for far in self.farthest],
            "lost": ["-" if np.isnan(lost) else f"after {1e3 * lost:.1f} ms" for lost in self.lost],
        }


def _across(flight: Flight) -> list[int]:
    """Return the two axes along which the points of a flight move most."""
    sides = np.ptp(flight.points, axis=(0, 1))
    return sorted(np.argsort(-sides, kind="stable")[:2].tolist())


def _draw(flight: Flight, panel: Way, ax: Axes) -> None:
    if panel == "distance":
        for one, distances in enumerate(1e3 * flight.distances.T):
            ax.plot(1e3 * flight.times, distances, linewidth=0.9, label=f"bead {one + 1}")
        ax.set(xlabel="time / ms", ylabel="distance from its point / mm", ylim=(0, None))
        if len(flight.lost) > 1:
            ax.legend(loc="best", fontsize="small")
        return
    first, second = _across(flight)
    for one in range(len(flight.lost)):
        point, place = 1e3 * flight.points[:, one], 1e3 * flight.places[:, one]
        ax.plot(point[:, first], point[:, second], color="lightgrey", linewidth=2.5, zorder=1)
        ax.plot(place[:, first], place[:, second], linewidth=0.9, zorder=2)
        there = np.flatnonzero(~np.isnan(place[:, 0]))
        if not flight.held[one] and len(there):
            ax.plot(*place[there[-1], [first, second]], "x", color="red", zorder=3)
    ax.set(aspect="equal", xlabel=f"{'xyz'[first]} / mm", ylabel=f"{'xyz'[second]} / mm")
