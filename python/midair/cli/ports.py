"""`midair ports`: the serial ports of this computer."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

from cyclopts import Parameter
from rich import box
from rich.markup import escape
from rich.table import Table

from .. import output, ports
from .tables import console


def ports_command(*, json: Annotated[bool, Parameter(negative=())] = False) -> int:
    """List the serial ports. None is opened, and none tells which board it leads to.

    Parameters
    ----------
    json
        Print one JSON document in place of the table.
    """
    found = ports()
    if json:
        print(output.to_json([asdict(port) for port in found]))
        return 0
    if not found:
        console.print("no serial port: plug the board's adapter in")
        return 0
    table = Table("port", "what the system calls it", "maker", "serial number", box=box.SIMPLE_HEAD)
    for port in found:
        cells = (port.name, port.description, port.maker or "-", port.serial_number or "-")
        # What a maker wrote is no markup.
        table.add_row(*map(escape, cells))
    console.print(table)
    return 0
