"""FIFOs of FTDI's chips, by pyftdi, as OpenMPD and ultrasonic-homies have them. Untested on hardware.

A FIFO accepts bytes as fast as the board plays frames, and stops the line when the board's memory is full.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from pyftdi.ftdi import Ftdi

from .errors import BoardBusy, BoardError, BoardLost, BoardNotFound, BoardPermission, BoardTimeout

#: A board that accepts no bytes for this time, in ms, is stalled.
STALLED_MS = 200

#: Values of OpenMPD's own driver: a packet that is not full is sent after 2 ms; bytes of a USB transfer.
LATENCY_MS = 2
CHUNK = 65536

#: errno of Linux and macOS, which USB drivers return.
NO_ACCESS, BUSY = 13, 16
TIMED_OUT = (60, 110)


class FifoTransport:
    """Boards with a FIFO each; a frame is divided among them in parts of equal length.

    Parameters
    ----------
    places
        The chip's serial number and the interface (2 for the second one of an FT2232H) of each FIFO, in the
        order of a frame's parts.
    length
        Bytes of a frame.
    silence
        Hexadecimal, the frames that make the boards silent from any state.
    """

    def __init__(self, *, places: list[tuple[str, int]], length: int, silence: str) -> None:
        self._places = places
        self._part = length // len(places)
        self._silence = bytes.fromhex(silence)
        self._chips: list[Any] = []
        try:
            for serial, interface in places:
                self._chips.append(_open(serial, interface))
            self.silence()
        except BaseException:
            self.close()
            raise

    def play(self, frame: bytes) -> None:
        """Write each board's part; return when the chips have accepted them."""
        self._deal(frame)

    def silence(self) -> None:
        """Write the bytes that turn everything off; the rest in the chips plays for a few ms."""
        self._deal(self._silence)

    def modulate(self, hz: float | None) -> None:
        """Raise BoardError: these boards cannot modulate."""
        if hz is not None:
            raise BoardError("this board cannot modulate: stream drives of changing amplitude")

    def upload(self, frames: bytes, count: int, rate: float) -> None:
        """Raise BoardError: these boards store no sequence."""
        raise BoardError("this board holds no sequence: use stream")

    def look(self) -> None:
        """Read the state of each chip's lines."""
        for (serial, _), chip in zip(self._places, self._chips, strict=True):
            try:
                chip.poll_modem_status()
            # Any error of pyftdi and libusb.
            except Exception as error:
                raise _failed(serial, error) from error

    def close(self) -> None:
        """Release the chips."""
        for chip in self._chips:
            with suppress(Exception):
                chip.close()

    def _deal(self, content: bytes) -> None:
        failed: BoardError | None = None
        for k in range(len(content) // self._part):
            one = k % len(self._chips)
            try:
                self._chips[one].write_data(content[k * self._part : (k + 1) * self._part])
            # Any error of pyftdi and libusb.
            except Exception as error:
                # The parts of the other boards are written all the same: they may turn them off.
                failed = _failed(self._places[one][0], error)
        if failed is not None:
            raise failed


def _open(serial: str, interface: int) -> Any:
    """Return an empty FIFO of the chip with a serial number."""
    chip = Ftdi()
    try:
        chip.open_from_url(f"ftdi://::{serial}/{interface}")
        chip.timeouts = (STALLED_MS, STALLED_MS)
        chip.set_latency_timer(LATENCY_MS)
        chip.write_data_set_chunksize(CHUNK)
        chip.purge_buffers()
    # Any error of pyftdi and libusb, also UsbToolsError for a missing chip.
    except Exception as error:
        with suppress(Exception):
            chip.close()
        number = _number(error)
        if number == NO_ACCESS:
            raise BoardPermission(
                f'device "{serial}" may not be opened by you: allow it by a rule of udev (pyftdi\'s '
                "documentation has one)"
            ) from error
        if number == BUSY:
            raise BoardBusy(f'device "{serial}" is in use: close the other program that holds it') from error
        raise BoardNotFound(
            f'device "{serial}" is not there ({_reason(error)}): plug the board in; the serial number is '
            "its FTDI chip's"
        ) from error
    return chip


def _failed(serial: str, error: Exception) -> BoardError:
    if _number(error) in TIMED_OUT:
        return BoardTimeout(f'device "{serial}" took nothing for {STALLED_MS / 1e3:g} s: check its power')
    return BoardLost(
        f'device "{serial}" is gone ({_reason(error)}): the board plays on, switch its supply off, '
        "then plug it in and connect again"
    )


def _number(error: Exception) -> int | None:
    """Return the system's number of an error, its own or that of its cause."""
    found = getattr(error, "errno", None)
    behind = error.__cause__ or error.__context__
    return found if found is not None or behind is None else getattr(behind, "errno", None)


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
