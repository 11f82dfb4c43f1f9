"""`midair play` (a drive, a scene or a sequence, for some time or until Ctrl-C) and `midair off`."""

import math
import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Annotated

import numpy as np
from cyclopts import Parameter
from numpy.typing import NDArray
from rich.console import Console
from rich.live import Live

from .. import Array, Board, Connection, Scene, Sequence, Solution, connect, read, solve
from .._boards.address import DEFAULT, KINDS, PAIR, board_at, can_modulate, parse
from .._boards.connection import LOOK, keep
from .._midair import stated
from .._points.ear import REFERENCE
from .._sequence.solve import motion_of, solve_motion
from .._support.arguments import number, refused
from .._support.text import counted
from .progress import progress_bar, tell
from .tables import print_line

#: Seconds per unit in the option --for.
UNITS = {"ms": 1e-3, "s": 1.0, "": 1.0, "min": 60.0, "h": 3600.0}


def play_command(
    what: Path,
    *,
    on: str,
    duration: Annotated[str | None, Parameter(name="--for")] = None,
    modulate: float | None = None,
    solver: str | None = None,
) -> int:
    """Play a scene, a drive or a sequence on a board. Ctrl-C turns it off.

    Parameters
    ----------
    what
        A scene file, which is solved first; or a file of midair solve -o or midair motion -o.
    on
        The board and its place: sonicsurface:/dev/ttyUSB0, autd3, null, sonicsurface:loop (docs/boards.md).
    duration
        How long: 10s, 500ms, 2min. By default until Ctrl-C; an open sequence once.
    modulate
        Amplitude modulation in Hz, for boards that can modulate.
    solver
        Name of the solver of a scene file; by default the file's own, else uniform.
    """
    seconds = _seconds(duration)
    place = parse(on)
    if modulate is not None:
        # Solving may take long, so the modulation is checked before the scene is solved.
        number("--modulate", modulate, above=0)
        can_modulate(place.kind_of_board or DEFAULT)
    thing = _thing(what, solver, lambda array: board_at(place, array))
    board = board_at(place, thing.array if isinstance(thing, Sequence) else _scene(thing).array)
    with connect(on, board=board) as connection, _status(connection, on, _loudness(thing), seconds) as show:
        if modulate is not None:
            connection.modulate(modulate)
        if isinstance(thing, Sequence):
            connection.stream(_frames(thing, seconds, show), rate=thing.rate)
        else:
            keep(connection, thing, seconds, show)
        # A final call: it reports a lost board, which closing the connection would not.
        connection.off()
    return 0


def _seconds(text: str | None) -> float | None:
    """Return the seconds of a text such as 10s, 500ms, 2min or a number."""
    if text is None:
        return None
    found = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*(ms|s|min|h|)", text.strip())
    seconds = float(found[1]) * UNITS[found[2]] if found else math.nan
    if not 0 < seconds < math.inf:
        raise refused("--for", text, "give a time such as 10s, 500ms or 2min")
    return seconds


def _thing(path: Path, solver: str | None, board: Callable[[Array], Board]) -> Solution | Sequence:
    """Return the solution or sequence to play. A scene file is solved first."""
    if path.suffix.lower() not in (".toml", ".json"):
        found = read(path)
        if solver is not None:
            raise stated("--solver", f"is {solver}", f"{path} is solved already, leave it out")
        if not isinstance(found, Solution | Sequence) or (isinstance(found, Solution) and found.scene is None):
            cure = "give what midair solve or motion wrote"
            raise stated(f'"{path}"', "does not say what array it is for", cure)
        return found
    moving = motion_of(path)
    if moving is not None:
        with progress_bar("solving") as show:
            return solve_motion(moving, board(moving.scene.array).array, solver, progress=show)
    scene = Scene.load(path)
    return solve(scene.replace(array=board(scene.array).array), solver)


def _scene(solution: Solution) -> Scene:
    assert solution.scene is not None
    return solution.scene


def _frames(sequence: Sequence, seconds: float | None, show: Callable[[], None]) -> Iterator[NDArray[np.complex64]]:
    """Yield the frames of a sequence, repeatedly if it is closed or a time is given."""
    frames = len(sequence)
    once = seconds is None and not sequence.closed
    last = frames if once else math.inf if seconds is None else round(seconds * sequence.rate)
    shown = 0.0
    for k in count():
        if k >= last:
            return
        yield sequence.drive(k % frames)
        if time.monotonic() - shown > LOOK:
            shown = time.monotonic()
            show()


def _loudness(thing: Solution | Sequence) -> float:
    """Return the sound pressure level in dB at the loudest point, as the board plays (without the scale)."""
    scale = thing.scale if isinstance(thing, Solution) else 1.0
    loudest = float(np.abs(thing.pressures).max(initial=0.0)) / scale
    return 20 * math.log10(max(loudest, 1e-30) / math.sqrt(2) / REFERENCE)


@contextmanager
def _status(connection: Connection, on: str, level: float, seconds: float | None) -> Iterator[Callable[[], None]]:
    """Show the board's state while it plays; without a terminal, print one line before and one after."""
    terminal = Console(stderr=True)
    begin = time.monotonic()
    sound = f"{level:.0f} dB SPL at the loudest point"

    def line() -> str:
        passed, stats = time.monotonic() - begin, connection.stats
        until = "" if seconds is None else f" of {seconds:g} s"
        rate = f"{stats.frames / max(passed, 1e-3):.4g} frames/s, {stats.late} late"
        return f"{connection.state} on {on}, {passed:.1f} s{until}, {rate}, {sound}. Ctrl-C turns it off"

    live = Live(console=terminal, transient=True, auto_refresh=False)
    moves = terminal.is_terminal and not terminal.is_dumb_terminal
    try:
        # The terminal display starts within the `try`, because Ctrl-C may come at once.
        if moves:
            live.start()
        else:
            tell(f"playing on {on}, {sound}. Ctrl-C turns it off")
        yield lambda: live.update(line(), refresh=True) if moves else None
    finally:
        if moves:
            live.stop()
        stats = connection.stats
        connection.close()
        passed = time.monotonic() - begin
        tell(f"off after {passed:.1f} s: {counted(stats.frames, 'frame')}, {stats.late} late")


#: Longest chain of boards with 64 transducers.
MOST_MEGA64 = 14

#: Kind of board that is assumed for an address without one.
BOARD = "sonicsurface"


def off_command(address: str) -> int:
    """Turn a board off.

    Parameters
    ----------
    address
        A board and its place, such as mega64:/dev/ttyACM0; a port alone means a SonicSurface.
    """
    alone = address.partition(":")[0].removesuffix(PAIR) not in (*KINDS, "null")
    if address.startswith("file:"):
        raise refused("address", address, "a file plays nothing, give a board")
    # A connection turns the board off when it opens and when it closes.
    whole = f"{BOARD}:{address}" if alone else address
    # An array for the longest chain turns off chains of any length.
    array = Array.grid(64, MOST_MEGA64, 10e-3) if whole.startswith("mega64:") else None
    with connect(whole, array=array) as board:
        board.off()
    reported = f"{board.board.name} at {address} is off"
    cure = f"; it was taken for a {BOARD}; else use midair off BOARD:{address}" if alone else ""
    print_line(reported + cure)
    return 0
