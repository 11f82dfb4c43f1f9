"""The program `midair`: its commands and its exit status."""

import logging
import re
import sys
import warnings
from collections.abc import Sequence
from inspect import signature
from shutil import get_terminal_size
from textwrap import fill
from typing import Any, NoReturn, cast

from cyclopts import App, CycloptsError, MissingArgumentError, UnusedCliTokensError

from .. import SceneError, SceneWarning
from .._support import text
from .._support.ctrl_c import Terminated, leave, terminable
from .progress import DOUBTED, FAULT, INTERRUPTED, REFUSED, UNREAD, abandon, fault, one_line, prepare, tell

#: For each command, by name: the module that contains its function NAME_command (imported at first use), and
#: its line in the list of commands.
COMMANDS = {
    "new": ("new", "Write a commented scene file to begin with."),
    "solve": ("solve", "Find a drive for a scene, judge it, write what is requested."),
    "compare": ("solve", "Solve a scene by several methods: a table and a picture."),
    "solvers": ("presets", "List the solvers with their options and defaults."),
    "presets": ("presets", "List the arrays known by name."),
    "reproduce": ("sweep", "Make the figures of Suzuki et al. 2021 anew, and judge them."),
    "sweep": ("sweep", "Solve every problem of a sweep file: one table."),
    "dataset": ("sweep", "Make a data set of scenes and drives, or judge drives by one."),
    "tolerate": ("tolerate", "Play a drive with faults: how much of its level is kept."),
    "exposure": ("tolerate", "Solve a scene: how loud it is at ears and eyes."),
    "motion": ("motion", "Solve the frames of points that move, and judge them."),
    "calibrate": ("calibrate", "Find an array's responses and the sound speed from readings."),
    "doctor": ("calibrate", "Find what is wrong with a board, by a microphone."),
    "boards": ("presets", "List the boards that can be played."),
    "ports": ("presets", "List the serial ports. None is opened."),
    "play": ("play", "Play a scene, a drive or a sequence on a board."),
    "off": ("play", "Turn a board off."),
    "export": ("new", "Write the drives of a file in another format."),
    "serve": ("serve", "Play points that other programs send, by WebSocket or OSC."),
    "studio": ("serve", "Open the studio in the browser. Ctrl-C ends it."),
}


def version() -> str:
    """Return the package's version; it is read only when requested."""
    from .. import __version__

    return __version__


#: Commands that print a table, and the names under which columns.toml explains the tables' columns.
TABLES = {
    "solve": "solutions",
    "compare": "solutions",
    "dataset": "judged",
    **{name: name for name in ("motion", "tolerate", "exposure", "reproduce", "boards", "ports")},
    **{name: name for name in ("presets", "solvers")},
}


#: Items of warnings about lengths that are probably in another unit.
LENGTHS = re.compile(r"array\.(positions|grid\.pitch)|points\[\d+\]\.position")

app = App(
    name="midair",
    help="Drives for airborne ultrasound phased arrays: the pressure at given points is what you request.",
    version=version,
    # Markdown help would import a parser and a syntax highlighter.
    help_format="plaintext",
    # `main` itself reports an interruption.
    suppress_keyboard_interrupt=False,
)
for name, (home, line) in COMMANDS.items():
    app.command(f"{__package__}.{home}:{name}_command", name=name, help=line)


def explain(*names: str) -> None:
    """Use the docstrings of commands' functions as their help, and name arguments that may be left out."""
    for name in names:
        app[name].help = None
        each = signature(cast(Any, app[name].default_command)).parameters.values()
        spare = [one.name for one in each if one.kind is one.POSITIONAL_OR_KEYWORD and one.default is not one.empty]
        if spare:
            app[name].usage = f"Usage: midair {name} [OPTIONS] [{spare[0].upper()}]"


def columns(command: str) -> str:
    """Return the meanings of a command's table columns, one per line."""
    meanings = text.meanings(TABLES[command])
    width = max(map(len, meanings)) + 2
    rows = [
        fill(f"{head:{width}}{meaning}", get_terminal_size().columns - 1, subsequent_indent=" " * width)
        for head, meaning in meanings.items()
    ]
    return "\n".join(["Columns of the table:", *rows])


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit with its status (docs/files.md)."""
    prepare()
    warnings.simplefilter("always", SceneWarning)
    warned = set()
    doubted = False

    def warn(message: Warning | str, *_: object, **__: object) -> None:
        nonlocal doubted
        doubted |= bool(LENGTHS.match(getattr(message, "item", "")))
        # Several solvers may give the same warning; it is printed once.
        if str(message) not in warned:
            warned.add(str(message))
            tell(f"warning: {message}")

    warnings.showwarning = warn
    # matplotlib's messages about its cache and fonts need no action by the user.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    # The parser would read a hyphen alone as an option; here it means standard input or output.
    typed = sys.argv[1:] if arguments is None else arguments
    status = _run(["./-" if word == "-" else word for word in typed])
    status = DOUBTED if doubted and not status else status
    try:
        sys.stdout.flush()
    except OSError:
        abandon()
    leave(status)


def usage(arguments: Sequence[str]) -> str:
    """Return the command that prints the help for a command line."""
    commands = [word for word in arguments[:1] if word in app]
    return " ".join(["midair", *commands, "--help"])


def missing(error: MissingArgumentError) -> str:
    """Return a message about the argument that a command line lacks, or about an option without its value."""
    argument = error.argument
    assert argument is not None
    typed = error.keyword or next((token.keyword for token in argument.tokens if token.keyword), None)
    if typed:
        return f"{typed} has no value: write one after it"
    if argument.name == "--on":
        return "--on is left out: say which board, as in --on sonicsurface:loop; midair boards lists them"
    is_option = not argument.field_info.is_positional
    return f"{argument.name if is_option else argument.name.lstrip('-').upper()} is left out"


def _run(arguments: Sequence[str]) -> int:
    try:
        with terminable():
            explain(*(word for word in arguments[:1] if word in COMMANDS))
            for word in arguments[:1]:
                if word in TABLES and {"--help", "-h"} & {*arguments}:
                    app[word].help_epilogue = columns(word)
            status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
            sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except BrokenPipeError:
        return UNREAD
    except SystemExit as left:
        # Rich ends with status 1 if no program reads its text.
        if left.code == 1:
            return UNREAD
        raise
    except UnusedCliTokensError as error:
        unused = " ".join(error.unused_tokens or ())
        cure = "leave it out, or write the numbers of an option without spaces, as in --at 0,0,0.15"
        tell(f'error: "{one_line(unused)}" belongs to no option: {cure}. See {usage(arguments)}')
        return REFUSED
    except MissingArgumentError as error:
        tell(f"error: {missing(error)}. See {usage(arguments)}")
        return REFUSED
    except CycloptsError as error:
        tell(f"error: {one_line(error)} See {usage(arguments)}")
        return REFUSED
    except (SceneError, OSError) as error:
        tell(f"error: {one_line(error)}")
        return REFUSED
    except MemoryError as error:
        tell(f"error: {one_line(error) or 'memory ran out: request less at once'}")
        return REFUSED
    except Terminated as stop:
        tell("terminated")
        return 128 + stop.number
    except KeyboardInterrupt:
        tell("interrupted")
        return INTERRUPTED
    except BaseException as error:
        from .. import BoardError

        if isinstance(error, BoardError):
            tell(f"error: {one_line(error)}")
            return REFUSED
        # A panic of the core is not a subclass of Exception.
        tell(f"error: {fault(error)}")
        return FAULT
