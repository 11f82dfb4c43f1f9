"""Result of a calibration: responses with their errors, its picture and its files."""

from __future__ import annotations

import io
from collections.abc import Iterable
from dataclasses import dataclass, fields
from os import PathLike
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene
from .._pictures.colours import MAPS, Axes, Figure, Map, Size
from .._support import output
from .._support.arguments import path_of
from .._support.text import arrays, counted, reading

#: The panels of a calibration's picture.
Panel = Literal["gain", "phase", "residuals"]
PANELS = get_args(Panel)


def _residuals(calibration: Calibration, ax: Axes) -> None:
    for m, received in enumerate(np.abs(calibration.residuals).T):
        ax.plot(received, ".^sxv"[m % 5], markersize=3, label=f"microphone {m + 1}")
    ax.axhline(calibration.noise, color="black", linewidth=0.8, label="standard deviation found")
    ax.set_title("residuals / Pa", fontsize="medium")
    # The legend stands above all residuals.
    ax.set(xlabel="drive", ylim=(0, 1.6 * float(np.abs(calibration.residuals).max()) or 1.0))
    ax.legend(loc="upper right", fontsize="small")


#: Styles of the marks of dead and reversed transducers.
RED: dict[str, dict[str, Any]] = {"x": {"c": "red"}, "o": {"facecolors": "none", "edgecolors": "red"}}


def _over_array(calibration: Calibration, ax: Axes, values: Any, colours: Map, ends: tuple[float, float]) -> None:
    places = calibration.array.positions * 1e3
    size = 1.5e4 / max(len(places), 60)
    x, y, _ = places.T
    shown = ax.scatter(x, y, size, values, cmap=colours, linewidths=0, vmin=ends[0], vmax=ends[1])
    for marked, sign, name in ((calibration.dead, "x", "dead"), (calibration.reversed, "o", "reversed")):
        if len(marked):
            label = f"{len(marked)} {name}"
            ax.scatter(x[marked], y[marked], 60, marker=sign, label=label, **RED[sign])
    if len(calibration.dead) + len(calibration.reversed):
        ax.legend(loc="upper right")
    ax.figure.colorbar(shown, ax=ax, shrink=0.8)
    ax.set_aspect("equal")
    ax.margins(0.06)
    ax.set(xlabel="x / mm", ylabel="y / mm")


#: Formats of a file: .npz has everything, the others the corrected scene.
ENDINGS = (".npz", ".toml", ".json")


@dataclass(frozen=True, eq=False, repr=False)
class Calibration:
    """Array as `midair.calibrate` found it, by K drives at M microphones.

    Errors are standard deviations.

    Attributes
    ----------
    response : (N,) ndarray of complex
        Responses relative to `source_pressure`, 0 if dead; their common phase is that of the array's own.
    response_error : (N,) ndarray
        Error of the real and of the imaginary part of each response.
    prior_share : (N,) ndarray
        Share of each response that the prior decides: the variance after the readings over the variance
        before them, 0 to 1.
    dead, reversed : ndarray of int
        Indices of transducers without sound, and of those with wires the wrong way round.
    sound_speed, sound_speed_error : float
        Sound speed in m/s, and its error.
    microphones, microphones_error : (M, 3) ndarray
        Places in m; errors of 0 for fixed places.
    pose, pose_error : (6,) ndarray
        Pose of the second board: moved by x, y, z in m; turned about x, y, z in rad about its centre.
    noise : float
        Standard deviation in Pa of a reading about the model: noise, and errors of the model.
    residuals : (K, M) ndarray
        Model minus readings, in Pa.
    outlying : (L, 2) ndarray of int
        Drive and microphone of each reading that lay far off the model and was left out.
    scene : midair.Scene
        The scene with the corrected array and sound speed.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.grid(4, 4, 10e-3)
    >>> scene = midair.Scene(array, [[0, 0, 0.1], [0.02, 0.03, 0.12]])
    >>> drives = midair.calibration_drives(array, 8, microphones=2)
    >>> found = midair.calibrate(scene, drives, abs(drives @ scene.propagation().T))
    >>> round(found.sound_speed), len(found.dead)
    (340, 0)
    """

    response: NDArray[np.complex128]
    response_error: NDArray[np.float64]
    prior_share: NDArray[np.float64]
    dead: NDArray[np.intp]
    reversed: NDArray[np.intp]
    sound_speed: float
    sound_speed_error: float
    microphones: NDArray[np.float64]
    microphones_error: NDArray[np.float64]
    pose: NDArray[np.float64]
    pose_error: NDArray[np.float64]
    noise: float
    residuals: NDArray[Any]
    outlying: NDArray[np.intp]
    scene: Scene

    @property
    def array(self) -> Array:
        """Corrected array."""
        return self.scene.array

    @property
    def gain(self) -> NDArray[np.float64]:
        """Gain |response| (N,) of each transducer."""
        return np.asarray(np.abs(self.response))

    @property
    def phase(self) -> NDArray[np.float64]:
        """Phase (N,) of each response in rad."""
        return np.asarray(np.angle(self.response))

    @property
    def gain_error(self) -> NDArray[np.float64]:
        """Error of each gain (N,)."""
        return self.response_error

    @property
    def phase_error(self) -> NDArray[np.float64]:
        """Error of each phase (N,) in rad; at most pi / sqrt(3), the error of an unknown phase."""
        unknown = np.pi / np.sqrt(3)
        least = np.maximum(self.response_error, 1e-30) / unknown
        return np.asarray(self.response_error / np.maximum(self.gain, least))

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        dead, turned = len(self.dead), len(self.reversed)
        faulty = f"{dead} dead and {turned} reversed" if dead + turned else "none dead or reversed"
        return (
            f"{counted(len(self.response), 'transducer')}, {faulty}; sound travels at "
            f"{self.sound_speed:.1f} m/s, and readings lie {self.noise:.3g} Pa off the model"
        )

    def __repr__(self) -> str:
        gain, error = (np.delete(each, self.dead).mean() for each in (self.gain, self.gain_error))
        parts = [
            f"{len(self.response)} transducers",
            f"gain {gain:.3g} +- {error:.2g}",
            f"{len(self.dead)} dead",
            f"{len(self.reversed)} reversed",
            f"{self.sound_speed:.2f} +- {self.sound_speed_error:.2g} m/s",
            f"noise {self.noise:.3g} Pa",
            f"prior's share {self.prior_share.mean():.0%}",
            *([f"{counted(len(self.outlying), 'reading')} left out"] if len(self.outlying) else []),
        ]
        return f"<Calibration: {', '.join(parts)}>"

    def plot(
        self,
        ax: Axes | None = None,
        *,
        cmap: Map | None = None,
        panels: Panel | Iterable[Panel] | None = None,
        size: Size | None = None,
    ) -> Figure:
        """Draw gains and phases over the array, dead and reversed ones marked, and the residuals.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        cmap : str or Colormap, optional
            A colour map of matplotlib for the gains.
        panels : {"gain", "phase", "residuals"} or list of them, optional
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
            If the colour map, a panel or the size is invalid.
        """
        from .._pictures.figures import colour_map, row

        figure, axes = row(panels, PANELS, ax, size, width=4.0, height=3.8)
        for name, one in axes.items():
            if name == "residuals":
                _residuals(self, one)
            elif name == "gain":
                colours = colour_map(cmap, MAPS["pressure"])
                _over_array(self, one, self.gain, colours, (0.0, float(self.gain.max())))
                one.set_title("gain", fontsize="medium")
            else:
                # The caller's colour map applies to the gains; phases need a cyclic one.
                degrees = np.degrees(self.phase)
                _over_array(self, one, degrees, MAPS["phase"], (-180.0, 180.0))
                one.set_title("phase / degrees", fontsize="medium")
        return figure

    def save(self, path: str | PathLike[str]) -> None:
        """Write everything as .npz, or the corrected scene as .toml or .json.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        SceneError
            If the file's ending is unknown, or the path cannot be written.
        """
        path = path_of("path", path)
        output.check(path, ENDINGS)
        if path.suffix.lower() != ".npz":
            self.scene.save(path)
            return
        kept = {field.name: getattr(self, field.name) for field in fields(self)}
        buffer = io.BytesIO()
        np.savez(buffer, **(kept | {"scene": self.scene.json()}))
        output.write(path, buffer.getvalue())

    @staticmethod
    def load(path: str | PathLike[str]) -> Calibration:
        """Read what `save` wrote as .npz.

        Parameters
        ----------
        path : str or path
            File to read.

        Returns
        -------
        midair.Calibration
            An equal calibration.

        Raises
        ------
        SceneError
            For a file with an error; FileNotFoundError for a missing one.
        """
        source = path_of("path", path)
        with reading("calibration", path, "give what calibration.save wrote as .npz"):
            found = arrays(source)
            numbers: dict[str, Any] = {
                field.name: value if (value := found[field.name]).ndim else value.item()
                for field in fields(Calibration)
            }
            return Calibration(**(numbers | {"scene": Scene.parse(str(found["scene"]))}))
