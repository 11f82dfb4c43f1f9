"""AUTD3 boards of both firmwares get the steps that golden/autd3 contains; for other firmwares, the error
message names the firmware.

`make gateware` writes golden/autd3: for each call in `autd3_fake.acts`, the steps, and the state of the
makers' emulators after it.
"""

import json
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from autd3_fake import Fake, acts, read
from midair._boards import autd3 as module
from midair._boards.autd3 import Autd3Transport
from midair._boards.errors import BoardError, BoardLost

RECORDS = Path(__file__).parents[2] / "golden" / "autd3"
FIRMWARE = {3: "0.12", 5: "0.13"}
BOARDS, SIZE = 2, 498


@pytest.fixture(autouse=True)
def no_step_is_sent_again_on_a_busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "ACKNOWLEDGED", 0.2)


@pytest.fixture(params=FIRMWARE)
def fake(request: pytest.FixtureRequest) -> Iterator[Fake]:
    made = Fake(request.param, BOARDS)
    yield made
    made.close()


@pytest.mark.slow
def test_boards_get_the_recorded_steps(fake: Fake) -> None:
    rows = json.loads((RECORDS / f"{FIRMWARE[fake.versions[0]]}.json").read_text("utf-8"))
    transport = Autd3Transport(fake.address, BOARDS)
    for act, row in zip(acts(transport), rows, strict=True):
        act()
        assert [[step.hex() for step in each] for each in fake.steps] == row["steps"]
        for each in fake.steps:
            each.clear()


#: All codes of the seven frames. EXPECTED has, for each act: the frames that play, the number of ultrasound
#: periods of each frame, the modulation, and the silencer's steps.
CODES = bytes(k * k % 251 for k in range(7 * BOARDS * SIZE))
SLOW = 65535
SINE = np.floor(127.5 * (1 + np.sin(2 * np.pi * np.arange(80) * 3 / 80)) + 0.5).astype(np.uint8).tobytes()
EXPECTED = [
    (None, SLOW, b"\xff\xff", [10, 40]),
    ([0], SLOW, b"\xff\xff", [10, 40]),
    ([1, 2, 3, 4, 5], 3, b"\xff\xff", [3, 3]),
    ([1, 2, 3, 4, 5], 3, SINE, [3, 3]),
    ([6], SLOW, SINE, [10, 40]),
    ([6], SLOW, b"\xff\xff", [10, 40]),
    (None, SLOW, b"\xff\xff", [10, 40]),
    (None, SLOW, b"\xff\xff", [10, 40]),
]


@pytest.mark.parametrize("firmware", FIRMWARE.values())
def test_the_makers_emulators_had_what_was_meant(firmware: str) -> None:
    rows = json.loads((RECORDS / f"{firmware}.json").read_text("utf-8"))
    for row, (frames, divider, samples, steps) in zip(rows, EXPECTED, strict=True):
        for k, device in enumerate(row["devices"]):
            parts = [CODES[(f * BOARDS + k) * SIZE :][:SIZE] for f in frames] if frames else [bytes(SIZE)]
            assert device["slots"] == [part.hex() for part in parts]
            assert (device["divider"], device["silencer"], device["failsafe"]) == (divider, steps, False)
            assert device["modulation"] == samples.hex()
            assert device["sampling"] == 10 or set(samples) == {255}


@pytest.mark.parametrize(
    ("version", "reported"),
    [
        (
            2,
            "speaks UDP protocol 2 (firmware 0.11.0), midair 5 (firmware 0.13) and 3 (firmware 0.12): put",
        ),
        (7, "speaks UDP protocol 7, midair 5 (firmware 0.13) and 3 (firmware 0.12): put one of these on it"),
    ],
)
def test_other_firmware_is_named(version: int, reported: str) -> None:
    fake = Fake(version, 1, bytes([0, 11, 0, 0, 11, 0]))
    with pytest.raises(BoardError) as caught:
        Autd3Transport(fake.address, 1)
    assert reported in str(caught.value)
    fake.close()


def test_boards_of_two_firmwares_are_refused() -> None:
    fake = Fake(5, BOARDS)
    fake.versions[1] = 3
    with pytest.raises(BoardError, match="a board speaks UDP protocol 3, another 5: put the same firmware on all"):
        Autd3Transport(fake.address, BOARDS)
    fake.versions[1] = 5
    fake.firmware = bytes([0, 13, 1, 0, 12, 0])
    with pytest.raises(BoardError, match=r"board 0 has firmware 0.13.1 in its processor, 0.12.0 in its FPGA"):
        Autd3Transport(fake.address, BOARDS)
    fake.close()


def test_what_a_board_refuses_is_named(fake: Fake) -> None:
    # The second board replies 0x14 to its first step, CLEAR or RESET: its clock is not synchronous yet.
    fake.refusals = [0, 0x14]
    transport = Autd3Transport(fake.address, BOARDS)
    assert fake.refusals == []
    for status, why in ((0x10, "its FPGA is being updated"), (0x33, "error 51")):
        fake.refusals = [status] * BOARDS
        with pytest.raises(BoardError, match=f"board 0 refuses PATTERN: {why}"):
            transport.play(bytes(BOARDS * SIZE))
    transport.play(bytes(BOARDS * SIZE))
    transport.close()


def test_a_board_that_mutes_itself_is_lost(fake: Fake) -> None:
    transport = Autd3Transport(fake.address, BOARDS)
    fake.flags = module.MUTED

    def look() -> None:
        for _ in range(40):
            transport.look()
            time.sleep(0.05)

    with pytest.raises(BoardLost, match=r"board \d has muted itself; .* connect again"):
        look()
    transport.close()


def test_a_board_that_drops_a_step_gets_it_again() -> None:
    """Checks that a board gets a dropped step again.
    Protocol 3 counts steps, so a wrong count shows the loss.
    """
    fake = Fake(3, 1)
    transport = Autd3Transport(fake.address, 1)
    fake.skips = 2
    transport.play(bytes(range(249)) * 2)
    assert [read(step)[:2] for step in fake.steps[0][-4:]] == [(4, 0x16), *[(5, 0x16)] * 3]
    transport.close()
    fake.close()
