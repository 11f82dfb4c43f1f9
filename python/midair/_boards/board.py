"""`midair.Board`: converts drives to the bytes of a board, and back; arrays from files of boards."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from os import PathLike, fspath
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Codec, Solution, array_parts, presets, stated
from .._support.arguments import refused, warn

#: Largest part by which the frequency of a drive may differ from that of its board.
DETUNED = 0.02


class Layout(NamedTuple):
    """Positions and normals (N, 3) in m, other data of a file, named as in `midair.Array`; Hz of hardware."""

    positions: NDArray[np.float64]
    normals: NDArray[np.float64] | None = None
    source_pressure: float | None = None
    directivity: Any = None
    response: NDArray[np.float64] | None = None
    mask: NDArray[np.bool_] | None = None
    pins: NDArray[np.int64] | None = None
    quantization: Any = None
    frequency: float = 40e3


def changed(array: Array, **parts: Any) -> Array:
    """Return a copy of an array with some of its parts replaced."""
    own = {name: getattr(array, name) for name in ("positions", "normals", *array_parts())}
    return Array(**{**own, **parts})._with_hardware(array._hardware)


class Board:
    """Boards of an array: their phases and amplitudes, and the bytes that play a drive.

    Parameters
    ----------
    name : str, path or sequence of paths
        A kind of board that `midair boards` lists, such as "autd3", or a preset of one, such as
        "sonicsurface_pair". Or OpenMPD's board file .pat, two for a pair.
    array : midair.Array, optional
        N transducers in the order of the board's preset, one board after the other, each moved and turned;
        or with pins. By default those of the preset, or a grid for a kind without a preset.
    tiles : (int, int), optional
        Boards along x and y of a preset that tiles, such as (2, 2).
    channels : (N,) or (C,) sequence of int, optional
        Channel of each transducer; the channels of a second board follow those of the first. By default
        the preset's order. If the array has C channels of its own: the board's channel for each of them.
    corrections : (N,) or (C,) array_like, optional
        Phase in rad that each transducer adds by itself. The phase sent is the wanted one minus the
        correction, before rounding.

    Raises
    ------
    SceneError
        For an unknown name or a file with an error. For an array in another order than the board, unless
        `channels` states the wiring. For another number of channels or corrections
        than transducers, or than channels of the array. For more channels than the board has.

    See Also
    --------
    midair.connect : plays drives on a board.

    Notes
    -----
    Masked or dead transducers are always off. docs/boards.md describes the bytes of each kind.

    Examples
    --------
    >>> import midair
    >>> board = midair.Board("sonicsurface")
    >>> solution = midair.solve(midair.Scene(board.array, [[0, 0, 0.15]]))
    >>> frame = board.encode(solution)
    >>> len(frame), frame[0], frame[-1]
    (258, 254, 253)
    >>> bool(abs(board.decode(frame) - solution.drive).max() < 1e-6)
    True
    """

    def __init__(
        self,
        name: str | PathLike[str] | Sequence[str | PathLike[str]],
        array: Array | None = None,
        *,
        tiles: tuple[int, int] | None = None,
        channels: Sequence[int] | NDArray[np.integer] | None = None,
        corrections: ArrayLike | None = None,
    ) -> None:
        paths = _files(name)
        if paths:
            name, array, channels, corrections = _from_files(paths, array, channels, corrections)
        kind = presets()[name].board if name in presets() else name
        if not isinstance(kind, str):
            raise refused("board", name, f"no board plays it, give one of {', '.join(Codec.kinds())}")
        # An unknown name is reported before any other error.
        Codec(kind)
        if array is None:
            array = Array.preset(str(name), tiles) if name in presets() else Codec.array(kind, tiles)
        elif tiles is not None:
            raise refused("tiles", tiles, "the array has its boards, leave them out")
        # Arguments that make an equal board, for pickling.
        self._made = kind, array, channels, corrections
        self._codec = Codec(kind, array, channels=channels, corrections=corrections)
        self._array = _on_board(array, self._codec)

    def __reduce__(self) -> tuple[Any, ...]:
        name, array, channels, corrections = self._made
        return partial(Board, channels=channels, corrections=corrections), (name, array)

    @property
    def name(self) -> str:
        """The kind of board."""
        return self._codec.name

    @property
    def array(self) -> Array:
        """Transducers, with the board's phases and amplitudes as their quantization."""
        return self._array

    @property
    def boards(self) -> int:
        """Number of boards."""
        return self._codec.boards

    @property
    def lines(self) -> int:
        """Number of lines: one for all boards, or one per board. A frame has a part for each line."""
        return self._codec.lines

    @property
    def channels(self) -> NDArray[np.int64]:
        """Channel on the board of each transducer (N,), or of each channel of the array (C,)."""
        return self._codec.channels

    @property
    def off_frame(self) -> bytes:
        """Frame that turns all transducers off."""
        return self._codec.off_frame

    @property
    def silence(self) -> bytes:
        """Bytes that silence the board from any state, also both banks of a board with two."""
        return self._codec.silence

    @property
    def link(self) -> dict[str, Any]:
        """Properties of the link ("kind": "serial", "fifo" or "udp") and of the board itself, by name."""
        return self._codec.link

    @property
    def baud(self) -> int | None:
        """Bits per second of the board's serial line (10 bits per byte); None for another link."""
        return self._codec.baud

    @property
    def rate(self) -> float:
        """Frames per second that the board's line can carry."""
        return self._codec.rate

    @property
    def limits(self) -> dict[str, Any]:
        """Capabilities by name: transducers, boards, phases, amplitudes, bytes and frames per second."""
        grid = self._codec.quantization
        return {
            "transducers": len(self.array),
            "boards": self.boards,
            "most_boards": self._codec.most_boards,
            "phases": grid["phases"],
            "amplitudes": grid["amplitudes"],
            "frame_bytes": len(self.off_frame),
            "frames_per_second": self.rate,
            "steady_frames_per_second": self._codec.steady_rate,
        }

    def encode(self, drive: ArrayLike | Solution) -> bytes:
        """Return the frame of a drive: the nearest phases and amplitudes of the board.

        Parameters
        ----------
        drive : (N,) array_like or midair.Solution
            Complex drive of moduli up to 1.

        Returns
        -------
        bytes
            The frame. It does not include `solution.scale`, the factor for supply or modulation.

        Raises
        ------
        SceneError
            For a drive of another shape, not finite, above 1, or different within one channel; for a solution
            for another frequency, or for transducers at other places or in another order.
        """
        frame = self._frame(drive)
        self._warn_of_silence(drive, frame)
        return frame

    def _frame(self, drive: ArrayLike | Solution) -> bytes:
        """Return the frame of a drive, as `encode`, without a warning."""
        if isinstance(drive, Solution):
            scene = drive.scene
            drive = drive.drive if scene is None else self._fit(scene.array, scene.frequency)(drive.drive)
        return self._codec.encode(drive)

    def _fit(self, array: Array, frequency: float | None = None) -> Callable[[NDArray[Any]], NDArray[Any]]:
        """Return the function that makes a drive of an array one of `self.array`.

        If the array lacks the response of the board, its phases are subtracted. Raises SceneError for another
        array or frequency in Hz.
        """
        emitted = self.array.medium["frequency"]
        if frequency is not None and abs(frequency / emitted - 1) > DETUNED:
            cure = f"the board emits {emitted:g} Hz, solve for that"
            raise stated("the drive", f"was solved for {frequency:g} Hz", cure, code="conflict")
        self.array._check_drive_of(array)
        own = self.array.response
        if own is None or array.response is not None:
            return lambda drive: drive
        turn = np.exp(-1j * np.angle(own))
        return lambda drive: drive * turn

    def _warn_of_silence(self, drive: ArrayLike | Solution, frame: bytes) -> None:
        """Warn if a frame turns all transducers off although its drive does not."""
        self._codec.warn_of_silence(drive.drive if isinstance(drive, Solution) else drive, frame)

    def decode(self, frame: bytes) -> NDArray[np.complex64]:
        """Return the drive that a frame plays.

        Parameters
        ----------
        frame : bytes
            A frame of the board, as `encode` returns it.

        Returns
        -------
        (N,) ndarray of complex64
            The drive, 0 for transducers that are off.

        Raises
        ------
        SceneError
            For bytes that are no frame of the board.
        """
        return self._codec.decode(frame)

    def __repr__(self) -> str:
        boards = "board" if self.boards == 1 else "boards"
        return f"<midair.Board {self.name}: {self.boards} {boards}, {len(self.array)} transducers>"


def _files(name: Any) -> list[str]:
    """Return the paths if `name` is one or several .pat files; [] if it is the name of a board."""
    several = [name] if isinstance(name, str | PathLike) else name
    try:
        paths = [fspath(one) for one in several]
    except TypeError:
        raise refused("board", name, "give a name, or one or two .pat files") from None
    if not paths:
        raise refused("board", name, "give a name, or one or two .pat files")
    return paths if not isinstance(name, str) or name.lower().endswith(".pat") else []


def _from_files(paths: list[str], array: Array | None, channels: Any, corrections: Any) -> tuple[str, Array, Any, Any]:
    """Read one or two .pat files, the lower board first; return kind, array, channels and corrections."""
    from . import pat

    if len(paths) > 2:
        raise refused("board", f"{len(paths)} files", "give one or two .pat files")
    if channels is not None or corrections is not None or array is not None:
        raise refused("board", paths[0], "the file has its array, channels and corrections, leave them out")
    boards = [pat.read(path) for path in paths]
    live = np.concatenate([board.gains for board in boards]) != 0
    array = Array.preset("openmpd_board" if len(boards) == 1 else "openmpd_pair", mask=live)
    for path, board in zip(paths, boards, strict=True):
        if np.abs(board.positions - Array.preset("openmpd_board").positions).max() > 1e-3:
            cure = "its positions are not those of an OpenMPD board: use Array.from_file and channels="
            raise refused("board", path, cure)
    pins = [np.asarray(board.pins) + 256 * k for k, board in enumerate(boards)]
    degrees = np.concatenate([board.corrections for board in boards])
    return "openmpd", array, np.concatenate(pins), np.deg2rad(degrees)


def _on_board(array: Array, codec: Codec) -> Array:
    """Return the array; quantization, response and frequency that it lacks are those of the board.

    So is a quantization with phases or amplitudes that the board does not have; this gives a warning.
    """
    own: dict[str, Any] = {"quantization": dict(codec.quantization), "response": codec.response}
    missing = {name: value for name, value in own.items() if value is not None and getattr(array, name) is None}
    if array.quantization is not None and (reason := _unplayable(array.quantization, codec)):
        warn(f"array.quantization has {reason}: board.array has the phases and amplitudes of the board")
        missing["quantization"] = own["quantization"]
    made = changed(array, **missing) if missing else array
    hardware = array._hardware and codec.frequency
    return made if hardware == made._hardware else made._with_hardware(hardware)


def _unplayable(given: Mapping[str, Any], codec: Codec) -> str | None:
    """Return the phases or amplitudes of a quantization that the board rounds to others."""
    grid = codec.quantization
    phases, most = given.get("phases"), grid["phases"]
    if phases is not None and most is not None and most % phases:
        return f"{phases} phases, a {codec.name} board {most}"
    amplitudes = given.get("amplitudes")
    if amplitudes is not None and grid["amplitudes"] is not None:
        apart = np.abs(np.subtract.outer(np.asarray(amplitudes), np.asarray(grid["amplitudes"]))).min(axis=1)
        if apart.max() > 1e-6:
            return f"{len(amplitudes)} amplitudes that a {codec.name} board does not have"
    return None
