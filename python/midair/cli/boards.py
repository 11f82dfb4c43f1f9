"""`midair boards`: the kinds of boards, or one of them in full."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import Parameter
from rich import box
from rich.table import Table

from .. import Board, output
from .._midair import Codec
from .tables import console


def boards_command(name: str | None = None, *, json: Annotated[bool, Parameter(negative=())] = False) -> int:
    """List the boards that can be played.

    Parameters
    ----------
    name
        A kind of board, or an array that one plays, for what is known of it alone.
    json
        Print one JSON document in place of the table.
    """
    names = list(Codec.kinds()) if name is None else [name]
    records = {name: _record(name) for name in names}
    if json:
        print(output.to_json(records))
    elif name is None:
        _print_list(records)
    else:
        _print_one(name, records[name])
    return 0


def _print_list(records: dict[str, dict[str, Any]]) -> None:
    columns = "board", "channels", "boards", "phases", "amplitudes", "bytes a frame", "frames/s", "what it is"
    table = Table(*columns, box=box.SIMPLE_HEAD)
    for name, record in records.items():
        table.add_row(
            f"[bold]{name}[/bold]",
            str(record["transducers"]),
            f"up to {record['most_boards']}" if record["most_boards"] > 1 else "1",
            str(record["phases"]),
            str(len(record["amplitudes"])),
            str(record["frame_bytes"]),
            f"{record['frames_per_second']:.4g}",
            record["summary"],
        )
    console.print(table)


def _print_one(name: str, record: dict[str, Any]) -> None:
    amplitudes = record["amplitudes"]
    shown = ", ".join(f"{amplitude:.3g}" for amplitude in amplitudes[:6])
    line = "no serial line" if record["baud"] is None else f"serial, {record['baud']} baud"
    lines = {
        "board": name,
        "what it is": record["summary"],
        "transducers": str(record["transducers"]),
        "boards": f"{record['boards']} of at most {record['most_boards']}",
        "phases": str(record["phases"]),
        "amplitudes": f"{len(amplitudes)}: {shown}{', ...' if len(amplitudes) > 6 else ''}",
        "line": line,
        "frame": f"{record['frame_bytes']} bytes, {record['frames_per_second']:.4g} a second",
        "source": record["source"],
        "Python": f'midair.Board("{name}")',
    }
    for what, text in lines.items():
        console.print(f"  {what + ':':14}{text}", markup=False, highlight=False, soft_wrap=True)


def _record(name: str) -> dict[str, Any]:
    board = Board(name)
    summary, source = Codec.kinds()[board.name]
    return {"summary": summary, "source": source, "baud": board.baud, **board.limits}
