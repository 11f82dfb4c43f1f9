"""`midair solvers`: the list of solvers with their options, or one of them in full."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import Parameter
from rich import box
from rich.table import Table

from .. import SolverInfo, output, solvers
from .._midair import solver_name
from .tables import console


def solvers_command(name: str | None = None, *, json: Annotated[bool, Parameter(negative=())] = False) -> int:
    """List the solvers with their options and defaults.

    Parameters
    ----------
    name
        A solver, for what is known of it alone.
    json
        Print one JSON document in place of the table.
    """
    known = solvers()
    if name is not None:
        known = {solver_name(name): known[solver_name(name)]}
    if json:
        print(output.to_json({name: _solver_record(info) for name, info in known.items()}))
        return 0
    table = Table("solver", "option", "default", "what it does", box=box.SIMPLE_HEAD)
    for listed, info in known.items():
        table.add_row(f"[bold]{listed}[/bold]", "", "", f"{info.summary} ({info.source})")
        for option, about in info.options.items():
            table.add_row("", option, str(about.default), about.doc)
        table.add_row(
            "", "phases", "used" if info.uses_phases else "not used", "Phases of complex pressures."
        )
        table.add_row(
            "", "balance", str(info.balance), "Solve at the balanced level, reduce the drives afterwards."
        )
    console.print(table)
    if name is not None:
        _print_uses(*known.items())
    return 0


def _print_uses(solver: tuple[str, SolverInfo]) -> None:
    """How its options are given, wherever they can be."""
    name, info = solver
    key, value = next(((key, about.default) for key, about in info.options.items()), ("balance", True))
    word = f'"{value}"' if isinstance(value, str) else str(value).lower()
    lines = {
        "command line": f"midair solve scene.toml --solver {name} --{key} {value}",
        "scene file": f'[solver] and under it name = "{name}", {key} = {word}',
        "Python": f'midair.solve(scene, "{name}", {key}={value!r})',
    }
    if info.options == {}:
        lines["command line"] = f"midair solve scene.toml --solver {name} --balance"
    for where, line in lines.items():
        console.print(f"  {where + ':':14}{line}", markup=False, highlight=False, soft_wrap=True)


def _solver_record(info: SolverInfo) -> dict[str, Any]:
    options = {name: {"default": about.default, "doc": about.doc} for name, about in info.options.items()}
    known = {"summary": info.summary, "source": info.source, "balance": info.balance}
    return {**known, "uses_phases": info.uses_phases, "options": options}
