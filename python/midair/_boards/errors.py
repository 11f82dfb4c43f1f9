"""Errors of links to boards: each is one line with item, value and cure."""

from __future__ import annotations


class BoardError(Exception):
    """Report that a board cannot do what a call requests, or that the link to it does not work.

    See Also
    --------
    BoardNotFound, BoardBusy, BoardPermission, BoardLost, BoardTimeout : the errors of this kind.

    Examples
    --------
    >>> import midair
    >>> try:
    ...     midair.connect("sonicsurface:/dev/no-such-port")
    ... except midair.BoardError as error:
    ...     print(type(error).__name__)
    BoardNotFound
    """


class BoardNotFound(BoardError):
    """Report that there is no such port or device.

    Examples
    --------
    >>> import midair
    >>> try:
    ...     midair.connect("sonicsurface:/dev/no-such-port")
    ... except midair.BoardNotFound:
    ...     print("connect the board, then try again")
    connect the board, then try again
    """


class BoardBusy(BoardError):
    """Report that another program uses the port or device.

    Examples
    --------
    >>> import midair
    >>> try:
    ...     raise midair.BoardBusy("port /dev/ttyUSB0 is in use: close the other program")
    ... except midair.BoardError as error:
    ...     print(error)
    port /dev/ttyUSB0 is in use: close the other program
    """


class BoardPermission(BoardError):
    """Report that the user may not open the port or device.

    Examples
    --------
    >>> import midair
    >>> try:
    ...     raise midair.BoardPermission("port /dev/ttyUSB0 is not yours: join the group dialout")
    ... except midair.BoardError as error:
    ...     print(error)
    port /dev/ttyUSB0 is not yours: join the group dialout
    """


class BoardLost(BoardError):
    """Report that the device or its guard is gone: unplugged, rebooted or ended.

    Examples
    --------
    >>> import midair
    >>> try:
    ...     raise midair.BoardLost("port is gone: connect it and call midair.connect again")
    ... except midair.BoardError as error:
    ...     print(error)
    port is gone: connect it and call midair.connect again
    """


class BoardTimeout(BoardError):
    """Report that the device did not accept bytes in time.

    Examples
    --------
    >>> import midair
    >>> with midair.connect("sonicsurface:loop") as surface:
    ...     try:
    ...         surface.stream([surface.emitting], rate=1e5, late="error")
    ...     except midair.BoardTimeout:
    ...         print("give a lower rate")
    give a lower rate
    """


def named(error: BaseException) -> str:
    """Text of a library's error, with its name."""
    return ": ".join(filter(None, (type(error).__name__, " ".join(str(error).split()))))


#: Errors by the name under which the guard process reports them to its owner.
KINDS: dict[str, type[BoardError]] = {
    kind.__name__: kind
    for kind in (BoardError, BoardNotFound, BoardBusy, BoardPermission, BoardLost, BoardTimeout)
}
