"""`midair solvers`: the list of solvers with their options."""

from __future__ import annotations

from rich import box
from rich.table import Table

from .. import solvers
from .tables import console


def solvers_command() -> int:
    """List the solvers with their options and defaults."""
    table = Table("solver", "option", "default", "what it does", box=box.SIMPLE_HEAD)
    for name, info in solvers().items():
        table.add_row(f"[bold]{name}[/bold]", "", "", f"{info.summary} ({info.source})")
        for option, about in info.options.items():
            table.add_row("", option, str(about.default), about.doc)
        table.add_row(
            "", "balance", str(info.balance), "Solve at the balanced level, reduce the drives afterwards."
        )
    console.print(table)
    return 0
