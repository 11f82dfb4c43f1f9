"""Limit: places, an ear above all, at which no frame may be louder than a pressure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, field
from .._points.ear import Ear
from .._support.arguments import refused, shown
from .errors import BoardError


class Limit:
    """Refuses drives that are too loud somewhere.

    given : {"positions": (K, 3) in m or a midair.Ear, "pressure": peak |p| in Pa, one or (K,)}; what else it
        holds is for `midair.Scene`: temperature, sound_speed, ...
    array : that plays
    """

    def __init__(self, given: Any, array: Array) -> None:
        form = (
            'give {"positions": [[x, y, z]], "pressure": 200}, positions in m or an ear, the pressure in Pa'
        )
        if not isinstance(given, Mapping) or not {"positions", "pressure"} <= given.keys():
            raise refused("limit", given, form)
        more = {**given}
        positions, pressure = more.pop("positions"), more.pop("pressure")
        try:
            points = positions.points if isinstance(positions, Ear) else np.atleast_2d(positions)
            self._scene = Scene(array, points, **more)
            most = np.asarray(pressure)
            if most.dtype.kind not in "iuf":
                raise TypeError(f"pressure is {shown(pressure)}")
            # What its giver makes of it later does not matter.
            self._most = np.array(np.broadcast_to(most, len(self._scene.points)), np.float64)
            self._most.flags.writeable = False
        except TypeError as error:
            raise refused("limit", given, f"{error}; {form}") from error
        except ValueError as error:
            raise refused("limit", given, str(error)) from error
        if not (np.isfinite(self._most) & (self._most >= 0)).all():
            raise refused('limit["pressure"]', pressure, "give pressures of at least 0 Pa")

    def check(self, drive: NDArray[np.complex64]) -> None:
        """Raise BoardError where the drive's |p| is above the limit, naming the place that is worst."""
        pressures = np.abs(field(self._scene, drive, self._scene.points).pressure)
        above = pressures - self._most
        worst = int(np.argmax(above))
        if not above[worst] <= 0:
            place = ", ".join(f"{x:.4g}" for x in self._scene.points[worst])
            raise BoardError(
                f"limit at ({place}) m is {self._most[worst]:.4g} Pa, this drive makes "
                f"{pressures[worst]:.4g} Pa: ask for less, or for a quiet point there"
            )
