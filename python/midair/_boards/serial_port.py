"""Serial ports, by pyserial."""

import errno
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import serial

from .errors import BoardBusy, BoardError, BoardNotFound, BoardPermission, BoardTimeout, gone, reason
from .transport import LineTransport

#: A line that accepts no bytes for this time, in s, counts as lost. The system's buffers add to it: 0.6 s at
#: 230400 Bd, 1.5 s at 115200 Bd, measured with a pseudo-terminal.
STALLED = 0.3

#: Bytes per call of write.
PIECE = 512

#: Time in s that a restarted Arduino spends in its boot loader.
RESTART = 2.0

#: Time in s between two checks of the system's buffer.
LOOK = 1e-3

#: Errors of pyserial for a port that is gone: those of the system, and on POSIX those of the terminal.
FAILURES: tuple[type[Exception], ...] = (OSError, ValueError)
with suppress(ImportError):
    import termios

    FAILURES = (*FAILURES, termios.error)


class SerialTransport(LineTransport):
    """A board at a serial port.

    Parameters
    ----------
    port
        Name of the port, such as "/dev/ttyUSB0" or "COM3".
    restarts
        Whether opening the port may restart the board, as with an Arduino.
    exclusive
        Whether other programs are prevented from opening the port meanwhile.
    line
        Arguments of LineTransport.
    """

    def __init__(self, *, port: str, restarts: bool = False, exclusive: bool = True, **line: Any) -> None:
        super().__init__(**line)
        self._name = port
        self._port = serial.Serial(write_timeout=STALLED, exclusive=exclusive)
        self._port.port = port
        # A rise of the DTR line restarts an Arduino. Linux always raises it on opening, so the code below
        # waits for the restart.
        self._port.dtr = not restarts
        try:
            self._port.baudrate = line["baud"]
            self._port.open()
        except FAILURES as error:
            raise _refused(port, error) from error
        try:
            self.silence()
            if restarts and self._has_control_lines():
                time.sleep(RESTART)
                self.silence()
        except BaseException:
            # Without this, the board would emit as soon as its boot loader ends.
            if restarts and self._has_control_lines():
                with suppress(BoardError):
                    time.sleep(RESTART)
                    self.silence()
            self.close()
            raise

    def _write(self, content: bytes) -> None:
        with self._reported():
            # This computer's clock may be ahead of the adapter's, so wait until its buffer has room.
            patience = time.monotonic() + STALLED
            while self._port.out_waiting > len(content):
                if time.monotonic() > patience:
                    raise serial.SerialTimeoutException
                time.sleep(LOOK)
            # Small pieces, so that the time limit of a write is long enough for each.
            for at in range(0, len(content), PIECE):
                self._port.write(content[at : at + PIECE])

    def look(self) -> None:
        """Read the length of the port's buffer, which raises BoardLost if the port is gone."""
        with self._reported():
            _ = self._port.out_waiting

    def close(self) -> None:
        """Wait until the line has transmitted its last bytes, then close the port."""
        self._stop()
        self._drain()
        with suppress(*FAILURES):
            self._port.close()

    def _has_control_lines(self) -> bool:
        """Return whether the port has control lines, which could restart a board.

        A pseudo-terminal has none.
        """
        try:
            _ = self._port.cts
        except FAILURES:
            return False
        return True

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Convert pyserial's errors to BoardTimeout or BoardLost."""
        try:
            yield
        except serial.SerialTimeoutException as error:
            # Discard the buffer: its old frames must not follow the bytes that turn everything off.
            with suppress(*FAILURES):
                self._port.reset_output_buffer()
            raise BoardTimeout(
                f'port "{self._name}" took nothing for {STALLED} s: check the board\'s power and cable'
            ) from error
        except FAILURES as error:
            raise gone(f'port "{self._name}"', error) from error


def _refused(port: str, error: Exception) -> BoardError:
    """Return the error for a port that cannot be opened, with the reason and the cure."""
    number, known = getattr(error, "errno", None), reason(error)
    if number in (errno.ENOENT, errno.ENXIO, errno.ENODEV) or "FileNotFoundError" in known:
        return BoardNotFound(f'port "{port}" is not there: plug the board in; `midair ports` lists the ports')
    # Windows reports a port that is in use as "no permission".
    if number in (errno.EAGAIN, errno.EBUSY) or "PermissionError" in known:
        return BoardBusy(f'port "{port}" is in use: close the other program that holds it')
    if number in (errno.EACCES, errno.EPERM):
        return BoardPermission(
            f'port "{port}" may not be opened by you: join its group, on Debian by '
            f"`sudo usermod -aG dialout $USER`, and log in again"
        )
    return BoardError(f'port "{port}" cannot be opened ({known}): give a serial port')
