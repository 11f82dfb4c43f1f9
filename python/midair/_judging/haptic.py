"""`midair.haptic`: draws a shape so that it feels as strong or as even as a board allows."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Plane, SceneError, SceneWarning, Sheet, solve_batch
from .._motion import Sequence, Skin, sequence, skin
from .._motion.request import bound
from .._support.arguments import flag, number, real, refused, word
from ..path import Path
from .exposure import Exposure, exposure
from .schedule import Foci

#: Places of a focus along the shape: their distance in m, and their largest number.
STEP, MOST = 2e-3, 200

#: The skin is a square grid of points: their number per side, and the margin in m between shape and edge.
COARSE, MARGIN = 33, 0.015

#: Laps per second of a schedule: the fast tactile channel integrates over a lap, 0.2 s (Verrillo 1965).
LAPS = 5.0

#: Initial schedules of the ascent: jumps per period, their frequency in Hz, the length in m they cover.
JUMPS = ((5, 285.0, 0.03), (2, 285.0, 0.018))

#: Draw speeds in m/s: of the usual techniques, and further ones that are tried if there is a bound.
USUAL, SPEEDS = 7.0, (5.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True)
class Technique:
    """Positions of the foci along a shape in each frame.

    Attributes
    ----------
    name
        Name for the report.
    ways
        (T, M): place of each focus as a fraction of the shape's length, 0 to 1.
    amplitudes
        (T,): amplitude of the drive.
    """

    name: str
    ways: NDArray[np.float64]
    amplitudes: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Haptic:
    """Shape to be felt, and its predicted strength; from `midair.haptic`, a model (docs/touch.md).

    Attributes
    ----------
    sequence : midair.Sequence
        The drives, frame after frame.
    skin : midair.Skin
        Motion of the skin under the sequence.
    technique : str
        The chosen technique.
    aim : str
        "strong" or "even".
    strength, weakest : float
        Strength in dB above the threshold: the mean along the shape, and at its weakest place.
    standards : dict of str to float
        The four usual techniques, by name, with the same array, rate and bound: their `strength`, or their
        `weakest` if the aim is "even".
    exposure : midair.Exposure or None
        Levels at the ears, if any were given.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> line = [[-0.01, 0, 0.1], [0, 0, 0.1], [0.01, 0, 0.1]]
    >>> found = midair.haptic(line, array, rate=2e3, change=1.0)
    >>> len(found.standards), found.gain > 0
    (4, True)
    """

    sequence: Sequence
    skin: Skin
    technique: str
    aim: str
    strength: float
    weakest: float
    standards: dict[str, float]
    exposure: Exposure | None

    @property
    def gain(self) -> float:
        """Gain in dB over the best of the usual techniques, of the quantity that the aim maximises."""
        reached = self.strength if self.aim == "strong" else self.weakest
        return reached - max(self.standards.values())

    def __repr__(self) -> str:
        return "\n".join(f"{name:18}  {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        rows = (f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in self._rows())
        return f"<table>{''.join(rows)}</table>"

    def _rows(self) -> list[tuple[str, str]]:
        level = f"{self.strength:.1f} dB above threshold, {self.weakest:.1f} dB where it is weakest"
        where = "in the mean" if self.aim == "strong" else "at the weakest place"
        rows = [
            ("technique", self.technique),
            ("strength", level),
            *((name, f"{value:.1f} dB") for name, value in self.standards.items()),
            ("gain", f"{self.gain:+.1f} dB {where}"),
        ]
        if self.exposure is not None:
            rows.append(("loudest ear", f"{self.exposure.worst.spl:.1f} dB SPL"))
        return rows


def haptic(
    shape: Path | ArrayLike,
    array: Array,
    *,
    rate: float,
    aim: str = "strong",
    change: float | None = None,
    closed: bool = False,
    beside: float = 0.014,
    ears: Mapping[str, Any] | None = None,
    limit: str | float = "howard",
    **model: Any,
) -> Haptic:
    """Find the foci, frame by frame, with which a shape is felt best, by the model of `midair.skin`.

    Parameters
    ----------
    shape : midair.path.Path or (K, 3) array_like
        A path of one point, or places in m in the order in which they are drawn.
    array : midair.Array
        The transducers.
    rate : float
        Frames per second that the board plays.
    aim : {"strong", "even"}, optional
        "strong": the largest mean strength along the shape; "even": the largest at its weakest place.
    change : float, optional
        Bound in rad per frame; by default none.
    closed : bool, optional
        Whether the last place is joined to the first; not needed for a path.
    beside : float, optional
        Largest distance in m of foci from the shape, by default half a wavelength on the skin; 0: none.
    ears : mapping, optional
        Places, as `midair.exposure` takes them, that must not be louder than a limit. Otherwise the level is
        lowered, which needs a board with amplitudes.
    limit : str or float, optional
        The limit at the ears, as `midair.exposure` takes it.
    **model
        Properties of the skin: `speed`, `loss`, `mass` and `reach`, as for `midair.skin`.

    Returns
    -------
    midair.Haptic
        The sequence and its predicted strength.

    Raises
    ------
    SceneError
        For wrong arguments, and where the limit at the ears cannot be met.

    Notes
    -----
    The four usual techniques are amplitude modulation, lateral modulation, and one or two foci at 7 m/s. In
    addition, an ascent improves a schedule of single foci, 5 laps per second, until no other focus in any
    frame is predicted to be better. With a bound, other draw speeds are tried instead. If none is better, the
    result is the best usual technique. Frequencies are rounded to periods of whole frames.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> found = midair.haptic([[-0.01, 0, 0.1], [0, 0, 0.1], [0.01, 0, 0.1]], array, rate=2e3)
    >>> found.gain > 1, "foci" in found.technique
    (True, True)
    """
    if not isinstance(array, Array):
        raise TypeError(f"expected a midair.Array second, not {type(array).__qualname__}")
    frames = number("rate", rate, above=0)
    most = math.pi if change is None else bound(frames, change, None)
    if word("aim", aim) not in ("strong", "even"):
        raise refused("aim", aim, 'give "strong" or "even"')
    reach = number("beside", beside, least=0)
    curve = _Curve.of(shape, closed)
    judge = _Judge(array, curve, frames, reach, dict(model))
    standards = [(t.name, *judge.felt(t, most)) for t in _usual(curve, frames)]
    if most < math.pi:
        drawn = (_drawn(curve, frames, speed, 1) for speed in SPEEDS)
        tried = [(t.name, *judge.felt(t, most)) for t in drawn]
    else:
        tried = list(judge.climbed(aim))

    def score(touch: Skin) -> float:
        along = judge.along(touch)
        return float(along.mean() if aim == "strong" else along.min())

    name, played, touch = max([*tried, *standards], key=lambda one: score(one[2]))
    loudness = None
    if ears is not None:
        played, loudness = _spared(played, ears, limit)
        touch = judge.skin(played)
    along = judge.along(touch)
    return Haptic(
        played,
        touch,
        name,
        aim,
        _decibels(along.mean()),
        _decibels(along.min()),
        {usual: _decibels(score(one)) for usual, _, one in standards},
        loudness,
    )


def _spared(played: Sequence, ears: Mapping[str, Any], limit: str | float) -> tuple[Sequence, Exposure]:
    """Return the sequence at a level within the limit at the ears, and the exposure there."""
    found = exposure(played, ears, limit=limit)
    above = found.worst.spl - found.limit.spl
    if above <= 0:
        return played, found
    steps = (played.quantization or {}).get("amplitudes")
    if steps is not None and np.count_nonzero(steps) == 1:
        raise SceneError(f"ears get {above:.1f} dB too much, and the board has one amplitude: move away")
    factor = np.float32(10 ** (-above / 20) * (1 - 1e-6))
    softer = Sequence(
        played.array,
        played.points,
        played.targets * factor,
        played.drives * factor,
        obstacles=played._scene.obstacles,
        **played.setting(),
    )
    return softer, exposure(softer, ears, limit=limit)


@dataclass(frozen=True)
class _Curve:
    """Places (P, 3) in m at equal distances along a shape, its length in m, and whether it is closed."""

    places: NDArray[np.float64]
    length: float
    closed: bool

    @classmethod
    def of(cls, shape: Path | ArrayLike, closed: bool) -> _Curve:
        loops = flag("closed", closed)
        if isinstance(shape, Path):
            if shape.points != 1:
                raise refused("shape", shape, "give a path of one point, or places (K, 3)")
            corners = shape.at(np.linspace(0, shape.duration, 2000, endpoint=False))[:, 0]
            loops = shape.closed
        else:
            corners = real("shape", shape, "give a midair.path, or places (K, 3) in m")
            if corners.ndim != 2 or corners.shape[1] != 3 or len(corners) < 2:
                raise refused("shape", shape, "give at least two places (K, 3) in m")
        if loops:
            corners = np.concatenate([corners, corners[:1]])
        ways = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        length = float(ways[-1])
        if not 0 < length < math.inf:
            raise refused("shape", f"{length:g} m long", "give places that are apart")
        count = min(max(round(length / STEP), 2), MOST)
        at = np.linspace(0, length, count, endpoint=not loops)
        places = np.stack([np.interp(at, ways, column) for column in corners.T], axis=1)
        return cls(places, length, loops)

    def index(self, ways: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the index of the place at a fraction of the length. An open curve is run back and forth."""
        count = len(self.places)
        if self.closed:
            return np.rint(ways * count).astype(np.int64) % count
        back = np.abs((ways + 1) % 2 - 1)
        found: NDArray[np.int64] = np.rint(back * (count - 1)).astype(np.int64)
        return found


def _times(rate: float, frequency: float) -> NDArray[np.float64]:
    """Return the times of a period's frames, as fractions of the period, which is rounded to whole frames."""
    count = max(round(rate / frequency), 2)
    return np.arange(count) / count


def _drawn(curve: _Curve, rate: float, speed: float, points: int) -> Technique:
    """Return the technique of foci that move along a curve at `speed` m/s, back and forth if it is open."""
    laps = 1 if curve.closed else 2
    t = _times(rate, speed / (laps * curve.length))
    ways = laps * t[:, None] + laps * np.arange(points) / points
    name = f"STM at {laps * curve.length * rate / len(t):.3g} m/s"
    return Technique(name if points == 1 else f"{name}, {points} foci", ways, np.ones(len(t)))


def _usual(curve: _Curve, rate: float) -> Iterator[Technique]:
    """Yield the four usual techniques: amplitude and lateral modulation, one and two foci that move along."""
    spread = max(round(curve.length / 0.01), 2)
    rest = (np.arange(spread) + 0.5 * (not curve.closed)) / spread
    t = _times(rate, 200.0)
    amplitudes = np.sqrt((1 + np.cos(2 * np.pi * t)) / 2)
    still = np.tile(rest, (len(t), 1))
    yield Technique(f"AM at {rate / len(t):.4g} Hz, {spread} foci", still, amplitudes)
    t = _times(rate, 100.0)
    ways = rest + 0.25 / spread * np.sin(2 * np.pi * t)[:, None]
    yield Technique(f"LM at {rate / len(t):.4g} Hz, {spread} foci", ways, np.ones(len(t)))
    yield from (_drawn(curve, rate, USUAL, points) for points in (1, 2))


class _Judge:
    """Computes the strength of techniques along a curve, by a model of the skin."""

    def __init__(self, array: Array, curve: _Curve, rate: float, reach: float, model: dict[str, Any]) -> None:
        self._array, self._curve, self._rate, self._model = array, curve, rate, model
        middle = (curve.places.min(axis=0) + curve.places.max(axis=0)) / 2
        normal = int(np.abs(middle - array.positions.mean(axis=0)).argmax())
        across = [axis for axis in range(3) if axis != normal]
        size = float(np.ptp(curve.places, axis=0)[across].max()) + 2 * MARGIN
        center = (float(middle[across[0]]), float(middle[across[1]]))
        at = float(middle[normal])
        self._plane = Plane(axis="xyz"[normal], at=at, size=size, pixels=COARSE, center=center)
        sheet = Sheet(**{name: model[name] for name in ("speed", "loss", "mass") if name in model})
        frames = max(round(rate / LAPS), 4)
        self.foci = Foci.beside(array, curve.places, self._plane, reach, sheet, rate, frames)

    def skin(self, played: Sequence) -> Skin:
        return skin(played, self._plane, **self._model)

    def along(self, touch: Skin) -> NDArray[np.float64]:
        return touch.along(self._curve.places)

    def starts(self) -> Iterator[NDArray[np.int64]]:
        """Yield initial schedules: the focus jumps within a piece of the curve, and the piece moves on."""
        t, curve = np.arange(self.foci.frames), self._curve
        for jumps, frequency, piece in JUMPS:
            part = min(piece / curve.length, 0.5)
            lap = t / len(t) if curve.closed else (1 - part) * np.abs(1 - 2 * t / len(t))
            period = t * (min(frequency, self._rate / 2) / self._rate) % 1
            yield curve.index(lap + part * np.floor(period * jumps) / jumps)

    def climbed(self, aim: str) -> Iterator[tuple[str, Sequence, Skin]]:
        """Yield (name, sequence, skin) after the ascent from each initial schedule."""
        for start in self.starts():
            chosen = self.foci.climb(start, aim)
            on = (chosen >= 0)[:, None]
            played = Sequence(
                self._array,
                self.foci.places[chosen][:, None],
                self.foci.levels[chosen][:, None] * on,
                self.foci.drives[chosen] * on,
                rate=self._rate,
                closed=True,
                solver="haptic",
            )
            count = len(np.unique(chosen[chosen >= 0]))
            yield (
                f"schedule of {count} foci, {self._rate / len(chosen):.3g} laps/s",
                played,
                self.skin(played),
            )

    def felt(self, technique: Technique, change: float) -> tuple[Sequence, Skin]:
        """Return the technique's frames, solved within the bound, and the motion of the skin."""
        index = self._curve.index(technique.ways)
        points = self._curve.places[index]
        if change < math.pi:
            with warnings.catch_warnings():
                # No warning: a movement too fast for the bound gives a weak result, which is not chosen.
                warnings.simplefilter("ignore", SceneWarning)
                drives = sequence(self._array, points, rate=self._rate, change=change).drives
        elif index.shape[1] == 1:
            drives = self.foci.drives[index[:, 0]]
        else:
            sets, which = np.unique(index, axis=0, return_inverse=True)
            drives = solve_batch(self._array, self._curve.places[sets], solver="fast").drives[which.ravel()]
        amplitudes = technique.amplitudes[:, None]
        played = Sequence(
            self._array,
            points,
            self.foci.levels[index] * amplitudes / math.sqrt(index.shape[1]),
            drives * amplitudes.astype(np.float32),
            rate=self._rate,
            closed=True,
            solver="haptic",
        )
        return played, self.skin(played)


def _decibels(strength: float) -> float:
    return float(20 * np.log10(max(strength, 1e-10)))
