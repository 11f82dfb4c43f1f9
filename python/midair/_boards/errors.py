"""Errors of links to boards: each is one line with item, value and cure."""

from __future__ import annotations


class BoardError(Exception):
    """A board cannot do what a call requests, or the link to it does not work."""


class BoardNotFound(BoardError):
    """There is no such port or device."""


class BoardBusy(BoardError):
    """Another program uses the port or device."""


class BoardPermission(BoardError):
    """The user may not open the port or device."""


class BoardLost(BoardError):
    """The device or its guard is gone: unplugged, rebooted or ended."""


class BoardTimeout(BoardError):
    """The device did not accept bytes in time."""


def named(error: BaseException) -> str:
    """Text of a library's error, with its name."""
    return ": ".join(filter(None, (type(error).__name__, " ".join(str(error).split()))))


#: Errors by the name under which the guard process reports them to its owner.
KINDS: dict[str, type[BoardError]] = {
    kind.__name__: kind
    for kind in (BoardError, BoardNotFound, BoardBusy, BoardPermission, BoardLost, BoardTimeout)
}
