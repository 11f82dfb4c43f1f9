"""Checks of drives before they are sent: loudness at given places, real numbers, arrays, rates, jumps."""

import math
import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Scene, SceneError, Solution, field, numbers
from .._points.ear import Ear
from .._sequence import Sequence
from .._support.arguments import is_array, refused, warn
from .board import Board
from .errors import BoardError, BoardTimeout
from .wire import Late

#: Relative tolerance for rounding in bounds and rates.
ROUNDING = 1e-6


class Limit:
    """Rejects drives whose pressure is too high at given places.

    Parameters
    ----------
    given
        {"positions": (K, 3) in m or a midair.Ear, "pressure": peak |p| in Pa, one or (K,)}. Other entries are
        arguments of `midair.Scene`: temperature, sound_speed, ...
    array
        The array that plays.
    """

    def __init__(self, given: Any, array: Array) -> None:
        form = 'give {"positions": [[x, y, z]], "pressure": 200}, positions in m or an ear, the pressure in Pa'
        if not isinstance(given, Mapping) or not {"positions", "pressure"} <= given.keys():
            raise refused("limit", given, form)
        more = {**given}
        positions, pressure = more.pop("positions"), more.pop("pressure")
        if isinstance(positions, Ear):
            positions = positions.points
        places = numbers('limit["positions"]', positions, [(3,), (-1, 3)], "give (3,) or (M, 3) in m")
        count, cure = places.size // 3, "give the pressure in Pa, or one for each position"
        most = numbers('limit["pressure"]', pressure, [(), (1,), (count,)], cure, least=0)
        self._most = np.broadcast_to(most, count)
        try:
            self._scene = Scene(array, places.reshape(-1, 3), **more)
        except TypeError as error:
            raise refused("limit", given, f"{error}; {form}") from error
        except SceneError as error:
            raise refused("limit", given, str(error)) from error

    def check(self, drive: NDArray[np.complex64]) -> None:
        """Raise BoardError, which names the worst place, if |p| of a drive exceeds the limit."""
        pressures = np.abs(field(self._scene, drive, self._scene.points).pressure)
        above = pressures - self._most
        worst = int(np.argmax(above))
        if not above[worst] <= 0:
            place = ", ".join(f"{x:.4g}" for x in self._scene.points[worst])
            raise BoardError(
                f"limit at ({place}) m is {self._most[worst]:.4g} Pa, this drive makes "
                f"{pressures[worst]:.4g} Pa: request less, or a quiet point there"
            )


def refuse_real(drive: Any) -> None:
    """Reject real numbers, which may be phases or codes by mistake. Only -1, 0 and 1 are accepted."""
    cure = "give np.exp(1j * phases) of phases in rad, amplitudes + 0j where all phases are 0"
    given = numbers("drive", drive, None, cure, kinds="iufc", copy=False)
    if given.dtype.kind != "c" and not np.isin(given, (-1, 0, 1)).all():
        raise refused("drive", given, f"real numbers are no drive: {cure}")


def given_drives(board: Board, given: Any) -> Iterator[ArrayLike | Solution]:
    """Yield the drives of a stream: of a sequence, an array (T, N) or any iterable. Rejects other values."""
    if isinstance(given, Sequence):
        fit = board._fit(given.array, given.scene(0).frequency)
        return (fit(given.drive(frame)) for frame in range(len(given)))
    if is_array(given):
        count = len(board.array)
        given = numbers("drives", given, [(-1, count)], f"give (T, {count})", kinds="iufc", copy=False)
    try:
        return iter(given)
    except TypeError:
        cure = "give (T, N), a midair.Sequence or a generator of drives"
        raise refused("drives", given, cure) from None


def timed(drives: Iterator[ArrayLike | Solution]) -> Iterator[tuple[float, ArrayLike | Solution]]:
    """Yield each drive together with the time at which the caller requested it."""
    requested = time.monotonic()
    for drive in drives:
        yield requested, drive
        requested = time.monotonic()


def warn_of_scale(scale: float) -> None:
    """Warn that the board plays louder than requested, because it cannot play so softly."""
    warn(
        f"the board plays {1 / scale:.3g} times the requested pressures, "
        f"{-20 * math.log10(scale):.3g} dB more: turn its supply or modulation down to {scale:.3g}, "
        "or ask for more"
    )


def check_rate(rate: float, board: Board, late: Late) -> None:
    """Reject a rate above the board's if no frame may be late; else warn of dropped or weaker frames."""
    if late == Late.ERROR and rate > board.rate * (1 + ROUNDING):
        raise BoardTimeout(
            f'rate is {rate:g} frames/s, {board.name} takes {board.rate:.4g}: give a lower one, or late="skip"'
        )
    steady = board.limits["steady_frames_per_second"]
    if rate > steady * (1 + ROUNDING) and steady < board.rate:
        warn(
            f"rate is {rate:g} frames/s: bytes stop the pins of {board.name}, which emits less above "
            f"{steady:.3g} frames/s, half of the amplitude at its full rate (docs/boards.md)"
        )
    if late == Late.SKIP and rate > board.rate * (1 + ROUNDING):
        warn(
            f"rate is {rate:g} frames/s, {board.name} takes {board.rate:.4g}: {1 - board.rate / rate:.0%} "
            f'of the frames are left out; solve for at most {math.floor(board.rate)}, or give late="wait"'
        )


def warn_of_seam(sequence: Sequence) -> None:
    """Warn if a phase changes by more than the sequence's bound from the last frame to the first."""
    drives = [sequence.drive(frame) for frame in (0, len(sequence) - 1)]
    jump = float(np.abs(np.angle(drives[0] * drives[1].conj())).max())
    bound = 0.0 if sequence.change is None else sequence.change
    if jump > bound * (1 + ROUNDING) and (sequence.change is not None or not sequence.closed):
        warn(
            f"sequence begins anew with a jump of {jump:.3g} rad each time: solve a closed path with "
            'ahead="all", or use stream'
        )
