"""`midair boards`: lists the kinds of boards, or describes one of them."""

from dataclasses import asdict
from typing import Any

from .. import Array, Board, connect, ports
from .._boards.address import KINDS, PAIR
from .._support import output
from .._support.arguments import refused
from .._support.text import counted
from .keywords import Json
from .tables import console, print_columns, print_facts, print_line, print_list

#: Longest chain of boards with 64 transducers.
MOST_MEGA64 = 14

#: Kind of board that is assumed for an address without one.
BOARD = "sonicsurface"


def off_command(address: str) -> int:
    """Turn a board off.

    Parameters
    ----------
    address
        A board and its place, such as mega64:/dev/ttyACM0; a port alone means a SonicSurface.
    """
    alone = address.partition(":")[0].removesuffix(PAIR) not in (*KINDS, "null")
    if address.startswith("file:"):
        raise refused("address", address, "a file plays nothing, give a board")
    # A connection turns the board off when it opens and when it closes.
    whole = f"{BOARD}:{address}" if alone else address
    # An array for the longest chain turns off chains of any length.
    array = Array.grid(64, MOST_MEGA64, 10e-3) if whole.startswith("mega64:") else None
    with connect(whole, array=array) as board:
        board.off()
    reported = f"{board.board.name} at {address} is off"
    cure = f"; it was taken for a {BOARD}; else use midair off BOARD:{address}" if alone else ""
    print_line(reported + cure)
    return 0


def ports_command(*, json: Json = False) -> int:
    """List the serial ports, and the boards that their adapters could be. Opens none of them."""
    found = ports()
    if json:
        print(output.to_json([asdict(port) for port in found]))
        return 0
    if not found:
        console.print("no serial port: plug the board's adapter in")
        return 0
    columns = {
        "port": [port.name for port in found],
        "what the system calls it": [port.description for port in found],
        "maker": [port.maker or "-" for port in found],
        "serial number": [port.serial_number or "-" for port in found],
        "could be": [port.could_be or "-" for port in found],
    }
    print_columns("ports", columns)
    opened = "none opened: midair play SCENE --on BOARD:PORT plays on one"
    print_line(f"{counted(len(found), 'serial port')}, {opened}")
    return 0


def boards_command(name: str | None = None, *, json: Json = False) -> int:
    """List the boards that can be played.

    Parameters
    ----------
    name
        A kind of board, or an array of one, to describe it alone.
    """
    names = list(KINDS) if name is None else [name]
    records = {name: _record(name) for name in names}
    if json:
        print(output.to_json(records))
    elif name is None:
        _print_list(records)
    else:
        _print_one(name, records[name])
    return 0


def _print_list(records: dict[str, dict[str, Any]]) -> None:
    known = records.values()
    columns = {
        "board": list(records),
        "channels": [str(record["transducers"]) for record in known],
        "phases": [str(record["phases"]) for record in known],
        "what it is": [record["summary"] for record in known],
    }
    print_list("boards", columns)


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
    print_facts(lines)


def _record(name: str) -> dict[str, Any]:
    board = Board(name)
    kind = KINDS[board.name]
    return {
        "summary": kind.summary,
        "source": kind.source,
        "link": board.link,
        "baud": board.baud,
        **board.limits,
    }
