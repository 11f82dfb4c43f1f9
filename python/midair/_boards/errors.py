"""Errors of links to boards: each one line that names the item, its value and the cure."""

from __future__ import annotations


class BoardError(Exception):
    """A board cannot do what was asked, or the link to it does not work."""


class BoardNotFound(BoardError):
    """No such port or device is there."""


class BoardBusy(BoardError):
    """Another program holds the port or device."""


class BoardPermission(BoardError):
    """The user may not open the port or device."""


class BoardLost(BoardError):
    """The device or its guard is gone: unplugged, rebooted or ended."""


class BoardTimeout(BoardError):
    """The device did not take what was sent in time."""


def named(error: BaseException) -> str:
    """What an error of a library says, with its name."""
    return ": ".join(filter(None, (type(error).__name__, " ".join(str(error).split()))))


#: By the name under which the guard process tells its owner of one.
KINDS: dict[str, type[BoardError]] = {
    kind.__name__: kind
    for kind in (BoardError, BoardNotFound, BoardBusy, BoardPermission, BoardLost, BoardTimeout)
}
