"""FTDI FIFO chips: the bytes that each chip gets, and how its errors are reported,
with a model of the chip.
"""

import json
from typing import ClassVar

import pytest
from pyftdi.ftdi import Ftdi, FtdiError
from pyftdi.usbtools import UsbTools, UsbToolsError
from usb.core import USBError, USBTimeoutError

import midair
from midair._boards import fifo
from midair._boards.address import describe, parse
from midair._boards.transport import open_transport


class Chip:
    """A model of an FTDI chip."""

    there = ("A", "B")
    opened: ClassVar = {}

    def open_from_url(self, url):
        place, _, interface = url.rpartition("/")
        scheme, _, serial = place.rpartition(":")
        assert scheme == "ftdi://:"
        if serial not in self.there:
            raise UsbToolsError(f"No USB device with S/N {serial}")
        self.written, self.failing, self.closed = bytearray(), None, False
        self.opened[serial if interface == "1" else f"{serial}/{interface}"] = self

    def set_latency_timer(self, latency):
        assert latency == 2

    def write_data_set_chunksize(self, size):
        assert size == 65536

    def purge_buffers(self):
        pass

    def write_data(self, content):
        if self.failing is not None:
            raise FtdiError("Usb bulk write error") from self.failing
        self.written += content

    def close(self):
        self.closed = True


@pytest.fixture(autouse=True)
def chips(monkeypatch):
    monkeypatch.setattr(fifo, "Ftdi", Chip)
    monkeypatch.setattr(Chip, "opened", {})
    return Chip.opened


def transport(address):
    """Returns the transport that the guard opens for an address, and the board."""
    place = parse(address)
    board = midair.Board(place.board)
    # The guard, a process of its own, gets the description as JSON.
    return open_transport(json.loads(json.dumps(describe(place, board)))), board


def test_a_pair_is_dealt_its_parts(chips):
    pair, board = transport("openmpd:A+B")
    half = len(board.off_frame) // 2
    frame = bytes(range(256)) * 2 + bytes(reversed(range(256))) * 2
    pair.play(frame)
    pair.silence()
    pair.close()
    times = len(board.silence) // len(board.off_frame)
    for chip, part in ((chips["A"], slice(0, half)), (chips["B"], slice(half, None))):
        off = times * board.off_frame[part]
        assert chip.written == off + frame[part] + off
        assert chip.closed


def test_two_lines_of_one_chip(chips):
    homies, board = transport("homies:A")
    frame = board.encode([1] * 128 + [1j] * 128)
    homies.play(frame)
    half, off = len(frame) // 2, len(board.silence) // 2
    assert frame[:half] != frame[half:]
    # The first FPGA is on the chip's channel B, its interface 2.
    assert chips["A/2"].written[off:] == frame[:half]
    assert chips["A"].written[off:] == frame[half:]


def test_a_chip_that_is_not_there():
    with pytest.raises(midair.BoardNotFound, match='device "C" is not there'):
        transport("openmpd:C")


def test_a_system_without_libusb(monkeypatch):
    # pyftdi's own error, at the first use of a chip.
    monkeypatch.setattr(fifo, "Ftdi", Ftdi)
    monkeypatch.setattr(UsbTools, "BACKENDS", ())
    UsbTools.release_all_devices()
    with pytest.raises(midair.BoardError, match=r'^device "A" needs libusb, which this system lacks: \S'):
        transport("openmpd:A")


@pytest.mark.parametrize(
    ("failing", "kind"),
    [
        (USBTimeoutError("timed out", errno=110), midair.BoardTimeout),
        (USBError("No such device", errno=19), midair.BoardLost),
    ],
)
def test_a_chip_that_fails_does_not_keep_the_other_on(chips, failing, kind):
    pair, board = transport("openmpd:A+B")
    pair.play(bytes(1024))
    chips["A"].failing = failing
    chips["B"].written.clear()
    with pytest.raises(kind, match='device "A"'):
        pair.silence()
    assert chips["B"].written == board.silence[: len(board.silence) // 2]
    pair.close()


def test_what_it_cannot_do():
    pair, _ = transport("openmpd:A")
    with pytest.raises(midair.BoardError, match="cannot modulate"):
        pair.modulate(200)
    with pytest.raises(midair.BoardError, match="holds no sequence"):
        pair.upload(bytes(512), 1, 100.0)
