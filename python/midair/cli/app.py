"""The program `midair`: its commands, and how it ends."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from typing import NoReturn

from cyclopts import App, CycloptsError

from .. import SceneError, SceneWarning, __version__
from .compare import compare_command
from .presets import presets_command
from .reproduce import reproduce_command
from .solve import solve_command
from .solvers import solvers_command
from .status import INTERRUPTED, REFUSED, one_line
from .sweep import sweep_command

app = App(
    name="midair",
    help="Drives for airborne ultrasound phased arrays: given points in the air feel given pressures.",
    version=__version__,
    # It is `main` that tells of an interruption.
    suppress_keyboard_interrupt=False,
)
app.command(solve_command, name="solve")
app.command(compare_command, name="compare")
app.command(solvers_command, name="solvers")
app.command(presets_command, name="presets")
app.command(reproduce_command, name="reproduce")
app.command(sweep_command, name="sweep")


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and leave with its status: 0, 2 for a request refused, 130 for Ctrl-C."""
    warnings.showwarning = lambda message, *_: print(f"warning: {message}", file=sys.stderr)
    warnings.simplefilter("always", SceneWarning)
    try:
        status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except (SceneError, OSError, CycloptsError) as error:
        print(f"error: {one_line(error)}", file=sys.stderr)
        sys.exit(REFUSED)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
    sys.exit(status if isinstance(status, int) else 0)
