"""FIFO links of FTDI's chips (pyftdi), for OpenMPD and ultrasonic-homies boards. Untested on hardware.

The chip accepts bytes as fast as the board plays frames, and blocks while the board's memory is full.
"""

import sys
from contextlib import suppress
from typing import Any

from pyftdi.ftdi import Ftdi

from .errors import BoardBusy, BoardError, BoardNotFound, BoardPermission, BoardTimeout, gone, reason
from .transport import Transport

#: A board that accepts no bytes for this time, in ms, counts as lost.
STALLED_MS = 200

#: Values of OpenMPD's own driver: time in ms after which the chip sends an incomplete USB packet; bytes per
#: transfer.
LATENCY_MS = 2
CHUNK = 65536

#: Error numbers of Linux, macOS and Windows that USB drivers return: no permission, busy, timed out.
NO_ACCESS, BUSY = 13, 16
TIMED_OUT = (60, 110, 10060)

#: Cures for a chip that may not be opened, and for a system without libusb.
if sys.platform == "win32":
    ALLOW = "give it the driver WinUSB with Zadig (pyftdi's documentation explains it)"
    INSTALL = "put libusb-1.0.dll into a folder of PATH, and give the chip the driver WinUSB with Zadig"
else:
    ALLOW = "allow it by a rule of udev (pyftdi's documentation has one)"
    INSTALL = "install libusb 1.0: Debian's libusb-1.0-0, on macOS `brew install libusb`"


class FifoTransport(Transport):
    """Plays frames on boards with one FIFO each. A frame has one part of equal length for each board.

    Parameters
    ----------
    places
        (serial number of the chip, interface) of each FIFO, in the order of a frame's parts. Interface 2 is
        the second one of an FT2232H.
    length
        Bytes of a frame.
    silence
        Hexadecimal: the frames that make the boards silent from any state.
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
        """Write each board's part of the frame. Returns when the chips have accepted all parts."""
        self._deal(frame)

    def silence(self) -> None:
        """Write the bytes that turn everything off. Frames already in the chips play for a few ms more."""
        self._deal(self._silence)

    def look(self) -> None:
        """Raise BoardLost if a chip does not answer."""
        for (serial, _), chip in zip(self._places, self._chips, strict=True):
            try:
                chip.poll_modem_status()
            # pyftdi and libusb raise errors of many kinds.
            except Exception as error:
                raise _failed(serial, error) from error

    def close(self) -> None:
        """Close the chips."""
        for chip in self._chips:
            with suppress(Exception):
                chip.close()

    def _deal(self, content: bytes) -> None:
        failed: BoardError | None = None
        for k in range(len(content) // self._part):
            one = k % len(self._chips)
            try:
                self._chips[one].write_data(content[k * self._part : (k + 1) * self._part])
            # pyftdi and libusb raise errors of many kinds.
            except Exception as error:
                # Go on with the other boards: their parts of `content` may turn them off.
                failed = _failed(self._places[one][0], error)
        if failed is not None:
            raise failed


def _open(serial: str, interface: int) -> Any:
    """Open the chip with this serial number and empty its buffers."""
    chip = Ftdi()
    try:
        chip.open_from_url(f"ftdi://::{serial}/{interface}")
        chip.timeouts = (STALLED_MS, STALLED_MS)
        chip.set_latency_timer(LATENCY_MS)
        chip.write_data_set_chunksize(CHUNK)
        chip.purge_buffers()
    # pyftdi and libusb raise errors of many kinds, also UsbToolsError for a missing chip.
    except Exception as error:
        with suppress(Exception):
            chip.close()
        number = _number(error)
        if number == NO_ACCESS:
            raise BoardPermission(f'device "{serial}" may not be opened by you: {ALLOW}') from error
        if number == BUSY:
            raise BoardBusy(f'device "{serial}" is in use: close the other program that holds it') from error
        if "No backend" in str(error):
            raise BoardError(f'device "{serial}" needs libusb, which this system lacks: {INSTALL}') from error
        raise BoardNotFound(
            f'device "{serial}" is not there ({reason(error)}): plug the board in; the serial number is '
            "its FTDI chip's" + (f"; {ALLOW}" if sys.platform == "win32" else "")
        ) from error
    return chip


def _failed(serial: str, error: Exception) -> BoardError:
    if _number(error) in TIMED_OUT:
        return BoardTimeout(f'device "{serial}" took nothing for {STALLED_MS / 1e3:g} s: check its power')
    return gone(f'device "{serial}"', error)


def _number(error: Exception) -> int | None:
    """Return the system's error number (errno) of an error or of its cause, None if neither has one."""
    found = getattr(error, "errno", None)
    behind = error.__cause__ or error.__context__
    return found if found is not None or behind is None else getattr(behind, "errno", None)
