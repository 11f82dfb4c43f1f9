"""`midair.write`: drives, sequences and control points as files of other programs, by ending and layout."""

from os import PathLike
from pathlib import Path as File
from typing import Any

from .._boards.board import Board
from .._midair import Solution, drive_to_csv, stated
from .._sequence import Sequence
from .._sequence.files import whole
from .._support import output
from .._support.arguments import path_of, refused, shown, word
from ..path import Path
from . import acoustools, control_points, played as board_frames, record, ultraino
from .control_points import ControlPoints
from .played import Played, known, played

ENDINGS = (".npz", ".csv", ".json", ".holo", ".bin")
#: Formats that `Solution.save` writes.
SAVED = (".npz", ".json", "drive")
LAYOUTS = ("drive", "acoustools", "ultraino", "points")


def write(
    path: str | PathLike[str],
    drives: Any,
    *,
    board: Board | str | PathLike[str] | None = None,
    layout: str | None = None,
    rate: float | None = None,
    modulate: float | None = None,
) -> None:
    """Write drives (or control points) to a file, whole or not at all.

    Parameters
    ----------
    path : str or path
        File to write; its ending chooses the format, below.
    drives : midair.Solution, midair.Sequence, (N,) or (T, N) array_like, or midair.path.Path
        Complex drives of |q| <= 1; for "points" places (M, 3) or (T, M, 3) in m, a path or a sequence.
    board : midair.Board, str or path, optional
        A board, its name or .pat file; needed for .bin. Drives without an array get the board's array.
    layout : str, optional
        Layout of a .csv, see Notes; by default it follows from the content.
    rate : float, optional
        Frames per second of "points".
    modulate : float, optional
        Frequency in Hz at which the device modulates "points".

    Raises
    ------
    SceneError
        For data that a format cannot store and for a path that cannot be written.

    See Also
    --------
    midair.read : reads these files.

    Notes
    -----
    | ending | content | of |
    |---|---|---|
    | `.npz` | the file of `save` of a Solution or Sequence; of numbers `drive` or `drives` | any |
    | `.json` | the file of `Solution.save` | a Solution |
    | `.holo` | AcousTools: phases of 32 steps, amplitudes of 32 steps | any |
    | `.bin` | the board's frames, one after another | any, with `board` |
    | `.csv`, "drive" | index,x,y,z,amplitude,phase; x,y,z if the array is known | one drive |
    | `.csv`, "acoustools" | a line frames,transducers, then phases in rad; amplitudes are lost | any |
    | `.csv`, "ultraino" | phases to ...0_Phase.csv, amplitudes to ...0_Amp.csv | any |
    | `.csv`, "points" | t,x,y,z,intensity[,frequency]: for Ultraleap's devices, no drives | points |

    Drives of 256 or 512 transducers in `.holo` and "acoustools" are those of one or two OpenMPD boards and
    are put into AcousTools' order; other numbers keep their order, with a warning. Without a layout, a name
    with 0_Phase means "ultraino".

    Examples
    --------
    >>> import midair, pathlib, tempfile
    >>> solution = midair.solve(midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.15]]))
    >>> path = pathlib.Path(tempfile.gettempdir(), "frame.bin")
    >>> midair.write(path, solution, board="sonicsurface")
    >>> path.stat().st_size
    258
    """
    file = path_of("path", path)
    output.check(file, ENDINGS)
    chosen = _layout(file, drives, layout)
    for name, value in (("rate", rate), ("modulate", modulate)):
        if value is not None and chosen != "points":
            raise refused(name, value, 'it is of control points: give layout="points", or leave it out')
    saves = isinstance(drives, Solution) and drives.scene is not None and chosen in SAVED
    if chosen == "points":
        given = control_points.control_points(drives, rate, modulate)
        with whole(file, (".csv",)) as part:
            control_points.write(part, given)
    elif saves or (isinstance(drives, Sequence) and chosen == ".npz"):
        drives.save(file)
    else:
        player = known(board)
        _write(file, chosen, played(drives, player), player)


def _layout(file: File, drives: Any, layout: str | None) -> str:
    """Return the layout of a .csv; for other files the ending."""
    ending = file.suffix.lower()
    if ending != ".csv":
        if layout is not None:
            raise refused("layout", layout, f"a {ending} file has but one, leave it out")
        return ending
    if layout is None:
        if isinstance(drives, Path | ControlPoints):
            return "points"
        return "ultraino" if ultraino.NAMED in file.name else "drive"
    found = word("layout", layout).lower().replace("-", "").replace("_", "")
    if found not in LAYOUTS:
        raise refused("layout", layout, f"give {', '.join(LAYOUTS[:-1])} or {LAYOUTS[-1]}")
    return found


def _write(file: File, layout: str, drives: Played, board: Board | None) -> None:
    if layout == "ultraino":
        ultraino.write_pair(file, drives)
        return
    if layout == ".json":
        raise stated(
            "", f"output {shown(file)}", ".json holds a Solution of a scene, give .npz, .csv or .holo"
        )
    with whole(file, ENDINGS) as part:
        if layout == ".bin":
            board_frames.write(part, drives, board)
        else:
            plain = {
                ".npz": record.write,
                ".holo": acoustools.write_holo,
                "acoustools": acoustools.write,
                "drive": _drive,
            }
            plain[layout](part, drives)


def _drive(path: File, drives: Played) -> None:
    """Write one drive: a row index,x,y,z,amplitude,phase per transducer; no x,y,z if the array is unknown."""
    if drives.frames != 1:
        cure = 'give layout="acoustools" or "ultraino", or a name that ends in .npz'
        raise stated("", f"{drives.frames} frames", f"this .csv holds one drive, {cure}")
    (drive,) = drives
    positions = None if drives.array is None else drives.array.positions
    path.write_bytes(drive_to_csv(drive, positions).encode())
