"""`midair off`: silence on a board that some program left playing."""

from __future__ import annotations

from .. import SceneError, connect
from .tables import console

#: What an address begins with where it is a port alone.
BOARD = "sonicsurface"


def off_command(address: str) -> int:
    """Turn a board off.

    Parameters
    ----------
    address
        A board and where it is, such as mega64:/dev/ttyACM0; a port alone is a SonicSurface's.
    """
    alone = ":" not in address and address not in ("autd3", "null")
    if address.startswith("file:"):
        raise SceneError(f'address is "{address}": a file plays nothing, give a board')
    # Whoever connects begins and ends with silence.
    with connect(f"{BOARD}:{address}" if alone else address) as board:
        board.off()
    told = f"{board.board.name} at {address} is off"
    cure = f"; it was told so as a {BOARD}, other boards take midair off BOARD:{address}" if alone else ""
    console.print(told + cure, markup=False, highlight=False, soft_wrap=True)
    return 0
