"""`midair.haptic`: draws a shape so that it feels as strong or as even as a board allows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._judging.exposure import Exposure, exposure, limit_of
from .._midair import Array, Scene, SceneError, bound_of, decibels, hand, restated, solve_batch, unknown_name
from .._pictures.colours import Axes, Figure, Size
from .._sequence import Sequence, sequence
from .._sequence.drives import lowered, time_constant
from .._support.arguments import frame_rate, number, refused, warn, without_warnings, word
from .._support.text import Facts
from ..path import Path
from .schedule import SPEEDS, USUAL, Curve, Foci, Technique, moving, pressing, usual
from .skin import Skin, model_of, skin

#: The skin is a square grid of points: their number per side, and the margin in m between shape and edge.
COARSE, MARGIN = 33, 0.015

#: Laps per second of a schedule: the fast tactile channel integrates over a lap, 0.2 s (Verrillo 1965).
LAPS = 5.0

#: Initial schedules of the ascent: jumps per period, their frequency in Hz, the length in m they cover.
JUMPS = ((5, 285.0, 0.03), (2, 285.0, 0.018))

#: Least and largest rate in frames per second: two places per lap, and above every board's.
RATES = 2 * LAPS, 50e3

#: Largest plausible `beside` in m.
WIDEST = 0.1

#: Bounds in rad per frame that are tried where the result must be quiet; pi/16 is the default of sequences.
QUIET = (math.pi / 4, math.pi / 16)

#: Names of the arguments of the model.
MODEL = ("speed", "loss", "mass", "reach", "tau")

#: The audible sound of frames is lowered with them if all amplitudes are lowered alike, up to this part.
SAME = 1e-6

Panel: TypeAlias = Literal["skin", "techniques"]
Panels: TypeAlias = Panel | Iterable[Panel] | None

#: Largest number of times that a level is lowered. Frames with one amplitude need one.
LOWERINGS = 20


@dataclass(frozen=True, eq=False, repr=False)
class Haptic(Facts):
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
        "strong", "even" or "pressure".
    strength, weakest : float
        Strength in dB above the threshold: the mean along the shape, and at its weakest place.
    standards : dict of str to float
        The four usual techniques and those of the caller, by name, with the same array, rate, bound and limit
        at the ears: their `strength`, or their `weakest` if the aim is "even", or their `pressure` if it is
        "pressure"; -inf where the board cannot meet the limit.
    exposure : midair.Exposure or None
        Levels at the ears, if any were given; audible ones with `quiet`.
    pressure : float
        Mean of `skin.pressed` along the shape in dB re 1 Pa.

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
    pressure: float

    @property
    def gain(self) -> float:
        """Gain in dB over the best of `standards`, of the quantity that the aim maximises."""
        return self._reached - max(self.standards.values())

    @property
    def _reached(self) -> float:
        return {"strong": self.strength, "even": self.weakest, "pressure": self.pressure}[self.aim]

    def plot(self, ax: Axes | None = None, *, panels: Panels = None, size: Size | None = None) -> Figure:
        """Draw the motion of the skin, and the technique beside `standards`.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        panels : {"skin", "techniques"} or list of them, optional
            The panels to draw, side by side; by default both.
        size : float or (float, float), optional
            Size of the figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        SceneError
            For an unknown panel or size.
        """
        from .._pictures.figures import dots, row

        figure, axes = row(panels, get_args(Panel), ax, size, width=4.4, height=3.4)
        for name, one in axes.items():
            if name == "skin":
                self.skin.plot(ax=one, panels="pressure" if self.aim == "pressure" else "motion")
                continue
            strength = f"{'least' if self.aim == 'even' else 'mean'} strength / dB above threshold"
            label = "pressure / dB re 1 Pa" if self.aim == "pressure" else strength
            dots(one, {self.technique: self._reached, **self.standards}, label, (self.technique,))
        return figure

    def _rows(self) -> list[tuple[str, str]]:
        level = f"{self.strength:.1f} dB above threshold, {self.weakest:.1f} dB where it is weakest"
        where = {"strong": "in the mean", "even": "at the weakest place", "pressure": "of pressure"}[self.aim]
        rows = [
            ("technique", self.technique),
            ("strength", level),
            ("pressure", f"{self.pressure:.1f} dB re 1 Pa"),
            *((name, f"{value:.1f} dB") for name, value in self.standards.items()),
            ("gain", f"{self.gain:+.1f} dB {where}"),
        ]
        if self.exposure is not None:
            rows.append(("loudest ear", f"{self.exposure.worst.spl:.1f} dB SPL"))
            if self.exposure.loudest is not None:
                rows.append(("audible", f"{self.exposure.loudest:.1f} dB(A) at most"))
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
    techniques: Mapping[str, Path] | None = None,
    ears: Mapping[str, Any] | None = None,
    limit: str | float = "howard",
    quiet: float | None = None,
    **model: Any,
) -> Haptic:
    """Find the foci, frame by frame, with which a shape is felt best, by the model of `midair.skin`.

    Parameters
    ----------
    shape : midair.path.Path or (K, 3) array_like
        A path of one point, or places in m in the order in which they are moving.
    array : midair.Array
        The transducers.
    rate : float
        Frames per second that the board plays, 10 to 50,000.
    aim : {"strong", "even", "pressure"}, optional
        "strong": the largest mean strength along the shape; "even": the largest at its weakest place;
        "pressure": the largest steady push, `midair.Skin.pressed`, by foci that move in small steps 5 to 15
        times a second (Morisaki et al., IEEE Trans. Haptics 15(2), 2022).
    change : float, optional
        Bound in rad per frame; by default none.
    closed : bool, optional
        Whether the last place is joined to the first; not needed for a path.
    beside : float, optional
        Largest distance in m of foci from the shape, by default half a wavelength on the skin; 0: none.
    techniques : mapping of str to midair.path.Path, optional
        Techniques of your own along the shape, by name. They are compared with the usual ones, and nothing is
        searched. Paths without pressures have full drive, as the usual ones.
    ears : mapping, optional
        Places, as `midair.exposure` takes them, that must not be louder than a limit. The level of each
        technique that is louder is lowered to amplitudes of the board, before the techniques are compared.
    limit : str or float, optional
        The limit at the ears, as `midair.exposure` takes it.
    quiet : float, optional
        Largest audible level at the ears in dB(A), by `midair.exposure`. Louder techniques are lowered, and
        foci that move with bounds of phase change are tried, too. It takes seconds for each technique.
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
    frames = frame_rate(rate)
    if not RATES[0] <= frames <= RATES[1]:
        raise refused("rate", rate, f"give {RATES[0]:g} to {RATES[1]:g} frames per second")
    most = math.pi if change is None else bound_of(frames, change, None)
    if word("aim", aim) not in ("strong", "even", "pressure"):
        raise refused("aim", aim, 'give "strong", "even" or "pressure"')
    if quiet is not None and (number("quiet", quiet), ears)[1] is None:
        raise refused("ears", ears, "give the ears at which it shall be quiet")
    reach = number("beside", beside, least=0)
    if reach > WIDEST:
        warn(f"beside is {reach:g} m, wider than a hand: give {reach * 1e-3:g} if mm are meant")
    for name in model.keys() - set(MODEL):
        known = ["rate", "aim", "change", "closed", "beside", "techniques", "ears", "limit", "quiet", *MODEL]
        raise TypeError(str(unknown_name("argument of midair.haptic", name, known)))
    if not isinstance(techniques, Mapping | None):
        raise refused("techniques", techniques, 'give {"name": path}')
    for name, path in (techniques or {}).items():
        if not isinstance(path, Path):
            raise refused(f"techniques.{name}", path, "give a path of midair.path")
    membrane, _, tau = model_of(**model)
    time_constant(tau)
    curve = Curve.of(shape, closed)
    _check(curve.check(array), ears, limit)
    with without_warnings():
        # The arguments have caused their warnings. A movement too fast for the bound gives a weak result,
        # which is not chosen.
        judge = _Judge(array, curve, frames, reach, membrane, dict(model))
        return _best(judge, aim, most, techniques, ears, limit, quiet)


def _best(
    judge: _Judge,
    aim: str,
    most: float,
    techniques: Mapping[str, Path] | None,
    ears: Mapping[str, Any] | None,
    limit: str | float,
    quiet: float | None,
) -> Haptic:
    """Return the best technique within a bound in rad per frame, and within the limits at the ears."""
    standards = [judge.tried(technique, most) for technique in usual(judge.curve, judge.rate)]
    if techniques is not None:
        standards = [judge.drawn(*own, most) for own in techniques.items()] + standards
        tried = []
    elif aim == "pressure":
        tried = [judge.drawn(*one, most) for one in pressing(judge.curve, judge.rate)]
    elif most < math.pi:
        tried = [judge.tried(moving(judge.curve, judge.rate, speed, 1), most) for speed in SPEEDS]
    else:
        tried = list(judge.climbed(aim))
    if quiet is not None and techniques is None:
        usually_moved = moving(judge.curve, judge.rate, USUAL, 1)
        tried += [judge.tried(usually_moved, bound) for bound in QUIET if bound < most]

    def score(motion: Skin | None) -> float:
        if motion is None:
            return -math.inf
        if aim == "pressure":
            return judge.pressed(motion)
        along = motion.along(judge.under)
        return float(along.mean() if aim == "strong" else along.min())

    compared = [*tried, *standards]
    if ears is not None:
        compared = [judge.spared(one, ears, limit, quiet) for one in compared]
    best = max(compared, key=lambda one: score(one.skin))
    if best.skin is None:
        raise _too_loud(best, ears, limit)
    along = best.skin.along(judge.under)
    levels = decibels(along.mean()), decibels(along.min())
    usually = {one.name: decibels(max(score(one.skin), 0)) for one in compared[len(tried) :]}
    pressure = decibels(judge.pressed(best.skin))
    return Haptic(best.played, best.skin, best.name, aim, *levels, usually, best.exposure, pressure)


class _Judged(NamedTuple):
    """A technique, its frames and the skin's motion (None if the board cannot meet the limit at the ears)."""

    name: str
    played: Sequence
    skin: Skin | None
    exposure: Exposure | None = None


def _check(scene: Scene, ears: Mapping[str, Any] | None, limit: str | float) -> None:
    """Reject ears and limits that `exposure` does not take, and give its warnings, before any work."""
    if ears is None:
        if not isinstance(limit, str) or limit != "howard":
            limit_of(scene, limit)
        return
    try:
        exposure(scene, np.zeros(len(scene.array), np.complex64), ears, limit=limit)
    except SceneError as error:
        raise restated(error, item=error.item.replace("places", "ears", 1)) from None


def _too_loud(judged: _Judged, ears: Mapping[str, Any] | None, limit: str | float) -> SceneError:
    """Return the error for a limit that no amplitude of the board meets."""
    levels, drives = judged.exposure, np.abs(judged.played.drives)
    assert levels is not None
    steps = np.asarray((judged.played.quantization or {})["amplitudes"])
    least = levels.worst.spl + decibels(steps[steps > 0].min() / drives.max())
    cure = f'the least amplitude of the board gives {least:.1f} dB at "{levels.worst.name}", move away'
    return refused("limit", limit, cure)


class _Judge:
    """Computes the strength of techniques along a curve, by a model of the skin."""

    def __init__(
        self, array: Array, curve: Curve, rate: float, reach: float, membrane: _midair.Membrane, model: dict[str, Any]
    ) -> None:
        self._array, self.curve, self.rate, self._model = array, curve, rate, model
        self._plane = hand(curve.places, array, MARGIN, COARSE)
        #: The places of the curve, moved along the normal into the plane of the skin.
        self.under = np.array(curve.places)
        self.under[:, "xyz".index(self._plane.axis)] = self._plane.at
        frames = max(round(rate / LAPS), 4)
        self.foci = Foci.beside(array, curve.places, self._plane, reach, membrane, rate, frames)

    def skin(self, played: Sequence) -> Skin:
        return skin(played, self._plane, **self._model)

    def pressed(self, motion: Skin) -> float:
        """Return the mean pressure along the shape in Pa that the channel of pressure passes."""
        return float(motion.pressed[[motion._nearest(place) for place in self.under]].mean())

    def spared(self, judged: _Judged, ears: Mapping[str, Any], limit: str | float, quiet: float | None) -> _Judged:
        """Return a technique at a level within the limits at the ears, as far as the board can play it."""
        played, audible = judged.played, quiet is not None
        softer, levels, factor = played, exposure(played, ears, limit=limit, audible=audible), 1.0
        loud, steps = levels, (played.quantization or {}).get("amplitudes")
        for _ in range(LOWERINGS):
            above = levels.worst.spl - levels.limit.spl
            if quiet is not None and levels.loudest is not None:
                # The audible pressure goes with the square of the drives.
                above = max(above, (levels.loudest - quiet) / 2)
            if above <= 0:
                motion = judged.skin if softer is played else self.skin(softer)
                return judged._replace(played=softer, skin=motion, exposure=levels)
            factor *= 10 ** (-above / 20) * (1 - 1e-6)
            amplitudes = np.abs(played.drives) * factor
            parts = amplitudes if steps is None else lowered(amplitudes, steps)
            if not parts.any():
                break
            drives = played.drives * (parts / np.maximum(np.abs(played.drives), 1e-30)).astype(np.float32)
            points, targets, setting = played.points, played.targets * factor, played.setting()
            obstacles = played._scene.obstacles
            softer = Sequence(played.array, points, targets, drives, obstacles=obstacles, **setting)
            shares = parts[amplitudes > 0] / amplitudes[amplitudes > 0]
            alike = loud.sound is not None and np.ptp(shares) < SAME * shares.max()
            levels = exposure(softer, ears, limit=limit, audible=audible and not alike)
            if alike:
                levels = levels._with(loud.frequencies, loud.sound * (factor * shares.mean()) ** 2)
        return judged._replace(skin=None, exposure=loud)

    def _judged(
        self, name: str, points: NDArray[np.float64], levels: NDArray[np.float64], drives: NDArray[Any]
    ) -> _Judged:
        """Return a technique of these frames, with the motion of the skin."""
        own: dict[str, Any] = {"rate": self.rate, "closed": True, "solver": "haptic"}
        played = Sequence(self._array, points, levels, drives, **own)
        return _Judged(name, played, self.skin(played))

    def starts(self) -> Iterator[NDArray[np.int64]]:
        """Yield initial schedules: the focus jumps within a piece of the curve, and the piece moves on."""
        t, curve = np.arange(self.foci.frames), self.curve
        for jumps, frequency, piece in JUMPS:
            part = min(piece / curve.length, 0.5)
            lap = t / len(t) if curve.closed else (1 - part) * np.abs(1 - 2 * t / len(t))
            period = t * (min(frequency, self.rate / 2) / self.rate) % 1
            yield curve.indices(lap + part * np.floor(period * jumps) / jumps)

    def climbed(self, aim: str) -> Iterator[_Judged]:
        """Yield the technique after the ascent from each initial schedule."""
        for start in self.starts():
            foci, chosen = self.foci, self.foci.climb(start, aim)
            on = (chosen >= 0)[:, None]
            count = len(np.unique(chosen[chosen >= 0]))
            name = f"schedule of {count} foci, {self.rate / len(chosen):.3g} laps/s"
            levels = foci.levels[chosen][:, None] * on
            yield self._judged(name, foci.places[chosen][:, None], levels, foci.drives[chosen] * on)

    def drawn(self, name: str, path: Path, change: float) -> _Judged:
        """Return a technique of the caller, solved within the bound."""
        played = sequence(self._array, path, rate=self.rate, change=change)
        return _Judged(name, played, self.skin(played))

    def tried(self, technique: Technique, change: float) -> _Judged:
        """Return the technique with its frames, solved within the bound."""
        index = self.curve.indices(technique.ways)
        points = self.curve.places[index]
        if change < math.pi:
            drives = sequence(self._array, points, rate=self.rate, change=change).drives
        elif index.shape[1] == 1:
            drives = self.foci.drives[index[:, 0]]
        else:
            sets, which = np.unique(index, axis=0, return_inverse=True)
            drives = solve_batch(self._array, self.curve.places[sets], solver="fast").drives[which.ravel()]
        amplitudes = self._on_board(technique.amplitudes)[:, None]
        levels = self.foci.levels[index] * amplitudes / math.sqrt(index.shape[1])
        return self._judged(technique.name, points, levels, drives * amplitudes.astype(np.float32))

    def _on_board(self, amplitudes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the board's amplitudes, or 0, that are nearest to the given ones."""
        steps = (self._array.quantization or {}).get("amplitudes")
        if steps is None:
            return amplitudes
        table = np.r_[0.0, steps]
        nearest: NDArray[np.float64] = table[np.abs(table - amplitudes[:, None]).argmin(axis=1)]
        return nearest
