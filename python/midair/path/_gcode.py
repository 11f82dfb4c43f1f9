"""Paths from programs: G-code (lines and arcs of a tool) and L-code (frames of AcousTools for levitators)."""

import re
from collections.abc import Callable
from functools import partial
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Path, SceneError, stated
from .._support.arguments import frame_rate, number, path_of, vector
from .._support.text import fault, numbers, text
from ._frames import from_array
from ._kinds import polyline

#: Largest distance in m of the straight pieces from their arc.
CHORD = 1e-6
#: Largest number of pieces of an arc, and largest difference of its radii at both ends, in mm.
MOST_PIECES, ROUNDING = 10_000, 0.01
#: Largest number in a program, and smallest radius or chord of an arc, in mm.
LARGEST, LEAST = 1e9, 1e-9
#: Codes that do not change where a tool goes: plane XY, no compensation, work offset 1, feed per minute.
NEUTRAL_G = {"17", "40", "49", "54", "64", "80", "94"}


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
    for row, line in enumerate(program.splitlines(), 1):
        wrong = partial(_wrong, row, line)
        bare = re.sub(r"\([^)]*\)|;.*|%", "", line).upper()
        words = re.findall(r"([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:E[+-]?\d+)?)", bare)
        if "".join(letter + value for letter, value in words) != re.sub(r"\s", "", bare):
            raise wrong("give words of a letter and a number, such as G1 X10 Y5")
        if any(abs(float(value)) > LARGEST for _, value in words):
            raise wrong(f"give numbers of at most {LARGEST:g}")
        if any(letter == "M" and float(value) in (2, 30) for letter, value in words):
            break
        values = {letter: float(value) for letter, value in words if letter != "G"}
        if values.get("M") == 98 or (move in "23" and "P" in values):
            raise wrong("programs inside others and arcs of several turns are not read")
        for code in (value.lstrip("0") or "0" for letter, value in words if letter == "G"):
            if code in ("0", "1", "2", "3"):
                move = code
            elif code in ("20", "21"):
                unit = 25.4 if code == "20" else 1.0
            elif code in ("90", "91"):
                absolute = code == "90"
            elif code not in NEUTRAL_G:
                raise wrong(f"G{code} is unknown, give G0 to G3, G20, G21, G90 and G91")
        if not values.keys() & set("XYZ") and not (move in "23" and values.keys() & set("IJR")):
            continue
        there = here.copy()
        for axis, letter in enumerate("XYZ"):
            if letter in values:
                there[axis] = unit * values[letter] + (0.0 if absolute else here[axis])
        if not places and (not absolute or move in "23"):
            places.append(here)
        if move in "23":
            places.extend(_arc(here, there, {k: unit * v for k, v in values.items()}, move, wrong))
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
    wrong: Callable[[str], SceneError],
) -> NDArray[np.float64]:
    """Return places in mm on an arc: clockwise for move 2; the height changes evenly (a helix)."""
    start, end = complex(*here[:2]), complex(*there[:2])
    sign = -1 if move == "2" else 1
    if "R" in values:
        radius, chord = values["R"], end - start
        if not LEAST < abs(chord) <= 2 * abs(radius) + ROUNDING:
            raise wrong("no arc of this radius joins the places, give I and J")
        rise = np.sqrt(max(radius**2 - abs(chord) ** 2 / 4, 0))
        centre = (start + end) / 2 + sign * np.sign(radius) * 1j * chord / abs(chord) * rise
    elif values.keys() & set("IJ"):
        centre = start + complex(values.get("I", 0.0), values.get("J", 0.0))
    else:
        raise wrong("an arc needs its centre I and J, or its radius R")
    arm, last = start - centre, end - centre
    if abs(arm) < LEAST or abs(abs(arm) - abs(last)) > ROUNDING:
        raise wrong(f"its radius is {abs(arm):.4g} mm at first and {abs(last):.4g} mm at last")
    turn = sign * (sign * np.angle(last / arm) % (2 * np.pi))
    turn = sign * 2 * np.pi if abs(turn) < 1e-9 else turn
    pieces = int(np.ceil(abs(turn) / (2 * np.arccos(max(1 - 1e3 * CHORD / abs(arm), 0.0)))))
    part = np.arange(1, min(pieces, MOST_PIECES) + 1) / min(pieces, MOST_PIECES)
    on = centre + arm * (1 + part * (abs(last) / abs(arm) - 1)) * np.exp(1j * turn * part)
    return np.column_stack([on.real, on.imag, here[2] + part * (there[2] - here[2])])


def _wrong(row: int, line: str, cure: str) -> SceneError:
    return stated(f"line {row} of the program", f'is "{line.strip()[:60]}"', cure)


#: Commands that do not change where points are: droplets, light, solvers, boards, layers and reflectors.
NEUTRAL_L = {"C0", "C1", "C2", "C5", "C6", "C7", "C8", "C9", "C10", "C12", "C13", "O0"}
#: Largest number of frames, those of delays among them.
MOST_FRAMES = 1_000_000


def lcode(
    path: str | PathLike[str],
    *,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    rate: float | None = None,
    closed: bool = False,
    pressures: ArrayLike | None = None,
) -> Path:
    """Move points as an L-code program of AcousTools does: a frame for each of L0 to L3.

    Parameters
    ----------
    path : str or path
        A file, or the text of a program of several lines. Coordinates are in m.
    origin : (3,) array_like, optional
        Place of the program's zero in m.
    rate : float, optional
        Frames per second; by default those of the command C11.
    closed : bool, optional
        Whether the last frame continues to the first.
    pressures : float, (M,) or (T, M) array_like, optional
        Peak pressures in Pa; by default the balanced level.

    Returns
    -------
    Path
        The path. After a frame, C3 holds it for some ms, and C4 does so after each frame.

    Raises
    ------
    SceneError
        For a function, L4 before the last frame, frames of several kinds or numbers of points, an unknown
        command, fewer than two frames, and without a frame rate.

    Notes
    -----
    L0 is a focus, L1 a trap, L2 a twin trap, L3 a vortex. A path has no kind: give `signature=` to
    `midair.sequence`. Solvers and boards in the program have no effect. AcousTools' zero is the middle
    between two facing boards, that of `openmpd_pair`.

    Examples
    --------
    >>> import midair
    >>> program = "C11:100;" + chr(10) + "L1:0,0,0.01;" + chr(10) + "L1:0,0.001,0.01;"
    >>> midair.path.lcode(program)
    Path(points=1, duration=0.01, closed=False)
    """
    name, written = program(path)
    frames: list[Any] = []
    holds: list[float] = []
    kinds, every, off, written_rate = set(), 0.0, False, None
    rows = [
        (line, part) for line, row in enumerate(written.splitlines(), 1) for part in row.partition("#")[0].split(";")
    ]
    for line, row in rows:
        code, *groups = row.strip().split(":")
        if not code or code in NEUTRAL_L:
            continue
        if code in ("C3", "C4", "C11") and len(groups) == 1:
            value = number(f"{code} of line {line}", numbers(name, line, groups, [code])[0], least=0)
            if code == "C11":
                if written_rate not in (None, value):
                    cure = "give one C11 in each program"
                    raise fault(name, line, f'"{row.strip()}" changes the frame rate', cure)
                written_rate = value
            elif code == "C4":
                every = value
            elif holds:
                holds[-1] += value
        elif code == "L4":
            off = True
        elif code in ("L0", "L1", "L2", "L3") and groups and not off:
            points = [numbers(name, line, group.split(","), "xyz") for group in groups if group.strip()]
            if any(len(point) != 3 for point in points):
                raise fault(name, line, f'"{row.strip()[:60]}" is no point', "give x,y,z in m")
            frames.append(points)
            holds.append(every)
            kinds.add(code)
        else:
            cure = "give L0 to L3 of x,y,z, C3, C4 and C11 of a number, and no functions; L4 at the end"
            raise fault(name, line, f'"{row.strip()[:60]}" is not read', cure)
    if len(kinds) > 1:
        cure = "give one kind in each program, and join paths by a.then(b)"
        raise stated("the program", f"has frames of {' and '.join(sorted(kinds))}", cure)
    if len(frames) < 2:
        raise stated("the program", "has fewer than two frames", "give L-code with L0 to L3")
    rate = written_rate if rate is None else rate
    if rate is None:
        raise stated("rate", "is missing", "give frames per second: the program has no C11", code="missing")
    counts = 1 + np.rint(np.array(holds) * 1e-3 * frame_rate(rate))
    if counts.sum() > MOST_FRAMES:
        raise stated("the program", f"has {counts.sum():.3g} frames", f"give at most {MOST_FRAMES}")
    moved = [[point + vector("origin", origin) for point in points] for points in frames]
    places = [points for points, count in zip(moved, counts, strict=True) for _ in range(int(count))]
    return from_array(places, rate=rate, closed=closed, pressures=pressures)
