"""Boards: conversion of drives to the bytes of each kind of board, and the links that carry these bytes."""

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
