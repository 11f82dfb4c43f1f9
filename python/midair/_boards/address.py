"""Addresses and ports: which board, by which link, where; and what the guard's transport is made of."""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

from .._support.arguments import refused, word
from .board import Board
from .errors import BoardError


@dataclass(frozen=True)
class Link:
    """How a board is reached.

    kind : of transport, a key of TRANSPORTS
    where : what an address says behind the colon
    swap : hexadecimal, the byte by which it plays its other bank, if it has one
    restarts : whether opening its port may restart it
    """

    kind: str
    where: str
    swap: str | None = None
    restarts: bool = False


#: The boards that an address may name.
LINKS = {
    "autd3": Link("autd3", "INTERFACE"),
    "sonicsurface": Link("serial", "PORT", swap="fd"),
    "openmpd": Link("fifo", "SERIAL+SERIAL"),
    "mega64": Link("serial", "PORT", restarts=True),
    "nano16": Link("serial", "PORT", restarts=True),
    "nano": Link("serial", "PORT", restarts=True),
    "homies": Link("fifo", "SERIAL"),
}

#: Boards that play a sequence by themselves, and those that modulate.
HOLDS_SEQUENCE = ("autd3",)
MODULATES = ("autd3", "sonicsurface")

#: The board whose lines are the interfaces of one FTDI chip.
ONE_CHIP = "homies"

#: What a link needs: the package's name, the name it is imported by, and the extra that brings it.
NEEDS = {
    "serial": ("pyserial", "serial", "serial"),
    "fifo": ("pyftdi", "pyftdi", "ftdi"),
    "autd3": ("autd3", "autd3", "autd3"),
}

#: What the preset of two boards of a kind ends in.
PAIR = "_pair"

#: The board of an address that names none.
DEFAULT = "autd3"


@dataclass(frozen=True)
class Address:
    """A board's name or None, the kind of its link, and where it is."""

    board: str | None
    kind: str
    where: str

    @property
    def kind_of_board(self) -> str | None:
        """The board's kind, by which links are known: a pair is of the kind of its boards."""
        return None if self.board is None else self.board.removesuffix(PAIR)


def parse(address: Any) -> Address:
    """Read an address: a board's name and where it is, "null", or "file:" and a path."""
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
    if kind not in LINKS:
        known = ", ".join(("null", "file:PATH", "autd3", *_examples()))
        raise refused("address", text, f"there is no such board, give one of {known}")
    if where in ("null", "loop"):
        return Address(name, where, "")
    if not where and name != "autd3":
        raise refused("address", text, f"it names no place, give {name}:{LINKS[kind].where} or {name}:loop")
    if kind == "openmpd" and "+" in where:
        name = kind + PAIR
    return Address(name, LINKS[kind].kind, where)


def can_modulate(board: str) -> None:
    """Refuse a kind of board that does not modulate."""
    if board not in MODULATES:
        raise BoardError(
            f"{board} cannot modulate: stream drives of changing amplitude, or take {' or '.join(MODULATES)}"
        )


def describe(address: Address, board: Board) -> dict[str, Any]:
    """What `open_transport` makes the transport of, as JSON holds it."""
    silence, off = board.silence.hex(), board.off_frame.hex()
    link = LINKS[board.name]
    if address.kind == "null":
        return {"kind": "null"}
    if address.kind == "file":
        return {"kind": "file", "path": address.where, "off": off}
    if address.kind == "loop":
        baud = board.baud or round(10 * len(board.off_frame) * board.rate)
        return {"kind": "loop", "baud": baud, "silence": silence, "off": off, "swap": link.swap}
    package, module, extra = NEEDS[address.kind]
    if find_spec(module) is None:
        raise BoardError(f'{board.name} needs {package}: pip install "midair[{extra}]"')
    if address.kind == "serial":
        line = {"baud": board.baud, "silence": silence, "off": off, "swap": link.swap}
        return {"kind": "serial", "port": address.where, "restarts": link.restarts, **line}
    if address.kind == "fifo":
        length = len(board.off_frame)
        return {"kind": "fifo", "places": _places(address, board), "length": length, "silence": silence}
    from .poses import poses

    where = f"autd3:{address.where}" if address.where else "autd3"
    return {"kind": "autd3", "address": where, "poses": poses(board.array)}


def _places(address: Address, board: Board) -> list[tuple[str, int]]:
    """The serial number and interface of each line: a chip each, or those of one chip."""
    serials = address.where.split("+")
    if serials[0] and len(serials) == 1 and board.name == ONE_CHIP:
        # Its first FPGA is on the chip's channel B, which is interface 2.
        return [(serials[0], 2 - line) for line in range(board.lines)]
    if len(serials) != board.lines or not all(serials):
        raise refused("address", f"{address.board}:{address.where}", f"give {board.lines} serial numbers")
    return [(serial, 1) for serial in serials]


def _examples() -> list[str]:
    return [f"{name}:{link.where}" for name, link in LINKS.items()]


@dataclass(frozen=True)
class Port:
    """A serial port.

    name : for an address, as "/dev/ttyUSB0"
    description : what the system calls it
    maker, serial_number : of its USB adapter, None where it has none
    """

    name: str
    description: str
    maker: str | None
    serial_number: str | None


def ports() -> list[Port]:
    """The serial ports, by name. None is opened, and none tells which board it leads to."""
    try:
        from serial.tools.list_ports import comports
    except ImportError as error:
        raise BoardError('ports needs pyserial: pip install "midair[serial]"') from error
    found = (
        Port(port.device, port.description, port.manufacturer, port.serial_number) for port in comports()
    )
    return sorted(found, key=lambda port: port.name)
