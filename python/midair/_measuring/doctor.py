"""`midair.doctor`: decides by limits which transducers are dead, weak or reversed; its report."""

import platform
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._boards.board import Board
from .._boards.connection import Connection
from .._midair import Array, Scene, numbers
from .._support import output
from .._support.arguments import callback, flag, number, path_of, refused
from .._support.text import counted
from .calibrate import calibration_drives, places_of, readings_of
from .diagnosis import Diagnosis, Indices, diagnose

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


#: Readings per transducer, as real numbers: the usual number, and the least for a diagnosis.
PLENTY, LEAST = 4.0, 2.2
#: Time in s until the sound is steady after a new frame, and time in s of a reading.
SETTLE, LISTEN = 5e-3, 10e-3
#: A transducer is weak if its gain, relative to the board's usual gain, is below WEAK, and below 1 by SURELY
#: standard deviations. It is dead below DEAD_GAIN.
WEAK, DEAD_GAIN, SURELY = 0.75, 0.15, 4.0
#: Phase errors in degrees above which a transducer is faulty, and above which it is reversed.
ODD, REVERSED = 50.0, 130.0
#: Least errors that are reported: a board's delay in degrees, a level (relative), the sound speed in m/s.
LATE, LEVEL, SPEED = 20.0, 0.1, 1.5
#: Faults of a whole board are reported if they exceed this many standard deviations.
SURE = 4.0
#: A board with at least this fraction of dead transducers is reported as a dead board.
WHOLE = 0.9
#: A larger residual, relative to the readings' rms, is reported: the readings are probably of another array.
UNEXPLAINED = 0.35
#: A microphone further than this from its given place, in m, is mentioned in the notes.
APART = 3e-3


def doctor(
    board: Connection | Board | Array | str,
    read: Callable[[NDArray[np.complex64]], ArrayLike],
    *,
    microphones: ArrayLike,
    microphones_error: float | None = None,
    in_pascals: bool = True,
    boards: int | None = None,
    seconds: float = 60.0,
    settle: float = SETTLE,
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
    temperature: float | None = None,
    sound_speed: float | None = None,
) -> Report:
    """Find dead, weak, reversed and swapped transducers of a board, its order, delays and level, and the air.

    Parameters
    ----------
    board : midair.Connection, midair.Board, midair.Array or str
        A connection, on which the drives are played before each reading. Or a board, its name or an
        array, where `read` plays them itself.
    read : callable
        read(drive) returns p or |p| at the microphones (M,), peak, in Pa, of the drive (N,) that plays.
        Complex readings (e^{-jwt}, a clock shared with the board) show more.
    microphones : (M, 3) array_like
        Places in m, to some millimetres: the fit corrects them. One microphone sees no swap of transducers
        at nearly equal distances (modulo a wavelength): give two or more, off the array's axis.
    microphones_error : float, optional
        Error of each coordinate in m; by default it is fitted; 0 fixes the places.
    in_pascals : bool, optional
        False where the microphones' sensitivity is unknown; the level is then not judged.
    boards : int, optional
        Number of boards of an array, one after the other; not needed for a midair.Board.
    seconds : float, optional
        Longest time in s that the board plays; if it suffices, there are 4 readings per transducer.
    settle : float, optional
        Time in s from the start of a frame to its reading.
    seed : int, optional
        Seed of the drives.
    progress : callable, optional
        Called with (step, steps).
    temperature : float, optional
        Temperature of the air in degrees C; by default the array's.
    sound_speed : float, optional
        Sound speed of the air in m/s, instead of a temperature.

    Returns
    -------
    midair.Report
        The faults; `print` shows a table.

    Raises
    ------
    SceneError
        For wrong arguments and a time that is too short; also what `read` and the connection raise.

    See Also
    --------
    midair.calibrate : responses of the transducers.

    Notes
    -----
    All transducers play at random phases, as for `midair.calibrate`, which the diagnosis uses.
    docs/measuring.md lists what is found, and when.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.grid(8, 8, 10e-3)
    >>> places = [[0.02, 0.03, 0.12], [-0.03, 0.01, 0.1]]
    >>> pressures = midair.Scene(array, places).propagation().copy()
    >>> pressures[:, 17] = 0
    >>> print(midair.doctor(array, lambda drive: abs(pressures @ drive), microphones=places).faults[0].text)
    transducer 17 is silent
    """
    callback(progress, "step, steps")
    if not callable(read):
        raise refused("read", read, "give a function of the drive (N,) that gives |p| at the microphones")
    owner = Board(board) if isinstance(board, str) else board
    made = owner.board if isinstance(owner, Connection) else owner
    if not isinstance(made, Board | Array):
        raise refused("board", board, "give a connection, a midair.Board, its name, or a midair.Array")
    array = made.array if isinstance(made, Board) else made
    of = _boards(made, array, boards)
    places = places_of(microphones)
    air = {"temperature": temperature, "sound_speed": sound_speed}
    given: Any = {name: value for name, value in air.items() if value is not None}
    scene = Scene(array, places, **given)
    rest = number("settle", settle, least=0)
    line = 1 / made.limits["steady_frames_per_second"] if isinstance(made, Board) else 0.0
    error = None if microphones_error is None else number("microphones_error", microphones_error, least=0)
    judged = flag("in_pascals", in_pascals)

    drives = plan(made, len(places), seconds=seconds, settle=rest, seed=seed)
    sounding = int(np.any(drives, axis=0).sum())
    received: list[NDArray[Any]] = []
    for k, drive in enumerate(drives):
        if progress is not None and progress(k, len(drives)) is False:
            raise KeyboardInterrupt
        if isinstance(owner, Connection):
            owner.send(drive)
            time.sleep(line + rest)
        shapes = [(len(places),), ()][: 2 if len(places) == 1 else 1]
        cure = f"give |p| or p at {len(places)} microphones"
        received.append(np.atleast_1d(numbers("read(drive)", read(drive), shapes, cure, kinds="iufc")))
        parts = 2 if np.iscomplexobj(received[0]) else 1
        if k == 0 and len(drives) * len(places) * parts < LEAST * sounding:
            wanted = int(np.ceil(LEAST * sounding / len(places) / parts)) * (line + rest + LISTEN)
            cure = f"{sounding} transducers need {wanted:.0f} s, or more microphones"
            raise refused("seconds", seconds, cure)
        if parts == 2 and (k + 1) * len(places) * 2 >= PLENTY * sounding:
            break
    if isinstance(owner, Connection):
        owner.off()
    drives = drives[: len(received)]
    readings = readings_of(np.array(received), len(received), len(places), None)
    found = diagnose(scene, of, drives.astype(np.complex128), readings, error)
    faults, notes = _named(found, of, np.any(drives, axis=0), scene, judged)
    return Report(
        board=made.name if isinstance(made, Board) else "array",
        faults=tuple(faults),
        notes=tuple(notes),
        response=found.relative * found.middle[of],
        response_error=found.error * np.abs(found.middle[of]),
        order=found.order,
        sound_speed=found.calibration.sound_speed,
        sound_speed_error=found.calibration.sound_speed_error,
        noise=found.calibration.noise,
        readings=readings.size,
        seconds=len(received) * (line + rest + LISTEN),
    )


def plan(
    made: Board | Array, microphones: int, *, seconds: float = 60.0, settle: float = SETTLE, seed: int = 0
) -> NDArray[np.complex64]:
    """Return the drives (K, N) of a diagnosis, as the board plays them, as many as the time allows."""
    board = made if isinstance(made, Board) else None
    array = made if isinstance(made, Array) else made.array
    line = 1 / board.limits["steady_frames_per_second"] if board else 0.0
    count = int(number("seconds", seconds, above=0) / (line + settle + LISTEN))
    drives = calibration_drives(array, PLENTY, microphones=microphones, seed=seed)[: max(count, 1)]
    return np.array([board.decode(board.encode(drive)) for drive in drives]) if board else drives


def _boards(made: Board | Array, array: Array, boards: int | None) -> Indices:
    """Return the board's index of each transducer, from 0 on."""
    if isinstance(made, Board):
        if boards is not None:
            raise refused("boards", boards, "the board knows how many it has, leave it out")
        each = -(-(int(made.channels.max()) + 1) // made.boards)
        return np.asarray(made.channels // each, np.intp)
    count = 1 if boards is None else boards
    if isinstance(count, bool) or not isinstance(count, int) or count < 1 or len(array) % count:
        raise refused("boards", boards, f"give how many equal parts the {len(array)} transducers are of")
    return np.arange(len(array)) * count // len(array)


def _named(
    found: Diagnosis, boards: Indices, sounding: NDArray[np.bool_], scene: Scene, in_pascals: bool
) -> tuple[list[Fault], list[str]]:
    """Return the faults, and notes on anything else of interest."""
    calibration = found.calibration
    places = zip(calibration.microphones, scene.points, calibration.microphones_error, strict=True)
    notes = []
    for m, (at, reported, error) in enumerate(places):
        apart = float(np.linalg.norm(at - reported))
        if apart > max(APART, 4 * float(np.linalg.norm(error))):
            notes.append(f"microphone {m} seems {1e3 * apart:.0f} mm from where it was said to be")
    if len(scene.points) == 1:
        notes.append("one microphone sees no swap of transducers at nearly equal distances: give two or more")
    if len(calibration.outlying):
        notes.append(f"{len(calibration.outlying)} readings lay far off and were left out")
    if found.unexplained > UNEXPLAINED:
        text = "the readings do not fit this array: check its order, the microphones' places and echoes"
        return [Fault("unexplained", (), found.unexplained, text)], notes
    gone = np.zeros(len(boards), bool)
    gone[calibration.dead] = True
    lost = [b for b in range(len(found.middle)) if gone[(boards == b) & sounding].mean() > WHOLE]
    faults = [Fault("board dead", (b,), 0.0, f"board {b} is silent: check its supply and line") for b in lost]
    if found.base:
        faults.append(Fault("order", (), 0.0, f"the channels are in another order: {found.base}"))
    judged = sounding & ~np.isin(boards, lost)
    faults += [*_transducers(found, judged, gone), *_whole(found, boards, lost, in_pascals)]
    faults += _speed(found, scene)
    if not in_pascals:
        notes.append("the level is not judged: the microphone's sensitivity is not known")
    return faults, notes


def _transducers(found: Diagnosis, judged: NDArray[np.bool_], gone: NDArray[np.bool_]) -> list[Fault]:
    """Return the faults of single transducers and of exchanged channels."""
    faults = []
    gain, degrees = np.abs(found.relative), np.degrees(np.angle(found.relative))
    usual = np.sqrt(found.spread**2 + found.error**2)
    for i in np.flatnonzero(judged & (gone | (gain < DEAD_GAIN))).tolist():
        faults.append(Fault("dead", (i,), 0.0, f"transducer {i} is silent"))
    alive = judged & ~gone & (gain >= DEAD_GAIN)
    for i in np.flatnonzero(alive & (gain < np.minimum(WEAK, 1 - SURELY * usual))).tolist():
        text = f"transducer {i} has {gain[i]:.2f} of the usual gain"
        faults.append(Fault("weak", (i,), float(gain[i]), text))
    turned = alive & (np.abs(degrees) > REVERSED)
    for i in np.flatnonzero(turned).tolist():
        text = f"transducer {i} is connected the wrong way round"
        faults.append(Fault("reversed", (i,), float(degrees[i]), text))
    unsure = np.degrees(SURELY * usual / np.maximum(gain, 1e-3))
    for i in np.flatnonzero(alive & ~turned & (np.abs(degrees) > np.maximum(ODD, unsure))).tolist():
        late = f"{abs(degrees[i]):.0f} degrees {'late' if degrees[i] > 0 else 'early'}"
        faults.append(Fault("phase", (i,), float(degrees[i]), f"transducer {i} is {late}"))
    return faults + [_exchanged(cycle) for cycle in found.cycles]


def _exchanged(cycle: tuple[int, ...]) -> Fault:
    if len(cycle) == 2:
        return Fault("swapped", cycle, 0.0, f"transducers {cycle[0]} and {cycle[1]} are exchanged")
    way = " to ".join(map(str, (*cycle, cycle[0])))
    return Fault("order", cycle, 0.0, f"transducers are exchanged in a ring: {way}")


def _whole(found: Diagnosis, boards: Indices, lost: list[int], in_pascals: bool) -> list[Fault]:
    """Return the faults of boards: their delays and levels."""
    faults = []
    left = [b for b in range(len(found.middle)) if b not in lost]
    # If a microphone is nearer to one of two opposed boards, the other seems late: an error of place counts
    # twice.
    off = np.sqrt(np.mean(found.calibration.microphones_error**2) / len(found.calibration.microphones))
    wave_number = 2 * np.pi * found.calibration.scene.frequency / found.calibration.sound_speed
    unsure = float(SURE * np.degrees(2 * wave_number * off))
    middle = found.middle[left] if left else np.ones(0, complex)
    for b, v in zip(left[1:], middle[1:], strict=True):
        degrees = float(np.degrees(np.angle(v / middle[0])))
        if abs(degrees) > max(LATE, unsure):
            late = "late" if degrees > 0 else "early"
            faults.append(
                Fault(
                    "delay",
                    (b,),
                    degrees,
                    f"board {b} is {abs(degrees):.0f} degrees {late}, or whole periods more",
                )
            )
    levels = np.abs(middle)
    if len(levels) and levels.max() / levels.min() > 1 + LEVEL:
        reference = 1.0 if in_pascals else float(levels.max())
        for b, level in zip(left, levels / reference, strict=True):
            if abs(level - 1) > LEVEL:
                faults.append(Fault("level", (b,), float(level), f"board {b} has {level:.2f} of its level"))
    elif len(levels) and in_pascals and abs(np.log(level := float(levels.mean()))) > LEVEL:
        faults.append(Fault("level", (), level, f"everything has {level:.2f} of the expected level"))
    return faults


def _speed(found: Diagnosis, scene: Scene) -> list[Fault]:
    speed, error = found.calibration.sound_speed, found.calibration.sound_speed_error
    if abs(speed - scene.sound_speed) <= max(SPEED, SURE * error):
        return []
    text = f"sound goes at {speed:.1f} m/s, not {scene.sound_speed:.1f}: give the air's temperature"
    return [Fault("sound speed", (), speed, text)]
