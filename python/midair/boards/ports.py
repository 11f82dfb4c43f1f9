"""`midair.ports`: the serial ports of this computer, none of which is opened."""

from __future__ import annotations

from dataclasses import dataclass

from .errors import BoardError


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
