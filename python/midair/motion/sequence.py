"""`midair.Sequence`: frames that follow one another, and what the points and a hand get of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Field, Plane, Scene, SceneError, field
from ..shape.arguments import number, path_of
from . import arguments, files
from .between import Between, between
from .blocks import blocks
from .envelope import Envelope, Hold
from .felt import BANDS, Felt, spectrum
from .frames import Frames
from .metrics import SequenceMetrics, measure
from .noise import noise
from .propagation import pressures, rows

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

#: Time constant in s at which the noise of a sequence is told where none is given.
TAU = 0.2e-3


class Sequence(Frames):
    """Frames of points and drives that follow one another, wherever they come from.

    array : the midair.Array
    points : (T, M, 3) in m, the points of each frame
    targets : (T, M) in Pa, (M,) or one number; 0 where a point is not there in that frame
    drives : (T, N), complex of |q| <= 1, or whole numbers: codes l of the phases 2 pi l/L at full amplitude
    rate : frames a second; frame t is played from t/rate to (t + 1)/rate
    closed : whether the first frame follows the last
    change : the bound that held when it was solved, in rad a frame, if any
    quantization : the board, as `midair.Array` takes it; left out, the array's own; codes need its phases
    solver : the name of what solved it
    medium : frequency, sound_speed or temperature, absorption, density and obstacles, as for `midair.Scene`

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

    @property
    def times(self) -> NDArray[np.float64]:
        """The start (T,) of each frame, in s."""
        return np.arange(len(self)) / self._rate

    def drive(self, frame: int) -> NDArray[np.complex64]:
        """The drive (N,) of a frame.

        Raises IndexError where there is no such frame.
        """
        return self._drives[frame]

    def scene(self, frame: int) -> Scene:
        """A frame's points that are there and their targets, as a scene; all points where none is there.

        Raises IndexError where there is no such frame.
        """
        there = self._targets[frame] > 0
        if not there.any():
            return self._scene.replace(points=self._points[frame])
        return self._scene.replace(points=self._points[frame][there], pressures=self._targets[frame][there])

    def field(self, frame: int, plane: Plane | None = None) -> Field:
        """The field of a frame at rest in a plane, by `midair.field`.

        Raises IndexError where there is no such frame.
        """
        return field(self.scene(frame), self.drive(frame), plane)

    @cached_property
    def pressures(self) -> NDArray[np.float64]:
        """|p| (T, M) in Pa of each frame's drive at its points, at rest: p_j(t) = sum_i G_ji(t) q_i(t)."""
        return _fixed(pressures(self._scene, self._points, self._drives))

    @property
    def radiation(self) -> NDArray[np.float64]:
        """Radiation pressure (T, M) in Pa on a wall at normal incidence, |p|^2/(rho c^2)."""
        return self.pressures**2 / (self._scene.density * self._scene.sound_speed**2)

    @cached_property
    def changes(self) -> NDArray[np.float64]:
        """The largest |phase change| (T,) in rad of any transducer to the frame before.

        Frame 0 is compared with the last one where the sequence is closed, else 0. A transducer whose
        amplitude is 0 in one of the two frames does not count.
        """
        largest = np.empty(len(self))
        for frames in blocks(len(self), len(self.array)):
            largest[frames] = self._drives.changes(frames, self._closed).max(axis=1, initial=0.0)
        return _fixed(largest)

    def each_change(self, start: int, stop: int) -> NDArray[np.float32]:
        """|Phase change| (stop - start, N) in rad of every transducer in some frames, as in `changes`."""
        first, last, _ = slice(start, stop).indices(len(self))
        return self._drives.changes(slice(first, max(first, last)), self._closed)

    @cached_property
    def metrics(self) -> SequenceMetrics:
        """Metrics of the frames at rest; the noise is that of held drives and tau = 0.2 ms."""
        return self.judge()

    def judge(self, tau: float | None = None, *, hold: Hold = "hold", substeps: int = 4) -> SequenceMetrics:
        """Metrics in motion: of the pressures inside the frames, as `between` has them.

        Left out, tau means frames at rest, and 0.2 ms for the noise. A target holds for its frame.

        Raises SceneError for a tau below 0, an unknown hold and substeps below 1.
        """
        heard = self._envelope(TAU if tau is None else tau, hold)
        steps = arguments.substeps(substeps)
        if tau is None:
            got, targets = self.pressures, self._targets
        else:
            got, targets = self._between(heard, steps).pressures, np.repeat(self._targets, steps, axis=0)
        return measure(got, targets, self.changes, self._closed, noise(heard))

    @property
    def summary(self) -> str:
        """What it is, and its metrics, as a table of text."""
        return f"{self._heading()}\n{self.metrics!r}"

    def between(self, tau: float, hold: Hold = "hold", substeps: int = 4) -> Between:
        """`times` (T substeps,) in s and |p| `pressures` (T substeps, M) in Pa inside the frames.

        tau : time constant in s of the transducers, y' = (q - y)/tau; 0 for none. By a bandwidth B at -6 dB,
            tau = sqrt(3)/(pi B)
        hold : "hold" where the board keeps each drive for its frame, "linear" where it goes on to the next
            frame's amplitude and, the shorter way round, phase in equal steps, as AUTD3's Silencer does
        substeps : times a frame, at (t + k/substeps)/rate

        The answer y of the transducers is exact at these times. Points go straight from frame to frame. The
        first drive of an open sequence has been played for ever before it begins; a closed one repeats.

        Raises SceneError for a tau below 0, an unknown hold and substeps below 1.
        """
        return self._between(self._envelope(tau, hold), arguments.substeps(substeps))

    def felt(
        self,
        place: ArrayLike,
        *,
        area: float | None = None,
        bands: Any = BANDS,
        tau: float = 0.0,
    ) -> Felt:
        """Radiation pressure at a fixed place (3,), or its mean over a patch (K, 3), at each frame's start.

        It is |p|^2/(rho c^2) in Pa, on a wall at normal incidence; with the patch's `area` in m^2, the force
        area times mean in mN.

        bands : pairs (low, high) in Hz whose rms is told
        tau : time constant of the transducers in s, 0 for none

        Amplitude modulation (1 + cos)/2 has 3/8 of the force of full amplitude as its static part,
        sqrt((1 + cos)/2) has 1/2 and one line. The spectrum takes the sequence as repeated.

        Raises SceneError for a place, area, tau or bands that are not in order.
        """
        places = arguments.places(place)
        size = None if area is None else number("area", area, above=0)
        read = arguments.bands(bands, self._rate, len(self))
        gains = rows(self._scene, places, name="place")
        values = np.empty(len(self))
        for frames, _, y in self._envelope(tau, "hold").inside(1):
            pressure = np.abs(y[:, 0] @ gains.T).astype(np.float64)
            values[frames] = np.mean(pressure**2, axis=1)
        values /= self._scene.density * self._scene.sound_speed**2
        if size is not None:
            values *= 1e3 * size
        lines = spectrum(values, self._rate)
        return Felt(self.times, values, *lines, read, "Pa" if size is None else "mN")

    def plot(self) -> Figure:
        """Waterfalls of |p| / target and of phase changes, and the spectrum of the radiation pressure."""
        from ..plot.motion import motion

        return motion(self)

    def animate(
        self,
        path: str | PathLike[str],
        *,
        plane: Plane | None = None,
        frames: int | None = None,
        fps: int = 20,
        progress: Callable[[int, int], object] | None = None,
    ) -> None:
        """Write |p| in a plane, frame after frame, as .gif or, by ffmpeg, .mp4.

        plane : left out, one through the points of all frames
        frames : how many of the frames are shown, evenly chosen; left out, 100 at most
        fps : pictures a second
        progress : called with (pictures drawn, pictures)

        The file is written whole or not at all, and Ctrl-C leaves nothing.

        Raises SceneError for another ending, a path that cannot be written, or frames and fps that are not in
        order.
        """
        from .animation import animate

        animate(self, path, plane, frames, fps, progress)

    def save(self, path: str | PathLike[str]) -> None:
        """Write it as .npz: points, targets, drives (or codes), scene (array and air) and setting as JSON.

        Raises SceneError for another ending, and for a path that cannot be written.
        """
        arrays = {"points": self._points, "targets": self._targets, "drives": self._drives.held}
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
        except OSError:
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
        from .labelled import dataset

        return dataset(self)

    def _envelope(self, tau: float, hold: Hold) -> Envelope:
        held = arguments.hold(hold)
        return Envelope(self._drives, self._rate, self._closed, arguments.time_constant(tau), held)

    def _between(self, envelope: Envelope, substeps: int) -> Between:
        return between(self._scene, self._points, self._targets, envelope, substeps)


def _fixed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    values.flags.writeable = False
    return values
