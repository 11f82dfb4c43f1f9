"""`midair.connect`: a board that plays drives until its connection is closed."""

import json
import math
import time
import weakref
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, wait
from contextlib import suppress
from itertools import count
from typing import Any, Literal

import numpy as np

# The first import of this module, which Cython has compiled, loses a Ctrl-C: not while a board plays.
import numpy.random
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Solution, stated
from .._sequence import Sequence
from .._support.arguments import frame_rate, is_array, number, refused
from . import connection as connections, wire
from .address import Address, board_at, describe, modulation, parse
from .board import Board
from .errors import BoardError, BoardLost, BoardTimeout
from .limit import Limit, check_rate, given_drives, refuse_real, timed, warn_of_scale, warn_of_seam
from .process import PATIENCE, GuardProcess, Stats
from .wire import Kind, Late

#: A stream keeps frames for LEAD s on their way to the guard (LIVE s if a generator makes them while they
#: play; at least AHEAD frames), so that a busy computer does not interrupt it.
AHEAD = 2
LEAD = 0.2
LIVE = 0.04

#: A caller that waits for an answer sends this many keep-alive messages to the guard within the time `hold`.
HOLDS = 4

#: Treatments of a late frame of a stream, by their names.
LATE = {"skip": Late.SKIP, "wait": Late.WAIT, "error": Late.ERROR}


class Connection:
    """Connection to a board, which the end of a `with` block turns off; from `midair.connect`.

    A guard process owns the device. It turns everything off when the connection is closed and when the
    program ends for any reason. It also does so when no call to send, stream, upload, modulate or off
    came for `hold` s; the next frame plays again. An error or Ctrl-C during a call turns the board off,
    too. A frame that is rejected before it is sent changes nothing.

    Examples
    --------
    >>> import midair
    >>> with midair.connect("sonicsurface:loop") as surface:
    ...     surface.send(midair.solve(midair.Scene(surface.board.array, [[0, 0, 0.15]])))
    ...     bool(abs(surface.emitting).max() > 0.99), surface.stats.frames
    (True, 1)
    """

    board: Board

    def __init__(self, address: Address, board: Board, hold: float, limit: Limit | None) -> None:
        self.board = board
        self._place = address.where or address.kind
        self._hold = hold
        self._limit = limit
        self._late = 0
        self._warned = self._missed = False
        self._reported: dict[str, Any] = {"state": "off", "frames": 0, "late": 0, "lapses": 0}
        self._guard = GuardProcess(describe(address, board), hold)
        self._finalizer = weakref.finalize(self, self._guard.close)

    def send(self, drive: ArrayLike | Solution) -> None:
        """Play a drive until the next frame comes; returns when at most two frames are waiting.

        Parameters
        ----------
        drive : (N,) array_like or midair.Solution
            Complex drive of moduli up to 1.

        Raises
        ------
        SceneError
            For a wrong drive.
        BoardError
            For a drive above the limit, and if the connection is closed; BoardLost if the board is gone.
        """
        frame = self._encode(drive)
        self.board._warn_of_silence(drive, frame)
        self._call(Kind.PLAY, wire.WHEN.pack(0.0, 0.0, Late.WAIT) + frame)

    def stream(
        self,
        drives: Iterable[ArrayLike | Solution] | NDArray[Any] | Sequence,
        *,
        rate: float | None = None,
        late: Literal["skip", "wait", "error"] = "skip",
    ) -> Stats:
        """Play drives one after another; the last one continues to play.

        Warns if frames are dropped, because `rate` is above the board's, and if the board then emits less.

        Parameters
        ----------
        drives : (T, N) array_like, midair.Sequence, or iterable
            Drives or solutions; an iterable may be a generator that makes them while they play.
        rate : float, optional
            Frames per second; by default the sequence's own, or the board's highest, at which none is late.
        late : {"skip", "wait", "error"}, optional
            For a frame that comes more than a period late because the board is slow: "skip" drops it and
            keeps to the clock, "wait" plays it and moves the clock, "error" raises BoardTimeout. A frame
            from a slow generator is played when it comes, unless `late` is "error".

        Returns
        -------
        Stats
            Counts of this stream: `frames`, `late` and `lapses`.

        Raises
        ------
        SceneError
            For a wrong drive.
        BoardError
            For a drive above the limit, and if the connection is closed; BoardLost if the board is gone.
        BoardTimeout
            For a rate that late="error" cannot keep.
        """
        frames = given_drives(self.board, drives)
        if rate is None and isinstance(drives, Sequence):
            rate = drives.rate
        pace = self.board.rate if rate is None else frame_rate(rate)
        if late not in LATE:
            raise refused("late", late, f"give {', '.join(LATE)}")
        check_rate(pace, self.board, LATE[late])
        before = self.stats
        try:
            known = isinstance(drives, Sequence | list | tuple) or is_array(drives)
            then = None if rate is None else LATE[late]
            # Frames beyond the board's own rate would only wait in the queue.
            ahead = max(AHEAD, math.ceil(min(pace, self.board.rate) * (LEAD if known else LIVE)))
            self._stream(frames, 1 / pace, then, ahead)
        except BaseException:
            self._quiet()
            raise
        return self.stats - before

    def upload(self, sequence: Sequence) -> None:
        """Let the board repeat a sequence by itself, if it can store one (AUTD3).

        Warns of a jump from the last frame to the first beyond the bound of the sequence.

        Parameters
        ----------
        sequence : midair.Sequence
            Frames for the array of the board.

        Raises
        ------
        BoardError
            For a board that stores no sequence, a closed connection; BoardLost if the board is gone.
        SceneError
            For wrong frames.
        """
        if not self.board.link["holds_sequence"]:
            raise BoardError(f"{self.board.name} holds no sequence: use stream")
        if not isinstance(sequence, Sequence):
            raise refused("sequence", sequence, "give a midair.Sequence")
        warn_of_seam(sequence)
        frames = [self._encode(drive) for drive in given_drives(self.board, sequence)]
        self._call(Kind.UPLOAD, wire.UPLOADED.pack(len(frames), sequence.rate) + b"".join(frames))

    def modulate(self, hz: float | ArrayLike | None) -> None:
        """Modulate the amplitude of all drives, also of later ones.

        Parameters
        ----------
        hz : float, (S,) array_like or None
            Frequency in Hz: of a sine on AUTD3, of switching on and off on SonicSurface. Or 2 to 65536
            samples of the pressure, 0 to 1, which AUTD3 repeats at 4000 per second. None for no modulation.

        Raises
        ------
        BoardError
            For a board that cannot modulate, and if the connection is closed; BoardLost if the board is gone.
        SceneError
            For a wrong frequency or wrong samples.
        """
        wave = (math.nan, b"") if hz is None else modulation(self.board.name, hz)
        self._call(Kind.MODULATE, wire.MODULATION.pack(wave[0]) + wave[1])

    def off(self) -> None:
        """Turn everything off; the connection stays open.

        Raises
        ------
        BoardError
            If the connection is closed; BoardLost if the board is gone.
        """
        self._call(Kind.OFF)

    def close(self) -> None:
        """Turn everything off and release the board. Never raises, never hangs, can be called repeatedly."""
        self._finalizer()

    def __enter__(self) -> "Connection":
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        """Turn the board off and close. Raises BoardLost if the board is gone and no call has reported it."""
        try:
            if kind is None and self._finalizer.alive and not self._missed:
                self.off()
        finally:
            self.close()

    @property
    def emitting(self) -> NDArray[np.complex64]:
        """Drive (N,) that plays now, before modulation; 0 if none. In an upload, the time gives the frame."""
        frame = b""
        if self._finalizer.alive:
            with suppress(BoardLost):
                frame = self._guard.call(Kind.EMITTING)
        return self.board.decode(frame or self.board.off_frame)

    @property
    def state(self) -> Literal["off", "playing", "modulating", "lost", "closed"]:
        """State of the board; "off" also after `hold` expired, "lost" if the board is unplugged or stalls."""
        if not self._finalizer.alive:
            return "closed"
        try:
            self._call(Kind.STATUS)
        except BoardLost:
            return "lost"
        state: Literal["off", "playing", "modulating", "lost"] = self._reported["state"]
        self._missed |= state == "lost"
        return state

    @property
    def stats(self) -> Stats:
        """Counts of frames, of late frames, and of times that `hold` expired."""
        if self._finalizer.alive:
            with suppress(BoardLost):
                self._call(Kind.STATUS)
        return Stats(self._reported["frames"], self._late + self._reported["late"], self._reported["lapses"])

    def __repr__(self) -> str:
        return f"<midair.Connection to {self.board.name} at {self._place}: {self.state}>"

    def _keep(self) -> bool:
        """Tell the guard that the last frame is still wanted. Return whether it plays."""
        self._call(Kind.HOLD)
        return self._reported["state"] in ("playing", "modulating")

    def _call(self, kind: Kind, content: bytes = b"") -> None:
        """Send a request to the guard and store the status that it returns; an error turns the board off."""
        requested = self._guard.ask(kind, content)
        try:
            self._note(requested)
        except BaseException:
            self._quiet()
            raise

    def _note(self, requested: Future[bytes], patience: float = PATIENCE) -> None:
        try:
            self._reported = json.loads(self._guard.answer(requested, patience))
        except (BoardLost, BoardTimeout):
            self._missed = True
            raise

    def _answered(self, requested: Future[bytes], patience: float) -> None:
        self._wait(patience, requested)
        self._note(requested, 0.0)

    def _wait(self, seconds: float, requested: Future[bytes]) -> None:
        """Wait for the answer to a call; send keep-alive messages so that the `hold` time does not expire."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0 and not requested.done():
            if wait([requested], min(left, self._hold / HOLDS)).not_done:
                self._guard.ask(Kind.HOLD)

    def _quiet(self) -> None:
        """Turn the board off after an interrupted call, without waiting for the answer."""
        with suppress(BoardError):
            self._guard.ask(Kind.OFF)

    def _encode(self, drive: ArrayLike | Solution) -> bytes:
        """Return a drive's frame; rejects drives above the limit and solutions for other transducers."""
        if not isinstance(drive, Solution):
            refuse_real(drive)
        frame = self.board._frame(drive)
        if isinstance(drive, Solution) and drive.scale < 1 and not self._warned:
            self._warned = True
            warn_of_scale(drive.scale)
        if self._limit is not None:
            self._limit.check(self.board.decode(frame))
        return frame

    def _stream(self, drives: Iterator[ArrayLike | Solution], period: float, late: Late | None, ahead: int) -> None:
        """Send frames to the guard, which plays each when it is due, or at once if `late` is None."""
        patience = PATIENCE + ahead * period
        under_way: deque[Future[bytes]] = deque()
        due = math.inf
        for requested, drive in timed(drives):
            now = time.monotonic()
            counted = late is not None and now > due + period
            if late is None or math.isinf(due):
                due = now
            elif counted:
                self._late += 1
                if late == Late.ERROR:
                    raise BoardTimeout(wire.LATE.format(1e3 * (now - due)))
                if late == Late.SKIP and requested > due + period:
                    due += period
                    continue
                due = now
            # This program has counted the frame as late; with WAIT the guard does not count it again.
            then = Late.WAIT if counted else late or Late.WAIT
            frame = wire.WHEN.pack(due, due + period, then) + self._encode(drive)
            under_way.append(self._guard.ask(Kind.PLAY, frame))
            due += period
            if len(under_way) >= ahead:
                self._answered(under_way.popleft(), patience)
        # All frames are sent; these messages show the guard that the caller still waits for them.
        for each in under_way:
            self._guard.ask(Kind.HOLD)
            self._answered(each, patience)
        self._guard.ask(Kind.HOLD)
        # Wait until the last frame has played for a period, too.
        if math.isfinite(due):
            self._wait(due - time.monotonic(), Future())


def connect(
    address: str,
    *,
    array: Array | None = None,
    board: Board | str | None = None,
    hold: float = 60.0,
    limit: Mapping[str, Any] | None = None,
) -> Connection:
    """Connect to a board. The end of a `with` block turns the board off.

    Parameters
    ----------
    address : str
        A board and its place: "autd3" (searched), "autd3:eth0" (a network interface), "autd3:emulator",
        "sonicsurface:/dev/ttyUSB0" (a port), "openmpd:SERIAL" or "openmpd:SERIAL+SERIAL" (FTDI chips).
        Or no device: "sonicsurface:loop" is as slow as its line, "sonicsurface:null" accepts frames at
        once, "null" is such an AUTD3, "file:frames.bin" writes the frames to a file.
    array : midair.Array, optional
        The board's transducers, if they differ from its preset; in its order, to 3 mm after a motion, or with
        pins.
    board : midair.Board or str, optional
        A board of your own; a name if the address has none.
    hold : float, optional
        Time in s without a call to send, stream, upload, modulate or off, after which the board turns off.
    limit : mapping, optional
        {"positions": (K, 3) in m or a `midair.Ear`, "pressure": Pa} rejects frames whose peak |p| there
        is higher. Other entries, such as temperature, are for the `midair.Scene` that computes |p|.

    Returns
    -------
    midair.Connection
        The open connection.

    Raises
    ------
    SceneError
        For a wrong argument.
    BoardNotFound, BoardBusy, BoardPermission, BoardError
        For a device that cannot be opened.

    Examples
    --------
    >>> import midair
    >>> with midair.connect("sonicsurface:loop") as surface:
    ...     surface.send(midair.solve(midair.Scene(surface.board.array, [[0, 0, 0.15]])))
    ...     surface.state
    'playing'
    >>> surface.state
    'closed'
    """
    place = parse(address)
    seconds = number("hold", hold, above=0)
    if isinstance(board, Board) and array is not None:
        raise refused("array", array, "the board has its own, leave one of them out")
    if board is None:
        board = board_at(place, array)
    if not isinstance(board, Board):
        board = Board(board, array)
    if place.kind_of_board not in (None, board.name):
        raise refused("board", board.name, f'the address "{address}" names another, leave one of them out')
    return Connection(place, board, seconds, None if limit is None else Limit(limit, board.array))


#: Time in s after which a drive is sent again, so that the connection's `hold` time does not expire.
AGAIN = 10.0

#: Seconds between two checks of the board's state.
LOOK = 0.1


def keep(
    connection: Connection, solution: Solution, seconds: float | None, show: Callable[[], object] = lambda: None
) -> None:
    """Play one drive for a number of seconds, or until Ctrl-C if None. Calls `show` repeatedly."""
    begin = time.monotonic()
    for k in count():
        if k % round(AGAIN / LOOK) == 0:
            connection.send(solution)
        left = math.inf if seconds is None else begin + seconds - time.monotonic()
        if left <= 0:
            return
        time.sleep(min(LOOK, left))
        show()


def play(solution: Solution, address: str, *, seconds: float | None = None, **options: Any) -> None:
    """Play a solution on a board, then turn the board off: `solution.play("autd3", seconds=5)`.

    Parameters
    ----------
    solution : midair.Solution
        The solution to play.
    address : str
        The board and its place, as for `midair.connect`.
    seconds : float, optional
        Duration in s; by default until Ctrl-C.
    **options
        Other arguments of `midair.connect`.

    Raises
    ------
    SceneError
        For a duration that is not above 0 and for a solution without a scene.
    BoardError
        As for `midair.connect` and `Connection.send`.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.1]])
    >>> midair.solve(scene).play("sonicsurface:loop", seconds=0.1)
    """
    duration = None if seconds is None else number("seconds", seconds, above=0)
    if solution.scene is None:
        cure = "give a solution of a Scene, whose array the board drives"
        raise stated("solution.scene", "is None", cure, code="missing")
    given = {} if "board" in options else {"array": solution.scene.array}
    with connections.connect(address, **{**given, **options}) as connection:
        keep(connection, solution, duration)
