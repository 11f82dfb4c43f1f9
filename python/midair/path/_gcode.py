"""Paths from G-code: straight lines and arcs of a tool, in mm or inches."""

import re
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Path, SceneError, stated
from .._support.arguments import path_of, vector
from .._support.text import text
from ._kinds import polyline

#: Largest distance in m of the straight pieces from their arc.
CHORD = 1e-6
#: Largest number of pieces of an arc, and largest difference of its radii at both ends, in mm.
MOST_PIECES, ROUNDING = 10_000, 0.01
#: Largest number in a program, and smallest radius or chord of an arc, in mm.
LARGEST, LEAST = 1e9, 1e-9
#: Codes that do not change where a tool goes: plane XY, no compensation, work offset 1, feed per minute.
NEUTRAL = {"17", "40", "49", "54", "64", "80", "94"}


def gcode(
    path: str | PathLike[str],
    *,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    speed: float | None = None,
    frequency: float | None = None,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move a point along the lines (G0, G1) and arcs (G2, G3, plane XY) of a G-code program.

    Parameters
    ----------
    path : str or path
        A file, or the text of a program of several lines. Numbers are in mm, after G20 in inches.
    origin : (3,) array_like, optional
        Place of the program's zero in m.
    speed : float, optional
        Speed in m/s; alternatively give `frequency`. The program's feed rates are not used.
    frequency : float, optional
        Runs per second along the whole path.
    pressures : float, optional
        Peak pressure in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path from the first place that the program names, or from its zero if the first move is relative
        or an arc; closed if it ends there.

    Raises
    ------
    SceneError
        For a code that moves a tool in another way (G4, G18, G28, G53 and others), an arc without centre or
        with two radii, a program without moves, and unless either a speed or a frequency is given.

    Examples
    --------
    >>> import midair
    >>> program = "G21 G90; mm, absolute" + chr(10) + "G0 X20 Y0 Z150" + chr(10) + "G2 X20 Y0 I-20 J0"
    >>> midair.path.gcode(program, frequency=5)
    Path(points=1, duration=0.2, closed=True)
    """
    places = _places(program(path)[1]) + vector("origin", origin)
    closed = len(places) > 2 and bool(np.allclose(places[0], places[-1], atol=1e-9, rtol=0))
    return polyline(
        places[:-1] if closed else places,
        speed=speed, frequency=frequency, closed=closed, pressures=pressures,
    )  # fmt: skip


def program(path: str | PathLike[str]) -> tuple[str, str]:
    """Return the name and the text of a program: of a file, or itself if it has several lines."""
    if isinstance(path, str) and "\n" in path:
        return "text", path
    return str(path_of("path", path)), text(path)


def _places(program: str) -> NDArray[np.float64]:
    """Return the corners (K, 3) in m of a program."""
    unit, absolute, move, here = 1.0, True, "0", np.zeros(3)
    places: list[NDArray[np.float64]] = []
    for number, line in enumerate(program.splitlines(), 1):
        bare = re.sub(r"\([^)]*\)|;.*|%", "", line).upper()
        words = re.findall(r"([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:E[+-]?\d+)?)", bare)
        if "".join(letter + value for letter, value in words) != re.sub(r"\s", "", bare):
            raise _wrong(number, line, "give words of a letter and a number, such as G1 X10 Y5")
        if any(abs(float(value)) > LARGEST for _, value in words):
            raise _wrong(number, line, f"give numbers of at most {LARGEST:g}")
        if any(letter == "M" and float(value) in (2, 30) for letter, value in words):
            break
        values = {letter: float(value) for letter, value in words if letter != "G"}
        if values.get("M") == 98 or (move in "23" and "P" in values):
            raise _wrong(number, line, "programs inside others and arcs of several turns are not read")
        for code in (value.lstrip("0") or "0" for letter, value in words if letter == "G"):
            if code in ("0", "1", "2", "3"):
                move = code
            elif code in ("20", "21"):
                unit = 25.4 if code == "20" else 1.0
            elif code in ("90", "91"):
                absolute = code == "90"
            elif code not in NEUTRAL:
                raise _wrong(number, line, f"G{code} is unknown, give G0 to G3, G20, G21, G90 and G91")
        if not values.keys() & set("XYZ") and not (move in "23" and values.keys() & set("IJR")):
            continue
        there = here.copy()
        for axis, letter in enumerate("XYZ"):
            if letter in values:
                there[axis] = unit * values[letter] + (0.0 if absolute else here[axis])
        if not places and (not absolute or move in "23"):
            places.append(here)
        if move in "23":
            places.extend(_arc(here, there, {k: unit * v for k, v in values.items()}, move, number, line))
        else:
            places.append(there)
        here = there
    if len(places) < 2:
        raise stated("the program", "has fewer than two places", "give G-code with moves, as G1 X10 Y5")
    return np.array(places) * 1e-3


def _arc(
    here: NDArray[np.float64],
    there: NDArray[np.float64],
    values: dict[str, float],
    move: str,
    number: int,
    line: str,
) -> NDArray[np.float64]:
    """Return places in mm on an arc: clockwise for move 2; the height changes evenly (a helix)."""
    start, end = complex(*here[:2]), complex(*there[:2])
    sign = -1 if move == "2" else 1
    if "R" in values:
        radius, chord = values["R"], end - start
        if not LEAST < abs(chord) <= 2 * abs(radius) + ROUNDING:
            raise _wrong(number, line, "no arc of this radius joins the places, give I and J")
        rise = np.sqrt(max(radius**2 - abs(chord) ** 2 / 4, 0))
        centre = (start + end) / 2 + sign * np.sign(radius) * 1j * chord / abs(chord) * rise
    elif values.keys() & set("IJ"):
        centre = start + complex(values.get("I", 0.0), values.get("J", 0.0))
    else:
        raise _wrong(number, line, "an arc needs its centre I and J, or its radius R")
    arm, last = start - centre, end - centre
    if abs(arm) < LEAST or abs(abs(arm) - abs(last)) > ROUNDING:
        raise _wrong(number, line, f"its radius is {abs(arm):.4g} mm at first and {abs(last):.4g} mm at last")
    turn = sign * (sign * np.angle(last / arm) % (2 * np.pi))
    turn = sign * 2 * np.pi if abs(turn) < 1e-9 else turn
    pieces = int(np.ceil(abs(turn) / (2 * np.arccos(max(1 - 1e3 * CHORD / abs(arm), 0.0)))))
    part = np.arange(1, min(pieces, MOST_PIECES) + 1) / min(pieces, MOST_PIECES)
    on = centre + arm * (1 + part * (abs(last) / abs(arm) - 1)) * np.exp(1j * turn * part)
    return np.column_stack([on.real, on.imag, here[2] + part * (there[2] - here[2])])


def _wrong(number: int, line: str, cure: str) -> SceneError:
    return stated(f"line {number} of the program", f'is "{line.strip()[:60]}"', cure)
