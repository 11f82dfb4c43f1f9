"""Links without a device: into nothing, into a file, or to a line that is only kept time of."""

from __future__ import annotations

from typing import Any

from .autd3_commands import check_count, divider, modulation
from .errors import BoardError
from .line import LineTransport


class NullTransport:
    """Takes everything at once, and plays nothing."""

    def play(self, frame: bytes) -> None:
        """Forget the frame."""

    def silence(self) -> None:
        """Nothing is on."""

    def modulate(self, hz: float | None) -> None:
        """Forget the frequency."""

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Forget the frames."""

    def look(self) -> None:
        """There is nothing to be gone."""

    def close(self) -> None:
        """There is nothing to let go of."""


class FileTransport(NullTransport):
    """Writes frames one after another, the first and the last off.

    path : the file, written over
    off : hexadecimal, a frame that plays nothing
    """

    def __init__(self, *, path: str, off: str) -> None:
        self._off = bytes.fromhex(off)
        try:
            self._file = open(path, "wb", buffering=0)  # noqa: SIM115, it is closed by `close`
        except OSError as error:
            raise BoardError(
                f'file "{path}" cannot be written ({error.strerror}): give another name'
            ) from error
        self._path = path
        self._last = b""
        self.silence()

    def play(self, frame: bytes) -> None:
        """Write the frame."""
        try:
            self._file.write(frame)
        except OSError as error:
            raise BoardError(
                f'file "{self._path}" cannot be written ({error.strerror}): make room'
            ) from error
        self._last = frame

    def silence(self) -> None:
        """Write a frame that is off, unless the last one is."""
        if self._last != self._off:
            self.play(self._off)

    def modulate(self, hz: float | None) -> None:
        """Refused: a file holds frames."""
        if hz is not None:
            raise BoardError("a file holds frames, no modulation: leave it out")

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Write the frames once."""
        self.play(frames)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class LoopTransport(LineTransport):
    """A line that takes its time as a real one does, and leads nowhere."""

    def __init__(self, **line: Any) -> None:
        super().__init__(**line)
        self.silence()

    def modulate(self, wave: Any) -> None:
        """Swap as a board of two banks does; AUTD3, which modulates by itself, refuses what it does."""
        if self._swap is not None:
            super().modulate(wave)
        else:
            modulation(wave)

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Take as long as the line does for frames that AUTD3, which alone holds some, does not refuse."""
        check_count(count)
        divider(rate)
        self.play(frames)

    def _write(self, content: bytes) -> None:
        """The bytes are gone."""

    def look(self) -> None:
        """There is nothing to be gone."""

    def close(self) -> None:
        """End the modulation."""
        self._stop()
