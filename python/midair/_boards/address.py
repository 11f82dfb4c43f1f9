"""Parses the address of a board, finds serial ports, and describes the guard process's transport."""

import math
import os
import re
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np

from .._midair import Array, Codec, SceneError, nearest, numbers, restated
from .._support.arguments import is_array, needs, number, refused, word
from .board import Board
from .errors import BoardError, reason

#: Kinds of boards that an address can name.
KINDS = Codec.kinds()

#: Python package that each kind of link needs: its name to install, its name to import, and the extra of
#: midair that installs it.
NEEDS = {"serial": ("pyserial", "serial", "serial"), "fifo": ("pyftdi", "pyftdi", "ftdi")}

#: Suffix of the names of presets that contain two boards, as in "sonicsurface_pair".
PAIR = "_pair"

#: Kind of board that the addresses "null" and "file:PATH" simulate, since they name no board.
DEFAULT = "autd3"


class Address(NamedTuple):
    """A parsed address: the board's name (or None), the kind of its link, and the rest: a port or path."""

    board: str | None
    kind: str
    where: str

    @property
    def kind_of_board(self) -> str | None:
        """The board's name without "_pair": the links treat a pair as two boards of one kind."""
        return None if self.board is None else self.board.removesuffix(PAIR)


def parse(address: Any) -> Address:
    """Parse an address: a board's name and its port, "null", or "file:" and a path."""
    text = word("address", address)
    name, _, where = text.partition(":")
    if name == "null" and not where:
        return Address(None, "null", "")
    if name == "file":
        if not where:
            raise refused("address", text, "give file:PATH")
        if not where.lower().endswith(".bin"):
            raise refused("address", text, "a file of frames is written over, give one that ends in .bin")
        return Address(None, "file", os.path.abspath(where))
    kind = name.removesuffix(PAIR)
    if kind not in KINDS:
        if re.match(r"/dev/|COM\d", text):
            raise refused("address", text, f"write the board before its port, as in sonicsurface:{text}")
        meant = "mega64, nano16 or nano" if kind in ("ultraino", "arduino") else nearest(kind, list(KINDS))
        hint = f"did you mean {meant}? " if meant else ""
        known = ", ".join(("null", "file:PATH", "autd3", *(f"{kind}:{_place(kind)}" for kind in KINDS)))
        raise refused("address", text, f"there is no such board, {hint}give one of {known}")
    if where in ("null", "loop"):
        return Address(name, where, "")
    if not where and name != "autd3":
        cure = f"give {name}:{_place(kind)} or {name}:loop"
        raise refused("address", text, f"the place of the board is left out, {cure}")
    link = KINDS[kind].link
    if link["kind"] == "fifo" and not link["one_chip"] and "+" in where:
        name = kind + PAIR
    return Address(name, link["kind"], where)


def board_at(place: Address, array: Array | None = None) -> Board:
    """Return the board of an address, for an array; addresses that name none simulate DEFAULT."""
    try:
        return Board(place.board or DEFAULT, array)
    except SceneError as error:
        words = f"{place.kind} plays an {DEFAULT}, name another board as in sonicsurface:loop"
        raise error if place.board else restated(error, place=words) from None


def can_modulate(board: str) -> None:
    """Raise BoardError if boards of this kind cannot modulate."""
    if not KINDS[board].link["modulates"]:
        others = " or ".join(name for name, kind in KINDS.items() if kind.link["modulates"])
        raise BoardError(f"{board} cannot modulate: stream drives of changing amplitude, or take {others}")


def modulation(board: str, given: Any) -> tuple[float, bytes]:
    """Check a modulation; return (Hz, no codes) for a frequency, or (NaN, codes of 0 to 255) for samples."""
    if not isinstance(given, list | tuple) and not is_array(given):
        frequency = number("hz", given, above=0)
        can_modulate(board)
        return frequency, b""
    can_modulate(board)
    if not KINDS[board].link["holds_sequence"]:
        raise BoardError(f"{board} holds no samples: give a frequency in Hz")
    samples = numbers("hz", given, [(-1,)], "give samples (S,) from 0 to 1", least=0, most=1)
    return math.nan, np.rint(255 * samples).astype(np.uint8).tobytes()


def describe(address: Address, board: Board) -> dict[str, Any]:
    """Return the JSON description of the transport that `open_transport` reads in the guard process."""
    silence, off = board.silence.hex(), board.off_frame.hex()
    swap = board.link["swap"]
    if address.kind == "null":
        return {"kind": "null"}
    if address.kind == "file":
        return {"kind": "file", "path": address.where, "off": off}
    if address.kind == "loop":
        baud = board.baud or round(10 * len(board.off_frame) * board.rate)
        return {"kind": "loop", "baud": baud, "silence": silence, "off": off, "swap": swap}
    if address.kind == "udp":
        where = f"autd3:{address.where}" if address.where else "autd3"
        return {"kind": "udp", "address": where, "boards": board.boards}
    package, module, extra = NEEDS[address.kind]
    if find_spec(module) is None:
        raise BoardError(f'{board.name} needs {package}: pip install "midair[{extra}]"')
    if address.kind == "serial":
        line = {"baud": board.baud, "silence": silence, "off": off, "swap": swap}
        return {"kind": "serial", "port": address.where, "restarts": board.link["restarts"], **line}
    length = len(board.off_frame)
    return {"kind": "fifo", "places": _places(address, board), "length": length, "silence": silence}


def _places(address: Address, board: Board) -> list[tuple[str, int]]:
    """Return (serial number of the chip, interface) of each line. A chip may have both lines of a pair."""
    serials = address.where.split("+")
    if serials[0] and len(serials) == 1 and board.link["one_chip"]:
        # One chip serves the FPGAs of both lines. The first FPGA is connected to the chip's channel B, which
        # USB numbers as interface 2.
        return [(serials[0], 2 - line) for line in range(board.lines)]
    if len(serials) != board.lines or not all(serials):
        raise refused("address", f"{address.board}:{address.where}", f"give {board.lines} serial numbers")
    return [(serial, 1) for serial in serials]


def _place(kind: str) -> str:
    """Return a placeholder for the part of an address after the colon, for error messages."""
    link, most = KINDS[kind].link, KINDS[kind].most_boards
    if link["kind"] == "fifo":
        return "SERIAL" if link["one_chip"] else "+".join(["SERIAL"] * most)
    return "PORT" if link["kind"] == "serial" else "INTERFACE"


#: Boards that may be connected through a USB adapter, by its vendor and product numbers. Product None: any
#: product.
ADAPTERS: dict[tuple[int | None, int | None], str] = {
    (0x2341, None): "an Arduino: mega64, nano16, nano",
    (0x2A03, None): "an Arduino: mega64, nano16, nano",
    (0x1A86, 0x7523): "a CH340: an Arduino's copy, or sonicsurface",
    (0x0403, 0x6001): "an FTDI chip: sonicsurface, nano; openmpd on an FT245",
    (0x0403, 0x6010): "an FT2232H: homies",
    (0x0403, 0x6014): "an FT232H: openmpd",
}


@dataclass(frozen=True)
class Port:
    """Serial port; from `midair.ports`.

    Attributes
    ----------
    name : str
        Name as in an address, such as "/dev/ttyUSB0".
    description : str
        The operating system's name of the port.
    maker, serial_number : str or None
        Maker and serial number of its USB adapter; None if unknown.
    could_be : str
        Boards with such an adapter, by its USB numbers and its name; "" if unknown.

    Examples
    --------
    >>> import midair
    >>> midair.Port("/dev/ttyUSB0", "USB Serial", "FTDI", "A1", could_be="sonicsurface").name
    '/dev/ttyUSB0'
    """

    name: str
    description: str
    maker: str | None
    serial_number: str | None
    could_be: str = ""


def _could_be(vid: int | None, pid: int | None, product: str) -> str:
    # FTDI's serial adapters and FIFO chips can have equal USB numbers; only the product name tells them
    # apart.
    if "FT245" in product:
        return "an FT245: openmpd"
    return ADAPTERS.get((vid, pid)) or ADAPTERS.get((vid, None), "")


def ports() -> list[Port]:
    """List the serial ports, with the boards that their adapters could be. Opens none of them.

    Returns
    -------
    list of midair.Port
        The ports in the order of their names.

    Raises
    ------
    BoardError
        If pyserial is not installed (the extra `midair[serial]`), or the system does not list its ports.

    Examples
    --------
    >>> import midair
    >>> all(port.name for port in midair.ports())
    True
    """
    try:
        with needs("ports needs pyserial", "serial", BoardError):
            from serial.tools.list_ports import comports
        listed = comports()
    # AttributeError: Wine lacks functions of Windows that pyserial calls.
    except (AttributeError, OSError) as error:
        cure = "give the port's name from the device manager, as in sonicsurface:COM3"
        raise BoardError(f"this system does not list its serial ports ({reason(error)}): {cure}") from error
    found = (
        Port(
            port.device,
            port.description,
            port.manufacturer,
            port.serial_number,
            _could_be(port.vid, port.pid, port.product or ""),
        )
        for port in listed
    )
    return sorted(found, key=lambda port: port.name)
