"""`midair.haptic`: a shape drawn so that it is felt as strongly or as evenly as a board allows."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Plane, SceneError, SceneWarning, solve_batch
from .._motion import Sequence, Skin, sequence, skin
from .._motion.request import bound
from .._support.arguments import flag, number, real, refused, word
from ..path import Path
from .exposure import Exposure, exposure

#: Places of a focus along the shape: so far apart in m, and at most so many.
STEP, MOST = 2e-3, 200

#: Places of the skin along each side, and what it shows around the shape, in m.
COARSE, MARGIN = 33, 0.015

#: Techniques that are solved as frames, of those that foci by themselves promise most.
TRIED = 3

#: Laps a second of the pieces that strokes draw: the fast channel sums over some 0.2 s (Verrillo 1965).
LAPS = 5.0


@dataclass(frozen=True)
class Technique:
    """Where foci are along a shape, frame after frame.

    name : as it is reported
    standard : whether it is one of the four usual ones
    ways : (T, M) along the shape, 0 to 1
    amplitudes : (T,) of the drive
    """

    name: str
    standard: bool
    ways: NDArray[np.float64]
    amplitudes: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Haptic:
    """A shape to be felt, and what is predicted of it; a model (docs/touch.md).

    sequence : the drives, frame after frame
    skin : the skin's motion under it
    technique : what was chosen
    strength : in dB above what is just felt, the mean along the shape
    weakest : the same at the shape's weakest place
    standards : strength of the four usual techniques by name, at the same array, rate and bound
    exposure : at the ears, if any were given
    """

    sequence: Sequence
    skin: Skin
    technique: str
    strength: float
    weakest: float
    standards: dict[str, float]
    exposure: Exposure | None

    @property
    def gain(self) -> float:
        """By how many dB it is above the strongest of the usual techniques."""
        return self.strength - max(self.standards.values())

    def __repr__(self) -> str:
        return "\n".join(f"{name:18}  {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        rows = (f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in self._rows())
        return f"<table>{''.join(rows)}</table>"

    def _rows(self) -> list[tuple[str, str]]:
        rows = [
            ("technique", self.technique),
            (
                "strength",
                f"{self.strength:.1f} dB above threshold, {self.weakest:.1f} dB where it is weakest",
            ),
            *((name, f"{value:.1f} dB") for name, value in self.standards.items()),
            ("gain", f"{self.gain:+.1f} dB"),
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
    ears: Mapping[str, Any] | None = None,
    limit: str | float = "howard",
    **model: Any,
) -> Haptic:
    """Draw speed, foci, modulation and level with which a shape is felt best, by the model of `midair.skin`.

    shape : a midair.path of one point, or places (K, 3) in m in the order in which they are drawn
    rate : frames a second that the board plays
    aim : "strong", the largest mean strength along the shape, or "even", the largest at its weakest place
    change : the bound in rad a frame; left out, none
    closed : whether places go on from the last to the first; a path knows it
    ears, limit : places that must not be louder than a limit, as `midair.exposure` takes them: the level is
        lowered, of a board with amplitudes
    model : speed, loss, mass and reach of the skin

    The four usual techniques are amplitude modulation, lateral modulation, one focus at 7 m/s, and two of
    them. Beside them, other draw speeds are tried, and what dwells: a focus that draws a piece of the shape
    again and again at a frequency, while the piece goes along it 5 times a second. Where none is better, the
    answer is the best of the usual four. Frequencies are those that whole frames allow.

    Raises SceneError for what is not in order, and where the ears cannot be spared.

    >>> import midair
    >>> array = midair.Array.preset("autd3")
    >>> found = midair.haptic(midair.path.circle([0, 0, 0.15], 0.015, speed=1), array, rate=4e3)
    >>> found.gain > 0, "mm" in found.technique
    (True, True)
    """
    if not isinstance(array, Array):
        raise TypeError(f"expected a midair.Array second, not {type(array).__qualname__}")
    frames = number("rate", rate, above=0)
    most = math.pi if change is None else bound(frames, change, None)
    if word("aim", aim) not in ("strong", "even"):
        raise refused("aim", aim, 'give "strong" or "even"')
    curve = _Curve.of(shape, closed)
    judge = _Judge(array, curve, frames, aim, dict(model))
    techniques = list(_techniques(curve, frames))
    order = sorted((t for t in techniques if not t.standard), key=judge.promise, reverse=True)
    tried = [(t, *judge.felt(t, most)) for t in order[:TRIED]]
    standards = [(t, *judge.felt(t, most)) for t in techniques if t.standard]
    best, played, touch = max([*tried, *standards], key=lambda one: judge.score(judge.along(one[2])))
    loudness = None
    if ears is not None:
        played, loudness = _spared(played, ears, limit)
        touch = judge.skin(played)
    along = judge.along(touch)
    return Haptic(
        played,
        touch,
        best.name,
        _decibels(along.mean()),
        _decibels(along.min()),
        {t.name: _decibels(judge.along(one).mean()) for t, _, one in standards},
        loudness,
    )


def _spared(played: Sequence, ears: Mapping[str, Any], limit: str | float) -> tuple[Sequence, Exposure]:
    """The sequence at a level that spares the ears, and what reaches them."""
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
    """Places (P, 3) in m, evenly along a shape of so many m, closed or not."""

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
        """The place nearest to parts of the way: round a closed curve, to and fro on another."""
        count = len(self.places)
        if self.closed:
            return np.rint(ways * count).astype(np.int64) % count
        back = np.abs((ways + 1) % 2 - 1)
        found: NDArray[np.int64] = np.rint(back * (count - 1)).astype(np.int64)
        return found


def _techniques(curve: _Curve, rate: float) -> Iterator[Technique]:
    """The four usual ones, and what is tried beside them."""
    length, laps = curve.length, 1 if curve.closed else 2

    def times(frequency: float) -> NDArray[np.float64]:
        """Parts of a period, in frames."""
        return np.arange(max(round(rate / frequency), 2)) / max(round(rate / frequency), 2)

    def drawn(speed: float, points: int) -> NDArray[np.float64]:
        t = times(speed / (laps * length))
        return laps * t[:, None] + laps * np.arange(points) / points

    def steady(ways: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.ones(len(ways))

    spread = max(round(length / 0.01), 2)
    rest = (np.arange(spread) + 0.5 * (not curve.closed)) / spread
    t = times(200.0)
    amplitudes = np.sqrt((1 + np.cos(2 * np.pi * t)) / 2)
    still = np.tile(rest, (len(t), 1))
    yield Technique(f"AM at {rate / len(t):.4g} Hz, {spread} foci", True, still, amplitudes)
    t = times(100.0)
    ways = rest + 0.25 / spread * np.sin(2 * np.pi * t)[:, None]
    yield Technique(f"LM at {rate / len(t):.4g} Hz, {spread} foci", True, ways, steady(t))
    for points, speed in ((1, 7.0), (2, 7.0), (1, 5.0), (1, 6.0), (1, 8.0), (1, 10.0)):
        ways = drawn(speed, points)
        told = f"STM at {laps * length * rate / len(ways):.3g} m/s"
        name = told if points == 1 else f"{told}, {points} foci"
        yield Technique(name, speed == 7.0, ways, steady(ways))
    count, there = max(round(rate / LAPS), 4), set()
    for frequency in (160.0, 200.0, 220.0, 250.0):
        # Whole passes in a lap: else they would drift.
        one = max(round(rate / frequency), 2)
        passes = max(count // one, 1)
        frames = np.arange(passes * one)
        along = (frames // one) / passes
        for piece in (0.018, 0.024, 0.032, 0.04, 0.056, 0.08):
            if piece > length / 2 or (one, piece) in there:
                continue
            there.add((one, piece))
            sweep = along if curve.closed else (1 - piece / length) * np.abs(1 - 2 * along)
            ways = sweep + (frames % one) / one * piece / length
            name = f"strokes of {1e3 * piece:g} mm at {rate / one:.4g} Hz, {rate / len(frames):.3g} laps/s"
            yield Technique(name, False, ways[:, None], steady(ways))


class _Judge:
    """What techniques are felt like along a curve."""

    def __init__(self, array: Array, curve: _Curve, rate: float, aim: str, model: dict[str, Any]) -> None:
        self._array, self._curve, self._rate, self._model = array, curve, rate, model
        self.score: Callable[[NDArray[np.float64]], float] = (
            (lambda along: float(along.mean())) if aim == "strong" else (lambda along: float(along.min()))
        )
        single = solve_batch(array, curve.places[:, None], solver="fast")
        self._drives = single.drives
        self._levels = np.abs(single.pressures[:, 0])
        middle = (curve.places.min(axis=0) + curve.places.max(axis=0)) / 2
        normal = int(np.abs(middle - array.positions.mean(axis=0)).argmax())
        across = [axis for axis in range(3) if axis != normal]
        size = float(np.ptp(curve.places, axis=0)[across].max()) + 2 * MARGIN
        center = (float(middle[across[0]]), float(middle[across[1]]))
        at = float(middle[normal])
        self._plane = Plane(axis="xyz"[normal], at=at, size=size, pixels=COARSE, center=center)

    def skin(self, played: Sequence) -> Skin:
        return skin(played, self._plane, **self._model)

    def along(self, touch: Skin) -> NDArray[np.float64]:
        return touch.along(self._curve.places)

    def promise(self, technique: Technique) -> float:
        """The score of the first focus alone, no phase bound."""
        index = self._curve.index(technique.ways[:, :1])
        return self.score(self.along(self.skin(self._played(technique, index, self._drives[index[:, 0]]))))

    def felt(self, technique: Technique, change: float) -> tuple[Sequence, Skin]:
        """The technique's frames, solved within the bound, and the skin's motion under them."""
        index = self._curve.index(technique.ways)
        points = self._curve.places[index]
        if change < math.pi:
            with warnings.catch_warnings():
                # What is too fast for the bound is felt less, and not chosen.
                warnings.simplefilter("ignore", SceneWarning)
                drives = sequence(self._array, points, rate=self._rate, change=change).drives
        elif index.shape[1] == 1:
            drives = self._drives[index[:, 0]]
        else:
            sets, which = np.unique(index, axis=0, return_inverse=True)
            drives = solve_batch(self._array, self._curve.places[sets], solver="fast").drives[which.ravel()]
        played = self._played(technique, index, drives)
        return played, self.skin(played)

    def _played(
        self, technique: Technique, index: NDArray[np.int64], drives: NDArray[np.complex64]
    ) -> Sequence:
        amplitudes = technique.amplitudes[:, None]
        return Sequence(
            self._array,
            self._curve.places[index],
            self._levels[index] * amplitudes / math.sqrt(index.shape[1]),
            drives * amplitudes.astype(np.float32),
            rate=self._rate,
            closed=True,
            solver="haptic",
        )


def _decibels(strength: float) -> float:
    return float(20 * np.log10(max(strength, 1e-10)))
