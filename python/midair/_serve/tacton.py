"""Tactons: tactile patterns in the format of Adaptics Designer; computes which point they play at a time.

A pattern is JSON whose "$DATA_FORMAT" is "MidAirHapticsAnimationFileFormat", with lengths in mm and times in
ms. docs/serve.md describes how it is played.
"""

import math
import operator
import random
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from .._midair import stated
from .._support.arguments import json_object, number, refused, word

#: Revisions of the format that this module reads. The parts that it uses are equal in all of them.
REVISIONS = ("0.1.0-alpha.3", "0.1.0-alpha.2", "0.0.10-alpha.1")

#: Largest depth of a formula, and most keyframes of a pattern.
MOST_DEEP, MOST_KEYFRAMES = 32, 4096

#: Parameters of each brush (the figure that the focus draws around its place), and of these the ones that
#: change linearly until the next keyframe with the same brush.
BRUSHES = {
    "circle": ("radius", "am_freq"),
    "line": ("length", "rotation", "am_freq", "thickness"),
    "lissajous": ("a", "b", "d", "x_scale", "y_scale", "rotation", "am_freq"),
}
GRADUAL = {"circle": BRUSHES["circle"], "line": BRUSHES["line"], "lissajous": ("rotation", "am_freq")}

#: Laps per second of a brush that gives no frequency.
STM = 100.0

OPERATORS = {"add": operator.add, "subtract": operator.sub}
OPERATORS |= {"multiply": operator.mul, "divide": operator.truediv}
CONDITIONS = {"lt": operator.lt, "lt_eq": operator.le, "gt": operator.gt, "gt_eq": operator.ge}

Lookup = Callable[[str], float]
Value = Callable[[Lookup], float]
Matrix = Sequence[Sequence[float]]


class Moment(NamedTuple):
    """Time within the pattern at the last evaluation, and how much it is ahead of the clock, both in ms."""

    pattern: float = 0.0
    ahead: float = 0.0


class Touch(NamedTuple):
    """The result of an evaluation: a point in mm, its intensity, and whether playback stops."""

    point: tuple[float, float, float]
    intensity: float
    stop: bool
    moment: Moment


class Stage(NamedTuple):
    """The value of a keyframe's property, and whether it changes linearly until the next keyframe."""

    value: Any
    linear: bool


class Keyframe(NamedTuple):
    """A time in ms and the properties that begin there; a property that is None does not change."""

    time: float
    kind: str
    coords: Stage | None = None
    brush: Stage | None = None
    intensity: Stage | None = None
    jumps: tuple[tuple[str, Callable[[float, float], bool], float, float], ...] = ()


class Track:
    """One property over time. A mark is a time, the stage that begins then, and the stage that ends then."""

    def __init__(self, marks: list[tuple[float, Stage | None, Stage | None]]) -> None:
        self._times = [time for time, _, _ in marks]
        self._begins = [begun for _, begun, _ in marks]
        self._ends = [ended for _, _, ended in marks]

    def at(self, time: float) -> tuple[Any, Any, float]:
        """Return the values before and after a time, and the fraction of the way between them."""
        k = bisect_right(self._times, time) - 1
        if k < 0 or (begun := self._begins[k]) is None:
            return None, None, 0.0
        following = self._ends[k + 1] if k + 1 < len(self._times) else None
        if following is None or not begun.linear:
            return begun.value, begun.value, 0.0
        share = (time - self._times[k]) / (self._times[k + 1] - self._times[k])
        return begun.value, following.value, share


class Tacton:
    """A parsed pattern.

    Parameters
    ----------
    text
        The pattern as JSON.

    Raises
    ------
    SceneError
        For anything invalid; the message names the place in the pattern.
    """

    def __init__(self, text: str) -> None:
        given = json_object("pattern", text, "give what Adaptics Designer saves")
        form = given.get("$DATA_FORMAT")
        if form != "MidAirHapticsAnimationFileFormat":
            raise refused("$DATA_FORMAT", form, 'give "MidAirHapticsAnimationFileFormat"')
        if given.get("$REVISION") not in REVISIONS:
            raise refused("$REVISION", given.get("$REVISION"), f"give {', '.join(REVISIONS)}")
        listed = _list(given, "keyframes", "")
        if len(listed) > MOST_KEYFRAMES:
            raise stated("keyframes", f"are {len(listed)}", f"give {MOST_KEYFRAMES} at most")
        read = [_keyframe(each, f"keyframes[{k}]") for k, each in enumerate(listed)]
        self._keyframes = sorted(read, key=lambda keyframe: keyframe.time)
        self._jumping = [keyframe for keyframe in self._keyframes if keyframe.jumps]
        self._times = [keyframe.time for keyframe in self._keyframes]
        # A pause or a stop ends a movement where it is. Only a stop ends changes of brush and intensity.
        self._coords = _track(self._keyframes, "coords", ("standard", "pause", "stop"), onward=False)
        self._brush = _track(self._keyframes, "brush", ("stop",), onward=True)
        self._intensity = _track(self._keyframes, "intensity", ("stop",), onward=True)
        self._transform(given)
        table = _table(given, "user_parameter_definitions", "")
        self._defined = {name: _definition(table, name) for name in table}

    def at(self, time: float, moment: Moment, parameters: Mapping[str, float], matrix: Matrix | None = None) -> Touch:
        """Return the touch at a time in ms after the start.

        moment : moment of the last touch, or of the start
        parameters : values by name; missing ones have the pattern's defaults
        matrix : 4 x 4, by rows; applied to points in mm after the pattern's own transform

        Raises SceneError if a formula gives no finite number.
        """
        try:
            found = self._at(time, moment, self._lookup(parameters), matrix)
        except (ArithmeticError, ValueError) as error:
            raise stated("pattern", f"gives no number at {moment.pattern:.6g} ms", str(error)) from error
        if not all(map(math.isfinite, (*found.point, found.intensity, *found.moment))):
            cure = "look at its formulas"
            raise stated("pattern", f"gives no finite point at {moment.pattern:.6g} ms", cure)
        return found

    def _at(self, time: float, moment: Moment, value: Lookup, matrix: Matrix | None) -> Touch:
        now = moment.pattern + (time + moment.ahead - moment.pattern) * self._speed(value)
        now = self._jumped(moment.pattern, now, value)
        x, y, z = self._moved(self._place(now), value, matrix)
        dx, dy, am = self._stroke(now, time, value)
        wave = (1 + math.cos(2e-3 * math.pi * am * time)) / 2
        intensity = self._strength(now, value) * self._factor(value) * wave
        before = bisect_right(self._times, now) - 1
        stop = before >= 0 and self._keyframes[before].kind == "stop"
        return Touch((x + dx, y + dy, z), intensity, stop, Moment(now, now - time))

    def _lookup(self, parameters: Mapping[str, float]) -> Lookup:
        def value(name: str) -> float:
            default, least, most = self._defined.get(name, (0.0, -math.inf, math.inf))
            return min(max(parameters.get(name, default), least), most)

        return value

    def _jumped(self, last: float, now: float, value: Lookup) -> float:
        """Return the target time of the first jump since `last` whose condition holds, else `now`."""
        for keyframe in self._jumping:
            if last < keyframe.time <= now:
                for name, holds, limit, to in keyframe.jumps:
                    if holds(value(name), limit):
                        return to
        return now

    def _place(self, now: float) -> tuple[float, ...]:
        before, after, share = self._coords.at(now)
        if before is None:
            return (0.0, 0.0, 0.0)
        return tuple(a + share * (b - a) for a, b in zip(before, after, strict=True))

    def _stroke(self, now: float, time: float, value: Lookup) -> tuple[float, float, float]:
        """Return the brush's offset from the place, in mm, and its amplitude modulation in Hz."""
        before, after, share = self._brush.at(now)
        if before is None:
            return 0.0, 0.0, 0.0
        name, given = before
        known = {key: one(value) for key, one in given.items()}
        if share and after[0] == name:
            for key in GRADUAL[name]:
                known[key] += share * (after[1][key](value) - known[key])
        phase = 2 * math.pi * math.fmod(1e-3 * known["stm_freq"] * time, 1.0)
        return *_drawn(name, phase, known), known["am_freq"]

    def _strength(self, now: float, value: Lookup) -> float:
        before, after, share = self._intensity.at(now)
        if before is None:
            return 0.0
        begun = _drawn_lots(before, value)
        return begun + share * (_drawn_lots(after, value) - begun) if share else begun

    def _transform(self, given: dict[str, Any]) -> None:
        where = "pattern_transform"
        table = _table(given, where, "")
        shapes = _table(table, "geometric_transforms", where)
        within = f"{where}.geometric_transforms"
        self._turn = _value(shapes, "rotation", within)
        self._scale, self._shift = (
            [_value(_table(shapes, name, within), axis, f"{within}.{name}") for axis in "xyz"]
            for name in ("scale", "translate")
        )
        self._factor = _value(table, "intensity_factor", where)
        self._speed = _value(table, "playback_speed", where)

    def _moved(self, point: tuple[float, ...], value: Lookup, matrix: Matrix | None) -> tuple[float, ...]:
        """Scale a point, turn it about z and shift it; then apply the matrix."""
        x, y, z = (a * scale(value) for a, scale in zip(point, self._scale, strict=True))
        turn = math.radians(self._turn(value))
        x, y = x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)
        x, y, z = (a + shift(value) for a, shift in zip((x, y, z), self._shift, strict=True))
        if matrix is None:
            return x, y, z
        *moved, weight = (row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix)
        return tuple(a / weight for a in moved)


def _drawn(name: str, phase: float, known: dict[str, float]) -> tuple[float, float]:
    """Return the point (x, y) of a brush at a phase in rad of its lap."""
    if name == "circle":
        return known["radius"] * math.cos(phase), known["radius"] * math.sin(phase)
    if name == "line":
        x, y, turn = known["length"] * math.cos(phase), 0.0, math.radians(known["rotation"])
    else:
        # The schema says degrees, but Adaptics itself uses this angle in rad.
        turn = known["rotation"]
        x = known["x_scale"] * math.sin(known["a"] * phase + known["d"])
        y = known["y_scale"] * math.sin(known["b"] * phase)
    return x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)


def _drawn_lots(limits: tuple[Value, Value], value: Lookup) -> float:
    low, high = limits[0](value), limits[1](value)
    return low if low == high else random.uniform(low, high)


def _track(keyframes: list[Keyframe], name: str, stops: tuple[str, ...], *, onward: bool) -> Track:
    """Return a property's track; with `onward`, a stop without a value ends at the next keyframe's value."""
    marked = [each for each in keyframes if getattr(each, name) is not None or each.kind in stops]
    begun: list[Stage | None] = []
    for each in marked:
        begun.append(getattr(each, name) or (begun[-1] if begun else None))
    ended: list[Stage | None] = []
    for each in reversed(marked):
        ended.append(getattr(each, name) or (ended[-1] if ended and onward else None))
    return Track(list(zip((each.time for each in marked), begun, reversed(ended), strict=True)))


def _joined(where: str, key: str) -> str:
    return f"{where}.{key}" if where else key


def _table(given: dict[str, Any], key: str, where: str) -> dict[str, Any]:
    if not isinstance(found := given.get(key), dict):
        raise refused(_joined(where, key), found, "give an object")
    return found


def _list(given: dict[str, Any], key: str, where: str) -> list[dict[str, Any]]:
    found = given.get(key)
    if not isinstance(found, list) or not all(isinstance(each, dict) for each in found):
        raise refused(_joined(where, key), found, "give a list of objects")
    return found


def _one_of(given: dict[str, Any], key: str, where: str, known: Mapping[str, Any] | Sequence[str]) -> str:
    found = given.get(key)
    if not isinstance(found, str) or found not in known:
        raise refused(_joined(where, key), found, f"give {', '.join(known)}")
    return found


def _keyframe(given: dict[str, Any], where: str) -> Keyframe:
    time = number(f"{where}.time", given.get("time"))
    kind = _one_of(given, "type", where, ("standard", "pause", "stop"))
    if kind == "stop":
        return Keyframe(time, kind)
    if kind == "standard":
        _table(given, "coords", where)
    place = _stage(given, "coords", where, _coords) if kind == "standard" else None
    jumps = tuple(_jump(each, f"{where}.cjumps") for each in _list(given, "cjumps", where))
    brush, strength = (
        _stage(given, name, where, read) for name, read in (("brush", _brush), ("intensity", _intensity))
    )
    return Keyframe(time, kind, place, brush, strength, jumps)


def _stage(given: dict[str, Any], key: str, where: str, read: Callable[[dict[str, Any], str], Any]) -> Stage | None:
    if given.get(key) is None:
        return None
    table, within = _table(given, key, where), f"{where}.{key}"
    name = _one_of(_table(table, "transition", within), "name", f"{within}.transition", ("linear", "step"))
    return Stage(read(_table(table, key, within), f"{within}.{key}"), name == "linear")


def _coords(given: dict[str, Any], where: str) -> tuple[float, ...]:
    return tuple(number(f"{where}.{axis}", given.get(axis)) for axis in "xyz")


def _brush(given: dict[str, Any], where: str) -> tuple[str, dict[str, Value]]:
    name = _one_of(given, "name", where, BRUSHES)
    table, within = _table(given, "params", where), f"{where}.params"
    values = {key: _value(table, key, within) for key in BRUSHES[name]}
    values["stm_freq"] = _value(table, "stm_freq", within) if "stm_freq" in table else lambda _: STM
    return name, values


def _intensity(given: dict[str, Any], where: str) -> tuple[Value, Value]:
    name = _one_of(given, "name", where, ("constant", "random"))
    table, within = _table(given, "params", where), f"{where}.params"
    low, high = ("value", "value") if name == "constant" else ("min", "max")
    return _value(table, low, within), _value(table, high, within)


def _jump(given: dict[str, Any], where: str) -> tuple[str, Callable[[float, float], bool], float, float]:
    table, within = _table(given, "condition", where), f"{where}.condition"
    holds = _one_of(_table(table, "operator", within), "name", f"{within}.operator", CONDITIONS)
    limit = number(f"{within}.value", table.get("value"))
    name = word(f"{within}.parameter", table.get("parameter"))
    return name, CONDITIONS[holds], limit, number(f"{where}.jump_to", given.get("jump_to"))


def _definition(table: dict[str, Any], name: str) -> tuple[float, float, float]:
    """Return default, least and largest value of a parameter."""
    given, where = _table(table, name, "user_parameter_definitions"), f"user_parameter_definitions.{name}"
    least, most = (
        without if (bound := given.get(key)) is None else number(f"{where}.{key}", bound)
        for key, without in (("min", -math.inf), ("max", math.inf))
    )
    return number(f"{where}.default", given.get("default")), least, most


def _value(given: dict[str, Any], key: str, where: str) -> Value:
    """Parse a value: a number, a parameter's name, or a formula. Returns a function that computes it."""
    table, within = _table(given, key, where), _joined(where, key)
    # Older revisions name a parameter "dynamic".
    kind = _one_of(table, "type", within, ("f64", "param", "dynamic", "formula"))
    if kind == "formula":
        return _formula(table.get("value"), f"{within}.value", 0)
    return _leaf(kind == "f64", table.get("value"), f"{within}.value")


def _leaf(constant: bool, given: Any, where: str) -> Value:
    if constant:
        known = number(where, given)
        return lambda _: known
    name = word(where, given)
    return lambda value: value(name)


def _formula(given: Any, where: str, deep: int) -> Value:
    if deep > MOST_DEEP:
        raise stated(where, f"is deeper than {MOST_DEEP} levels", "give a simpler formula")
    if not isinstance(given, dict):
        raise refused(where, given, "give a formula")
    kind = _one_of(given, "type", where, ("constant", "parameter", "negate", *OPERATORS))
    inner = given.get("value")
    if kind in ("constant", "parameter"):
        return _leaf(kind == "constant", inner, f"{where}.value")
    if kind == "negate":
        negated = _formula(inner, where, deep + 1)
        return lambda value: -negated(value)
    if not isinstance(inner, list) or len(inner) != 2:
        raise refused(f"{where}.value", inner, "give two formulas")
    one, other = (_formula(each, where, deep + 1) for each in inner)
    act = OPERATORS[kind]
    return lambda value: act(one(value), other(value))
