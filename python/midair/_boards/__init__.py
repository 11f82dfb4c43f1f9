"""Boards: the bytes that make them play, and the links that carry these."""

from .address import Port, ports
from .board import Board
from .connection import Connection, connect
from .errors import BoardBusy, BoardError, BoardLost, BoardNotFound, BoardPermission, BoardTimeout

__all__ = [
    "Board",
    "BoardBusy",
    "BoardError",
    "BoardLost",
    "BoardNotFound",
    "BoardPermission",
    "BoardTimeout",
    "Connection",
    "Port",
    "connect",
    "ports",
]
