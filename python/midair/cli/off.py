"""`midair off`: silence on a board that some program left playing."""

from __future__ import annotations

from .. import Array, SceneError, connect
from ..boards.address import LINKS, PAIR
from .tables import console

#: Boards of 64 in a chain.
MOST_MEGA64 = 14

#: What an address begins with where it is a port alone.
BOARD = "sonicsurface"


def off_command(address: str) -> int:
    """Turn a board off.

    Parameters
    ----------
    address
        A board and where it is, such as mega64:/dev/ttyACM0; a port alone is a SonicSurface's.
    """
    alone = address.partition(":")[0].removesuffix(PAIR) not in (*LINKS, "null")
    if address.startswith("file:"):
        raise SceneError(f'address is "{address}": a file plays nothing, give a board')
    # Whoever connects begins and ends with silence.
    whole = f"{BOARD}:{address}" if alone else address
    # Whatever the length of its chain.
    array = Array.grid(64, MOST_MEGA64, 10e-3) if whole.startswith("mega64:") else None
    with connect(whole, array=array) as board:
        board.off()
    told = f"{board.board.name} at {address} is off"
    cure = f"; it was told so as a {BOARD}, other boards take midair off BOARD:{address}" if alone else ""
    console.print(told + cure, markup=False, highlight=False, soft_wrap=True)
    return 0
