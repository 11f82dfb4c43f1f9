"""`midair presets`: the list of arrays known by name."""

from __future__ import annotations

from rich import box
from rich.table import Table

from .. import presets
from .tables import console


def presets_command() -> int:
    """List the arrays known by name."""
    table = Table("preset", "transducers", "tiles", "P0 / Pa m", "what it is", "source", box=box.SIMPLE_HEAD)
    for name, info in presets().items():
        tiles = "yes" if info.tiles else "no"
        table.add_row(
            f"[bold]{name}[/bold]",
            str(info.count),
            tiles,
            f"{info.source_pressure:g}",
            info.summary,
            info.source,
        )
    console.print(table)
    return 0
