"""`midair new` writes a commented scene file to start with; `midair export` converts files of drives."""

import os
import shlex
import subprocess
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .._files import WRITTEN, ControlPoints, read, write
from .._midair import stated
from .._support import output
from .given import STANDARD, check_outputs
from .tables import print_written


def export_command(
    drives: Path,
    output: Annotated[Path, Parameter(name=("--output", "-o"))],
    *,
    board: str | None = None,
    layout: str | None = None,
    modulate: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
) -> int:
    """Write the drives of a file in another format.

    Parameters
    ----------
    drives
        A file of midair solve, midair motion or another program: .npz, .json, .csv, .holo or .bin.
    output
        Where to write them; the ending decides: .npz, .csv, .holo (AcousTools) or .bin (frames of a board).
    board
        The board of the frames of a .bin: a name, such as sonicsurface, or a .pat file.
    layout
        Layout of a .csv: drive, acoustools, ultraino or points.
    modulate
        For points, the frequency in Hz of the device's modulation.
    """
    check_outputs((output, WRITTEN), taken=[drives])
    found = read(drives, board=board)
    if isinstance(found, ControlPoints) and layout is None:
        layout = "points"
    write(output, found, board=board, layout=layout, modulate=modulate)
    print_written(output)
    return 0


#: Text of the scene file to start with: all keys, for a scene that solves well.
STARTER = Path(__file__).with_name("starter.toml")


def new_command(scene: Path = Path("scene.toml")) -> int:
    """Write a commented scene file to start with; an existing file is never replaced.

    Parameters
    ----------
    scene
        Where to write it, a name ending in .toml, or - for standard output.
    """
    starter = STARTER.read_text(encoding="utf-8")
    if scene == STANDARD:
        print(starter, end="")
        return 0
    if os.path.lexists(scene):
        raise stated(f'"{scene}"', "is there already", "give another name, as in midair new my-scene.toml")
    output.check(scene, (".toml",))
    output.write(scene, starter.encode())
    # The command lines of Windows do not know single quotes.
    typed = (subprocess.list2cmdline if os.name == "nt" else shlex.join)([str(scene)])
    print_written(f"{scene}; solve it with: midair solve {typed}")
    return 0
