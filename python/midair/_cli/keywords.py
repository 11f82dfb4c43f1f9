"""Keywords of commands: those that several commands have, and those of a function of the library."""

from collections.abc import Callable
from functools import wraps
from inspect import Parameter as Argument, signature, unwrap
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast, get_type_hints

from cyclopts import Parameter
from docstring_parser import parse

Command = TypeVar("Command", bound=Callable[..., int])

Json = Annotated[
    bool, Parameter(negative=(), help="Print one JSON document instead of the table.", show_default=False)
]
OutputFile = Annotated[Path | None, Parameter(name=["--output", "-o"])]
#: Numbers with commas, which may begin with a minus.
Numbers = Annotated[str | None, Parameter(allow_leading_hyphen=True)]
#: An option that may be given several times, each time with numbers.
Places = Annotated[list[str] | None, Parameter(allow_leading_hyphen=True, negative=())]
SceneName = Annotated[Path, Parameter(help="Scene file, TOML or JSON, or - for standard input.")]
SolverName = Annotated[
    str | None, Parameter(help="Name of the solver; by default the scene file's, else uniform.")
]


def of(function: Callable[..., Any], names: str) -> Callable[[Command], Command]:
    """Give a command some keywords of a library's function, with its types, defaults and explanations.

    The command takes them as its last argument, `**keywords`. In its help they come before its own keywords.
    """
    taken, hints = signature(function).parameters, get_type_hints(unwrap(function))
    explained = {
        name: entry.description
        for entry in parse(function.__doc__ or "").params
        for name in entry.arg_name.split(", ")
    }

    def give(command: Command) -> Command:
        @wraps(command)
        def full(*arguments: Any, **keywords: Any) -> int:
            # The parser passes only what was typed.
            return command(*arguments, **{name: taken[name].default for name in names.split()} | keywords)

        own = [
            each for each in signature(command).parameters.values() if each.kind is not Argument.VAR_KEYWORD
        ]
        places = [each for each in own if each.kind is not Argument.KEYWORD_ONLY]
        given = [
            taken[name].replace(annotation=Annotated[hints[name], Parameter(help=explained[name])])
            for name in names.split()
        ]
        parameters = [*places, *given, *own[len(places) :]]
        cast(Any, full).__signature__ = signature(command).replace(parameters=parameters)
        return cast(Command, full)

    return give
