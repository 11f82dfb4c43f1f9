"""Base class of `midair.Sequence`: data of frames, and their pressures, phase changes, metrics and pushes."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from html import escape
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Field, Moving, Plane, Pushes, Scene, field, scene_keys
from .._pictures.notebook import sequence
from .._support import output, text
from .._support.arguments import flag, frame_rate, number, refused, warn, whole, word
from . import drives as driven
from .drives import Between, Envelope, Hold, between, blocks, pressures, rows
from .felt import BANDS, Felt, bands_of, noise, places_of, spectrum

#: Names of the arguments for the air, for obstacles in it, and for the kind of points.
AIR = (*scene_keys()["medium"], "obstacles", "signature", "bead")


def air_of(scene: Scene) -> dict[str, Any]:
    """Return the air of a scene, obstacles in it, and the kind of its points, as driven."""
    return {**scene.medium, **{name: getattr(scene, name) for name in ("obstacles", "signature", "bead")}}


#: Time constant of the transducers in s that the metric `noise` uses by default.
TAU = 0.2e-3

#: Decaying values may underflow to 0; this must raise no error if the caller has set
#: np.seterr(under="raise").
SETTLING = np.errstate(under="ignore")


@dataclass(frozen=True)
class SequenceMetrics:
    """Quality of a sequence over the points that are present, x_j(t) = |p_j(t)| / target_j(t).

    Attributes
    ----------
    level : float
        Mean over time of mean_j x_j.
    uniformity, uniformity_median : float
        Least and median over time of min_j x_j / max_j x_j.
    largest_change : float
        Largest phase change in rad of any transducer from a frame to the next; the seam does not count.
    seam : float or None
        Largest change from the last frame to the first, in rad; None where the sequence is open.
    dip : float
        Least x_j of any point at any time, relative to the mean over time of this point's x_j.
    noise : float
        dB re full amplitude modulation at 200 Hz of the same array; -200 for silence.

    Examples
    --------
    >>> import midair
    >>> ring = midair.path.circle([0, 0, 0.15], 0.01, frequency=50)
    >>> metrics = midair.sequence(midair.Array.preset("autd3"), ring, rate=10e3).metrics
    >>> metrics.uniformity, metrics.asdict()["seam"] == metrics.seam
    (1.0, True)
    """

    level: float
    uniformity: float
    uniformity_median: float
    largest_change: float
    seam: float | None
    dip: float
    noise: float

    def asdict(self) -> dict[str, float | None]:
        """Return the metrics by name."""
        return asdict(self)

    def __repr__(self) -> str:
        rows = self._rows()
        name, value = (max(len(row[k]) for row in rows) for k in (0, 1))
        return "\n".join(f"{row[0]:{name}}  {row[1]:>{value}}  {row[2]}" for row in rows)

    def _repr_html_(self) -> str:
        rows = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in self._rows())
        return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"

    def _rows(self) -> list[tuple[str, str, str]]:
        values = self.asdict()
        reported = {name: "-" if value is None else f"{value:.4f}" for name, value in values.items()}
        reported["noise"] = f"{self.noise:.1f}"
        meanings = text.meanings("motion")
        return [(name, reported[name], meanings[name.replace("_", " ")]) for name in values]


def measure(
    pressures: NDArray[np.float64],
    targets: NDArray[np.float64],
    changes: NDArray[np.float64],
    closed: bool,
    noise: float,
) -> SequenceMetrics:
    """Return the metrics of |p| (S, M), targets (S, M), 0 for absent points, and phase changes (T,)."""
    there = targets > 0
    received = there.any(axis=1)
    x = np.divide(pressures, targets, out=np.full(targets.shape, np.nan), where=there)[received]
    largest = np.nanmax(x, axis=1)
    even = np.divide(np.nanmin(x, axis=1), largest, out=np.zeros(len(x)), where=largest > 0)
    # A point that is absent in all frames has no mean.
    own = x[:, there.any(axis=0)]
    mean = np.nanmean(own, axis=0)
    dips = np.divide(np.nanmin(own, axis=0), mean, out=np.zeros(len(mean)), where=mean > 0)
    return SequenceMetrics(
        level=float(np.nanmean(x, axis=1).mean()),
        uniformity=float(even.min()),
        uniformity_median=float(np.median(even)),
        largest_change=float(changes[1:].max(initial=0.0)),
        seam=float(changes[0]) if closed else None,
        dip=float(dips.min()),
        noise=noise,
    )


class Frames:
    """Data of a `midair.Sequence`, whose documentation explains the arguments, and what follows from them."""

    def __init__(
        self,
        array: Array,
        points: ArrayLike,
        targets: ArrayLike,
        drives: ArrayLike,
        *,
        rate: float,
        closed: bool = False,
        change: float | None = None,
        quantization: Mapping[str, Any] | None = None,
        solver: str = "",
        **medium: Any,
    ) -> None:
        if not isinstance(array, Array):
            raise TypeError(f"expected a midair.Array first, not {type(array).__qualname__}")
        for name in medium.keys() - set(AIR):
            raise TypeError(f"Sequence has no argument {name!r}: of the air it takes {', '.join(AIR)}")
        self._points = driven.points(points)
        self._targets = driven.targets(targets, self._points.shape[:2])
        self._rate = frame_rate(rate)
        self._closed = flag("closed", closed)
        self._change = None if change is None else number("change", change, least=0)
        self._quantization = driven.quantization(quantization, array)
        self._solver = word("solver", solver)
        self._drives = driven.read(drives, array, (self._quantization or {}).get("phases"))
        if len(self._drives) != len(self._points):
            cure = f"points have {len(self._points)} frames, give as many"
            raise refused("drives.shape[0]", len(self._drives), cure)
        self._scene = Scene(array, self._points[0], **medium)

    @classmethod
    def _solved(cls, moving: Moving, drives: Any) -> Self:
        """Return the sequence of solved frames, with drives or codes (T, N) of the core."""
        made = cls.__new__(cls)
        made._scene, made._points, made._targets = moving.scene, moving.points, moving.targets
        made._rate, made._closed, made._change = moving.rate, moving.closed, moving.change
        made._quantization, made._solver = moving.quantization, moving.solver
        phases = (made._quantization or {}).get("phases") if drives.dtype.kind == "u" else None
        made._drives = driven.Drives(drives, driven.sounding(moving.scene.array), phases)
        return made

    @property
    def array(self) -> Array:
        """Array of the transducers."""
        return self._scene.array

    @property
    def points(self) -> NDArray[np.float64]:
        """Points (T, M, 3) of each frame in m."""
        return self._points

    @property
    def targets(self) -> NDArray[np.float64]:
        """Targets (T, M) in Pa, 0 where a point is absent."""
        return self._targets

    @property
    def rate(self) -> float:
        """Frames per second."""
        return self._rate

    @property
    def closed(self) -> bool:
        """Whether the sequence repeats: its first frame follows its last."""
        return self._closed

    @property
    def change(self) -> float | None:
        """Bound of the phase change, in rad per frame, within which the frames were solved, or None."""
        return self._change

    @property
    def quantization(self) -> dict[str, Any] | None:
        """Quantization of the board, as in `midair.Array.quantization`; None if any drive is possible."""
        return self._quantization

    @property
    def solver(self) -> str:
        """Name of the solver."""
        return self._solver

    @property
    def codes(self) -> NDArray[Any] | None:
        """Codes l (T, N) of the phases 2 pi l/L, uint8 or uint16, or None if drives are complex."""
        return None if self._drives.phases is None else self._drives.kept[:]

    @property
    def drives(self) -> NDArray[np.complex64]:
        """Drives (T, N), |q| <= 1, 0 where a transducer is off; codes are converted at each access."""
        return self._drives[:]

    def __len__(self) -> int:
        return len(self._points)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frames):
            return NotImplemented
        same = output.to_json(self._setting()) == output.to_json(other._setting())
        arrays = (
            (self._points, other._points),
            (self._targets, other._targets),
            (self._drives.kept, other._drives.kept),
        )
        return (
            same
            and self._scene == other._scene
            and all(mine.dtype == theirs.dtype and np.array_equal(mine, theirs) for mine, theirs in arrays)
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        made = partial(type(self), **air_of(self._scene), **self._setting())
        return made, (self.array, self._points, self._targets, self._drives.kept)

    def __repr__(self) -> str:
        return f"<midair.{self._heading()}>"

    def _repr_html_(self) -> str:
        return sequence(self._scene.array, self._points, self._closed, self._facts())

    def _facts(self) -> list[tuple[str, str]]:
        frames, count = self._targets.shape
        board = "any" if self._drives.phases is None else str(self._drives.phases)
        facts = [
            (
                "midair.Sequence",
                f"{frames} frames at {self._rate:g} Hz, {'closed' if self._closed else 'open'}",
            ),
            ("time", f"{frames / self._rate:.4g} s"),
            ("points", str(count)),
            ("transducers", str(len(self.array))),
            ("phases", board),
        ]
        bound = [] if self._change is None else [("bound", f"{self._change:.4g} rad a frame")]
        return facts + bound + ([("solver", self._solver)] if self._solver else [])

    def _heading(self) -> str:
        frames, count = self._targets.shape
        how = f"{'closed' if self._closed else 'open'}{f', by {self._solver}' if self._solver else ''}"
        size = f"{frames} frames at {self._rate:g} Hz, {count} points, {len(self.array)} transducers"
        return f"Sequence of {size}: {how}"

    def setting(self) -> dict[str, Any]:
        """Return the arguments of an equal sequence, except array, points, targets and drives."""
        return {**self._setting(), **self._scene.medium}

    def _setting(self) -> dict[str, Any]:
        names = ("rate", "closed", "change", "quantization", "solver")
        return {name: getattr(self, name) for name in names}

    @property
    def times(self) -> NDArray[np.float64]:
        """Start (T,) of each frame in s."""
        return np.arange(len(self)) / self._rate

    def drive(self, frame: int) -> NDArray[np.complex64]:
        """Return the drive of a frame.

        Parameters
        ----------
        frame : int
            Number of the frame.

        Returns
        -------
        (N,) ndarray of complex64
            Its drive.

        Raises
        ------
        IndexError
            If there is no such frame.
        """
        return self._drives[frame]

    def scene(self, frame: int) -> Scene:
        """Return the points that are present in a frame, and their targets, as a scene.

        Parameters
        ----------
        frame : int
            Number of the frame.

        Returns
        -------
        midair.Scene
            The scene; with all points if none is present.

        Raises
        ------
        IndexError
            If there is no such frame.
        """
        there = self._targets[frame] > 0
        if not there.any():
            return self._scene.replace(points=self._points[frame])
        return self._scene.replace(points=self._points[frame][there], pressures=self._targets[frame][there])

    def field(self, frame: int, plane: Plane | None = None) -> Field:
        """Compute the field of a frame if its drive is kept.

        Parameters
        ----------
        frame : int
            Number of the frame.
        plane : midair.Plane, optional
            Plane of the field, as for `midair.field`.

        Returns
        -------
        midair.Field
            The field.

        Raises
        ------
        IndexError
            If there is no such frame.
        """
        return field(self.scene(frame), self.drive(frame), plane)

    @cached_property
    def pressures(self) -> NDArray[np.float64]:
        """|p| (T, M) in Pa at each frame's points if its drive is kept: p_j(t) = sum_i G_ji(t) q_i(t)."""
        return _fixed(pressures(self._scene, self._points, self._drives))

    @property
    def rms(self) -> NDArray[np.float64]:
        """Peak pressure (M,) in Pa of a constant sound that has the mean |p|^2 of the frames."""
        mean_square: NDArray[np.float64] = (self.pressures**2).mean(axis=0)
        return np.sqrt(mean_square)

    @property
    def radiation(self) -> NDArray[np.float64]:
        """Radiation pressure (T, M) in Pa on a wall at normal incidence, |p|^2/(rho c^2)."""
        return self.pressures**2 / (self._scene.density * self._scene.sound_speed**2)

    @cached_property
    def changes(self) -> NDArray[np.float64]:
        """Largest |phase change| (T,) in rad of any transducer from the previous frame.

        For frame 0 the previous frame is the last one if the sequence is closed; otherwise the change is 0. A
        transducer whose amplitude is 0 in one of the two frames does not count.
        """
        largest = np.empty(len(self))
        for frames in blocks(len(self), len(self.array)):
            largest[frames] = self._drives.changes(frames, self._closed).max(axis=1, initial=0.0)
        return _fixed(largest)

    def each_change(self, start: int, stop: int) -> NDArray[np.float32]:
        """Return the |phase change| of every transducer in some frames, as in `changes`.

        Parameters
        ----------
        start, stop : int
            First frame, and the one after the last.

        Returns
        -------
        (stop - start, N) ndarray of float32
            Changes in rad.
        """
        first, last, _ = slice(start, stop).indices(len(self))
        return self._drives.changes(slice(first, max(first, last)), self._closed)

    @cached_property
    def metrics(self) -> SequenceMetrics:
        """Metrics of `pressures`; the noise is that of constant drives with tau = 0.2 ms."""
        return self.judge()

    @SETTLING
    def judge(self, tau: float | None = None, *, hold: Hold = "hold", substeps: int = 4) -> SequenceMetrics:
        """Compute metrics in motion: of the pressures inside the frames, as `between` returns them.

        Parameters
        ----------
        tau : float, optional
            Time constant in s of the transducers. By default the metrics are those of `pressures`; only
            the noise uses 0.2 ms.
        hold, substeps
            As for `between`; the targets of a frame apply to all of its sub-steps.

        Returns
        -------
        midair.SequenceMetrics
            The metrics.

        Raises
        ------
        SceneError
            For a tau below 0, an unknown hold and substeps below 1.
        """
        received = self._envelope(TAU if tau is None else tau, hold)
        steps = whole("substeps", substeps, least=1)
        if tau is None:
            got, targets = self.pressures, self._targets
        else:
            got, targets = self._between(received, steps).pressures, np.repeat(self._targets, steps, axis=0)
        return measure(got, targets, self.changes, self._closed, noise(received))

    @property
    def summary(self) -> str:
        """Size of the sequence and its metrics, as a table of text."""
        return f"{self._heading()}\n{self.metrics!r}"

    @SETTLING
    def between(self, tau: float, hold: Hold = "hold", substeps: int = 4) -> Between:
        """Compute the pressures during the frames, while the transducers follow their drives.

        Parameters
        ----------
        tau : float
            Time constant in s of the transducers, y' = (q - y)/tau; 0 for none. By a bandwidth B at -6 dB,
            tau = sqrt(3)/(pi B).
        hold : {"hold", "linear"}, optional
            "hold": the board keeps each drive for its frame. "linear": during a frame, amplitude and phase
            (the shorter way round) go to those of the next frame in equal steps, as with AUTD3's Silencer.
        substeps : int, optional
            Number of times per frame: (t + k/substeps)/rate in frame t, k = 0 to substeps - 1.

        Returns
        -------
        Between
            `times` (T substeps,) in s and |p| `pressures` (T substeps, M) in Pa.

        Raises
        ------
        SceneError
            For a tau below 0, an unknown hold and substeps below 1.

        Notes
        -----
        The answer y of the transducers is exact at these times. Points go straight from frame to frame. The
        first drive of an open sequence has been played for ever before it begins; a closed one repeats.
        """
        return self._between(self._envelope(tau, hold), whole("substeps", substeps, least=1))

    @SETTLING
    def felt(self, place: ArrayLike, *, area: float | None = None, bands: Any = BANDS, tau: float = 0.0) -> Felt:
        """Compute the radiation pressure at a fixed place, or its mean over a patch, at each frame's start.

        Parameters
        ----------
        place : (3,) or (K, 3) array_like
            A place in m, or the places of a patch.
        area : float, optional
            Area of the patch in m^2: the result is then a force, area times mean, in mN.
        bands : sequence of (float, float), optional
            Pairs (low, high) in Hz whose rms is reported; 0 for a band without a line.
        tau : float, optional
            Time constant of the transducers in s, 0 for none.

        Returns
        -------
        midair.Felt
            |p|^2/(rho c^2) in Pa, on a wall at normal incidence, or the force in mN.

        Raises
        ------
        SceneError
            For a wrong place, area, tau or bands.

        Notes
        -----
        The spectrum takes the sequence as repeated: its lines are rate/len(sequence) apart. A lap of 12.5 ms
        has lines at 80, 160, 240 Hz and so on, whatever the bands. Amplitude modulation (1 + cos)/2 has 3/8
        of the force of full amplitude as its static part, sqrt((1 + cos)/2) has 1/2 and one line.
        """
        places = places_of(place)
        if far := self._scene._far("place", places):
            warn(far)
        size = None if area is None else number("area", area, above=0)
        read = bands_of(bands)
        pushes = self._pushes(places, tau)
        values = np.concatenate([pushed.mean(axis=1, dtype=np.float64) for _, pushed in pushes])
        if size is not None:
            values *= 1e3 * size
        lines = spectrum(values, self._rate)
        return Felt(self.times, values, *lines, read, "Pa" if size is None else "mN")

    def _pushes(self, places: NDArray[np.float64], tau: float) -> Iterator[tuple[slice, NDArray[np.float32]]]:
        """Yield (frames, |p|^2/(rho c^2) (frames, K) in Pa) at places (K, 3), at each frame's start."""
        # A signature is a phase factor with which traps are solved like foci. The hand is in the real field,
        # without this factor.
        gains = rows(self._scene.replace(signature=None), places, name="place").T
        root = np.float32(1 / np.sqrt(self._scene.density * self._scene.sound_speed**2))
        for frames, _, y in self._envelope(tau, "hold").inside(1):
            parts = ((y[:, 0] * root) @ gains).view(np.float32)
            np.square(parts, out=parts)
            yield frames, parts[:, ::2] + parts[:, 1::2]

    def _push_lines(
        self, places: NDArray[np.float64], tau: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.complex64]]:
        """Return frequencies (L,) of lines up to 500 Hz, the mean (P,) and amplitudes (L, P) in Pa."""
        pushes = Pushes(len(self), self._rate, len(places))
        for frames, values in self._pushes(places, tau):
            pushes.add(frames.start, np.ascontiguousarray(values))
        return pushes.lines()

    def _envelope(self, tau: float, hold: Hold) -> Envelope:
        kept = driven.hold(hold)
        return Envelope(self._drives, self._rate, self._closed, driven.time_constant(tau), kept)

    def _between(self, envelope: Envelope, substeps: int) -> Between:
        return between(self._scene, self._points, self._targets, envelope, substeps)


def _fixed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    values.flags.writeable = False
    return values
