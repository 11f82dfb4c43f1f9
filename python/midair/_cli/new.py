"""`midair new`: a commented scene file to begin with."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .. import SceneError
from .._files import ControlPoints, read, write
from .._files.writing import ENDINGS
from .._support import output
from .scene import STANDARD, check_outputs
from .tables import print_written


def export_command(
    drives: Path,
    output: Path,
    *,
    board: str | None = None,
    layout: str | None = None,
    modulate: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
) -> int:
    """Write the drives of a file in another format.

    Parameters
    ----------
    drives
        What midair solve, midair motion or another program wrote: .npz, .json, .csv, .holo or .bin.
    output
        Where they go, by the ending: .npz, .csv, .holo (AcousTools) or .bin (frames of a board).
    board
        The board whose frames a .bin holds: a name, such as sonicsurface, or a .pat file.
    layout
        Of a .csv: drive, acoustools, ultraino or points.
    modulate
        Of points, the frequency in Hz at which the device is to modulate them.
    """
    check_outputs((output, ENDINGS), taken=[drives])
    found = read(drives, board=board)
    if isinstance(found, ControlPoints) and layout is None:
        layout = "points"
    write(output, found, board=board, layout=layout, modulate=modulate)
    print_written(output)
    return 0


#: What a scene file can say, and a scene that solves well as it stands.
STARTER = """\
# A scene for midair: an array, points in the air, and the pressures that they shall feel.
#
#   midair solve scene.toml                       solve it and say how good the answer is
#   midair solve scene.toml -o drive.csv          the same, and write amplitude and phase of each transducer
#   midair solve scene.toml --image field.png     the same, and draw the field
#   midair compare scene.toml                     solve it by every method there is
#
# Lengths are in metres, pressures in pascals (peak). z points away from the array, from its middle.

[array]
preset = "autd3"            # `midair presets` lists the boards known by name
tiles = [1, 1]              # boards along x and y
# In place of a preset:
# grid = { nx = 16, ny = 16, pitch = 0.0105 }   # rows and columns of transducers, and how far apart
# positions = [[0.0, 0.0, 0.0], [0.0105, 0.0, 0.0]]
# positions = { file = "bowl.csv" }             # a row x,y,z or x,y,z,nx,ny,nz for each transducer
# source_pressure = 4.386                       # Pa m: pressure on the axis times distance
# directivity = { piston = 4.5e-3 }             # or "point", "t4010a1", { cos = 3.4 }

# One [[points]] for each point. Leave every pressure out for as much as the array can make.
[[points]]
position = [-0.02, 0.0, 0.15]
pressure = 3000.0

[[points]]
position = [0.02, 0.0, 0.15]
pressure = 3000.0

# [[points]]
# position = [0.0, 0.03, 0.15]
# pressure = 0.0            # a quiet point

# Many points at once: "line", "circle", "polyline", "text" or "svg", or an [image] (docs/shapes.md).
# [[shape]]
# kind = "text"
# string = "hi"
# height = 0.03
# z = 0.15
# pressure = 1000.0

[solver]
name = "uniform"            # `midair solvers` lists the methods, `midair solvers greedy` the options of one
# aim = "max"               # as loud as the array can, in the ratios of the pressures

# [medium]
# temperature = 25.0        # degrees C, with humidity = 50.0 in percent; or sound_speed = 340.0 in m/s
# absorption = 0.15         # Np/m

# [plane]                   # what --image draws; left out, it goes through the points
# z = 0.15
# size = 0.1
"""


def new_command(scene: Path = Path("scene.toml")) -> int:
    """Write a commented scene file to begin with; a file that is there is left alone.

    Parameters
    ----------
    scene
        Where it goes, a name ending in .toml, or - for standard output.
    """
    if scene == STANDARD:
        print(STARTER, end="")
        return 0
    if os.path.lexists(scene):
        raise SceneError(f'"{scene}" is there already: give another name, as in midair new my-scene.toml')
    output.check(scene, (".toml",))
    output.write(scene, STARTER.encode())
    print_written(f"{scene}: midair solve {scene}")
    return 0
