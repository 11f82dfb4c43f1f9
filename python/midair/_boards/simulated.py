"""Transports without a device: one drops frames, one writes a file, one simulates the speed of a line."""

from typing import Any

from .autd3_commands import check_count, divider, modulation
from .errors import BoardError
from .transport import LineTransport, Transport


class NullTransport(Transport):
    """Accepts every call at once and plays nothing."""

    def play(self, frame: bytes) -> None:
        """Drop the frame."""

    def silence(self) -> None:
        """Do nothing: nothing is on."""

    def modulate(self, hz: float | None) -> None:
        """Drop the frequency."""

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Drop the frames."""

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


class FileTransport(NullTransport):
    """Writes frames to a file, one after another. The first and the last frame turn everything off.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    off
        Hexadecimal: a frame that turns all transducers off.
    """

    def __init__(self, *, path: str, off: str) -> None:
        self._off = bytes.fromhex(off)
        try:
            self._file = open(path, "wb", buffering=0)  # noqa: SIM115, `close` closes it
        except OSError as error:
            raise BoardError(f'file "{path}" cannot be written ({error.strerror}): give another name') from error
        self._path = path
        self._last = b""
        self.silence()

    def play(self, frame: bytes) -> None:
        """Write the frame."""
        try:
            self._file.write(frame)
        except OSError as error:
            raise BoardError(f'file "{self._path}" cannot be written ({error.strerror}): make room') from error
        self._last = frame

    def silence(self) -> None:
        """Write the frame that turns everything off, unless it is already the last frame in the file."""
        if self._last != self._off:
            self.play(self._off)

    def modulate(self, hz: float | None) -> None:
        """Raise BoardError: a file can contain only frames."""
        if hz is not None:
            raise BoardError("a file holds frames, no modulation: leave it out")

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Write the frames once."""
        self.play(frames)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class LoopTransport(LineTransport):
    """A line with the speed of a real one and no device at its end."""

    def __init__(self, **line: Any) -> None:
        super().__init__(**line)
        self.silence()

    def modulate(self, wave: Any) -> None:
        """Modulate by swaps if the board has two banks; AUTD3 modulates by itself, so check its limits."""
        if self._swap is not None:
            super().modulate(wave)
        else:
            modulation(wave)

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Wait as long as a real line would take. Only AUTD3 stores sequences, so its limits are checked."""
        check_count(count)
        divider(rate)
        self.play(frames)

    def _write(self, content: bytes) -> None:
        """Drop the bytes."""

    def close(self) -> None:
        """End the modulation."""
        self._stop()
