"""Plays drives through the user's reader and keeps the best one; also the report of a board's faults."""

import platform
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._midair import numbers
from .._support import output
from .._support.arguments import path_of, sized
from .._support.text import counted

#: Ends of a tuning: complete, out of readings, stopped by Ctrl-C or progress, or ended by an error of the
#: reader.
Status = Literal["done", "out_of_readings", "stopped", "failed"]


@dataclass(frozen=True, eq=False)
class Tuning:
    """Best drive that `midair.tune` found, and its readings.

    Attributes
    ----------
    drive : (N,) ndarray of complex64
        The drive, |q| <= 1.
    pressures : (M,) ndarray
        |p| of this drive, as read or as three readings determine it.
    value : float
        Distance from the targets: the residual of eq. (7) relative to silence; feedback: 1 - uniformity.
    readings : int
        Number of readings.
    status : str
        "done", "stopped", "out_of_readings" or "failed".
    error : Exception or None
        The error that the reader raised.
    trace : ndarray
        The value after each step; in greedy, after each transducer.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> found = midair.tune(lambda drive: abs(scene.propagation() @ drive), scene, "feedback", steps=3)
    >>> found.status, found.readings
    ('done', 3)
    """

    drive: NDArray[np.complex64]
    pressures: NDArray[np.float64]
    value: float
    readings: int
    status: Status
    error: Exception | None
    trace: NDArray[np.float64]


Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]
Drive = NDArray[np.complex64]
Read = Callable[[Drive], Any]

#: If a microphone reads the same value after this many changes of the drive, it does not measure the sound.
CHANGES = 2


class Ended(Exception):
    """Raised if tuning ends early."""

    def __init__(self, status: Status) -> None:
        super().__init__(status)
        self.status = status


class Unreadable(Exception):
    """Raised if the reader has raised an error."""

    def __init__(self, error: Exception) -> None:
        super().__init__(str(error))
        self.error = error


class Player:
    """Reads |p| (M,) of drives (N,), at most `budget` times, and keeps the drive nearest to the targets.

    `value` returns the error of pressures (M,); `progress` is called with (readings, budget).
    """

    def __init__(
        self,
        read: Read,
        count: int,
        power: bool,
        value: Callable[[Real], float],
        budget: int,
        progress: Callable[[int, int], object],
    ) -> None:
        self._read, self._count, self._power = read, count, power
        self.value, self.budget, self._progress = value, budget, progress
        self.readings = 0
        self.best: tuple[float, Drive, Real] | None = None
        self.trace: list[float] = []
        self._last: Drive | None = None
        self._changes = 0
        self._quietest, self._loudest = np.full(count, np.inf), np.zeros(count)

    def __call__(self, drive: NDArray[Any]) -> Real:
        """Play a drive, and return |p| (M,) that the reader measures at the places."""
        if self.readings >= self.budget:
            raise Ended("out_of_readings")
        if self._progress(self.readings, self.budget) is False:
            raise Ended("stopped")
        played = drive.astype(np.complex64)
        played.flags.writeable = False
        try:
            given = self._read(played)
            found = self._checked(given)
        except Exception as error:
            raise Unreadable(error) from error
        self.readings += 1
        self._changes += self._last is not None and not np.array_equal(played, self._last)
        self._last = played
        self._quietest, self._loudest = np.minimum(found, self._quietest), np.maximum(found, self._loudest)
        self.offer(played, found)
        return found

    def offer(self, drive: NDArray[Any], pressures: Real) -> None:
        """Keep a drive if its pressures are nearer to the targets than the best so far."""
        value = self.value(pressures)
        if self.best is None or value < self.best[0]:
            kept = drive.astype(np.complex64)
            kept.flags.writeable = False
            self.best = (value, kept, pressures)

    def deaf(self) -> str | None:
        """Return a message about places that read 0 or the same in all readings; None if there are none."""
        same = (self._loudest == self._quietest) & ((self._loudest == 0) | (self._changes >= CHANGES))
        if not same.any():
            return None
        first, *others = np.flatnonzero(same)
        where = f"{first} and {len(others)} more" if others else f"{first}"
        return (
            f"read gave |p| = {self._loudest[first]:.4g} at place {where} in all {self.readings} readings: "
            "a dead microphone, mend it or leave its point out"
        )

    def _checked(self, given: Any) -> Real:
        cure = f"give {'|p|^2' if self._power else '|p|'} at {self._count} places, real numbers"
        shapes = [(self._count,), ()][: 2 if self._count == 1 else 1]
        found = np.atleast_1d(sized("read(drive)", numbers("read(drive)", given, shapes, cure, least=0)))
        return np.sqrt(found) if self._power else found


#: Formats of a report.
REPORTS = (".txt", ".json")


@dataclass(frozen=True)
class Fault:
    """Fault of a board; from `midair.doctor`.

    Attributes
    ----------
    kind : str
        "dead", "weak", "reversed", "phase", "swapped", "order", "board dead", "delay", "level",
        "sound speed", or "unexplained".
    where : tuple of int
        Indices of transducers; for a board's delay or level that board's number, from 0 on.
    size : float
        Gain or level relative to the usual one, phase or delay in degrees, sound speed in m/s.
    text : str
        The fault in one sentence.

    Examples
    --------
    >>> import midair
    >>> midair.Fault("dead", (17,), 0.0, "transducer 17 is silent").where
    (17,)
    """

    kind: str
    where: tuple[int, ...]
    size: float
    text: str


@dataclass(frozen=True, eq=False)
class Report:
    """Faults that `midair.doctor` found, and the measured numbers on which they are based.

    Attributes
    ----------
    board : str
        Kind of the board.
    faults : tuple of midair.Fault
        The faults; empty if nothing is wrong.
    notes : tuple of str
        Other remarks, a sentence each.
    response, response_error : (N,) ndarray
        Complex responses relative to those of the given array; errors of re and im.
    order : (N,) ndarray of int
        Place of the transducer that each channel drives.
    sound_speed, sound_speed_error : float
        Sound speed in m/s, and its error.
    noise : float
        Noise of a reading in Pa.
    readings : int
        Number of readings.
    seconds : float
        Time in s for which the board played.

    Examples
    --------
    >>> import midair
    >>> array, places = midair.Array.grid(4, 4, 10e-3), [[0.02, 0.03, 0.12], [-0.03, 0.01, 0.1]]
    >>> pressures = midair.Scene(array, places).propagation()
    >>> midair.doctor(array, lambda drive: abs(pressures @ drive), microphones=places).faults
    ()
    """

    board: str
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]
    response: NDArray[np.complex128]
    response_error: NDArray[np.float64]
    order: NDArray[np.intp]
    sound_speed: float
    sound_speed_error: float
    noise: float
    readings: int
    seconds: float

    @property
    def table(self) -> str:
        """The report as text: one line per fault, then the numbers and the notes."""
        width = max([len(fault.kind) for fault in self.faults], default=0)
        many = counted(len(self.faults), "fault") if self.faults else "no fault"
        lines = [f"{self.board}, {len(self.response)} transducers: {many} found"]
        lines += [f"  {fault.kind:{width}}  {fault.text}" for fault in self.faults]
        lines.append(
            f"{self.readings} readings, {self.seconds:.0f} s of the board; sound speed "
            f"{self.sound_speed:.1f} +- {self.sound_speed_error:.1g} m/s; noise {self.noise:.3g} Pa"
        )
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def write(self, path: str | PathLike[str]) -> None:
        """Write the table as .txt, or everything as .json, to be mailed.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        SceneError
            If the file's ending is unknown, or the path cannot be written.
        """
        target = path_of("path", path)
        output.check(target, REPORTS)
        if target.suffix.lower() == ".txt":
            text = f"{self.table}\nmidair {version('midair')}, {platform.platform()}\n"
        else:
            record = {**asdict(self), "midair": version("midair"), "system": platform.platform()}
            text = output.to_json(record) + "\n"
        output.write(target, text.encode())

    def __repr__(self) -> str:
        return f"<midair.Report of {self.board}: {len(self.faults)} faults>"
