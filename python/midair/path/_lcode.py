"""Paths from L-code, the programs of AcousTools for levitators."""

from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._midair import Path, stated
from .._support.arguments import frame_rate, number, vector
from .._support.text import fault, numbers
from ._frames import from_array
from ._gcode import program

#: Commands that do not change where points are: droplets, light, solvers, boards, layers and reflectors.
NEUTRAL = {"C0", "C1", "C2", "C5", "C6", "C7", "C8", "C9", "C10", "C12", "C13", "O0"}
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
        (line, part)
        for line, row in enumerate(written.splitlines(), 1)
        for part in row.partition("#")[0].split(";")
    ]
    for line, row in rows:
        code, *groups = row.strip().split(":")
        if not code or code in NEUTRAL:
            continue
        if code in ("C3", "C4", "C11") and len(groups) == 1:
            value = number(f"{code} of line {line}", numbers(name, line, groups, [code])[0], least=0)
            if code == "C11":
                if written_rate not in (None, value):
                    raise fault(
                        name, line, f'"{row.strip()}" changes the frame rate', "give one C11 in each program"
                    )
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
