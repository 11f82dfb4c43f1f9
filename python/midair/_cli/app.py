"""The program `midair`: its commands, and how it ends."""

from __future__ import annotations

import logging
import sys
import warnings
from collections.abc import Sequence
from typing import NoReturn

from cyclopts import App, CycloptsError, UnusedCliTokensError

from .. import BoardError, SceneError, SceneWarning, __version__
from .._support.ctrl_c import Terminated, leave, terminable
from .boards import boards_command, off_command, ports_command
from .calibrate import calibrate_command, doctor_command
from .compare import compare_command
from .motion import motion_command
from .new import export_command, new_command
from .play import play_command
from .presets import presets_command, solvers_command
from .progress import FAULT, INTERRUPTED, REFUSED, UNREAD, abandon, fault, one_line, prepare, tell
from .solve import solve_command
from .studio import studio_command
from .sweep import reproduce_command, sweep_command
from .tolerate import exposure_command, tolerate_command

app = App(
    name="midair",
    help="Drives for airborne ultrasound phased arrays: given points in the air feel given pressures.",
    version=__version__,
    # It is `main` that tells of an interruption.
    suppress_keyboard_interrupt=False,
)
app.command(new_command, name="new")
app.command(solve_command, name="solve")
app.command(compare_command, name="compare")
app.command(solvers_command, name="solvers")
app.command(presets_command, name="presets")
app.command(reproduce_command, name="reproduce")
app.command(sweep_command, name="sweep")
app.command(tolerate_command, name="tolerate")
app.command(exposure_command, name="exposure")
app.command(motion_command, name="motion")
app.command(calibrate_command, name="calibrate")
app.command(doctor_command, name="doctor")
app.command(boards_command, name="boards")
app.command(ports_command, name="ports")
app.command(play_command, name="play")
app.command(off_command, name="off")
app.command(export_command, name="export")
app.command(studio_command, name="studio")


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and leave with its status (docs/conventions.md)."""
    prepare()
    warnings.simplefilter("always", SceneWarning)
    warned = set()

    def warn(message: Warning | str, *_: object, **__: object) -> None:
        # Many solvers may have one thing to say.
        if str(message) not in warned:
            warned.add(str(message))
            tell(f"warning: {message}")

    warnings.showwarning = warn
    # Where matplotlib keeps its cache and which fonts it lacks is nothing to act upon.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    # To the parser a bare hyphen is an option; as a path it stands for a standard stream.
    typed = sys.argv[1:] if arguments is None else arguments
    status = _run(["./-" if word == "-" else word for word in typed])
    try:
        sys.stdout.flush()
    except OSError:
        abandon()
    leave(status)


def usage(arguments: Sequence[str]) -> str:
    """The help that is nearest to a command line."""
    commands = [word for word in arguments[:1] if word in app]
    return " ".join(["midair", *commands, "--help"])


def _run(arguments: Sequence[str]) -> int:
    try:
        with terminable():
            status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
            sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except BrokenPipeError:
        return UNREAD
    except UnusedCliTokensError as error:
        unused = " ".join(error.unused_tokens or ())
        cure = "leave it out; what belongs to one option goes without blanks, as in --at 0,0,0.15"
        tell(f'error: "{one_line(unused)}" belongs to no option: {cure}. See {usage(arguments)}')
        return REFUSED
    except CycloptsError as error:
        tell(f"error: {one_line(error)} See {usage(arguments)}")
        return REFUSED
    except (SceneError, BoardError, OSError) as error:
        tell(f"error: {one_line(error)}")
        return REFUSED
    except MemoryError as error:
        tell(f"error: {one_line(error) or 'memory ran out: ask for less at once'}")
        return REFUSED
    except Terminated as stop:
        tell("terminated")
        return 128 + stop.number
    except KeyboardInterrupt:
        tell("interrupted")
        return INTERRUPTED
    except SystemExit:
        raise
    except BaseException as error:
        # A panic of the core is no Exception.
        tell(f"error: {fault(error)}")
        return FAULT
