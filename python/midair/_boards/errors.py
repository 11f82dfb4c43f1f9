"""Errors of boards and their links. Each message is one line with the item, its value and the cure."""


class BoardError(Exception):
    """Failure of a board or of the link to it.

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
    """Missing port or device.

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
    """Port or device that another program uses.

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
    """Port or device that the user may not open.

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
    """Device or guard that is gone: unplugged, rebooted or ended.

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
    """Device that did not accept bytes in time.

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
    """Return the name and the text of another library's error, in one line."""
    return ": ".join(filter(None, (type(error).__name__, " ".join(str(error).split()))))


def reason(error: Exception) -> str:
    """Return the system's text of an error, in one line."""
    return " ".join(str(getattr(error, "strerror", None) or error).split()) or type(error).__name__


def gone(what: str, error: Exception) -> BoardLost:
    """Return the error about a device that does not answer any more."""
    return BoardLost(
        f"{what} is gone ({reason(error)}): the board plays on, switch its supply off, "
        "then plug it in and connect again"
    )


#: Error classes by name: the guard process sends the name, its owner raises the error.
KINDS: dict[str, type[BoardError]] = {
    kind.__name__: kind for kind in (BoardError, BoardNotFound, BoardBusy, BoardPermission, BoardLost, BoardTimeout)
}
