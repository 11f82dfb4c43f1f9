"""AUTD3 boards over UDP: every frame arrives even if datagrams are lost, and boards that no longer reply are
reported.

MIDAIR_SLOW=1 sends 10,000 frames instead of 300, and ends programs in more ways.
"""

import gc
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from itertools import groupby

import numpy as np
import pytest

import midair
from autd3_emulators import BUILT, Built, Packaged
from autd3_wire import BOARDS, FRAME, Wire, described
from midair._boards import autd3_chain
from midair._boards.autd3 import Autd3Transport
from midair._boards.errors import BoardError, BoardLost, BoardNotFound

SLOW = bool(os.environ.get("MIDAIR_SLOW"))
FRAMES = 10_000 if SLOW else 300
SIZE = 498


def one_in(count: int, seed: int = 1) -> Callable[[bytes], bool]:
    """Returns a random choice of the datagrams to drop: one in `count`."""
    chance = random.Random(seed)
    return lambda _: chance.random() * count < 1


def frames_only(data: bytes) -> bool:
    return data[1] == FRAME


def frames(count: int, seed: int = 1) -> list[bytes]:
    codes = np.random.default_rng(seed).integers(1, 256, (count, BOARDS * SIZE), np.uint8)
    return [row.tobytes() for row in codes]


@pytest.fixture(scope="module", params=["package", "0.12", "0.13"])
def emulator(request: pytest.FixtureRequest) -> Iterator[Packaged | Built]:
    if request.param != "package" and not BUILT.exists():
        pytest.skip("`make test-boards` builds the makers' emulators")
    made = Packaged(BOARDS) if request.param == "package" else Built(request.param, BOARDS)
    yield made
    made.close()


@pytest.fixture
def wire(emulator: Packaged | Built) -> Iterator[Wire]:
    made = Wire(emulator.address)
    yield made
    made.close()


@pytest.fixture
def boards(wire: Wire) -> Iterator[Autd3Transport]:
    made = described(f"autd3:{wire.address}")
    wire.reported.clear()
    yield made
    made.close()


def each_board(wire: Wire) -> list[list[bytes]]:
    """Returns the frames that each board received, in order; repetitions of a frame count once."""
    assert len(wire.reported) == BOARDS
    return [[codes for codes, _ in groupby(reported)] for reported in wire.reported.values()]


def wanted(sent: list[bytes]) -> list[list[bytes]]:
    return [[frame[k * SIZE : (k + 1) * SIZE] for frame in sent] for k in range(BOARDS)]


def silent(codes: bytes) -> bool:
    return codes[249:] == bytes(249)


@pytest.mark.slow
def test_every_frame_comes_once(wire: Wire, boards: Autd3Transport) -> None:
    sent = frames(FRAMES)
    for frame in sent:
        boards.play(frame)
    assert sorted(each_board(wire)) == sorted(wanted(sent))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_every_frame_comes_where_datagrams_are_lost(wire: Wire, seed: int) -> None:
    wire.lose = one_in(100, seed)
    boards = described(f"autd3:{wire.address}")
    wire.reported.clear()
    sent = frames(FRAMES)
    for frame in sent:
        boards.play(frame)
    said = each_board(wire)
    boards.close()
    assert wire.lost > FRAMES // 50
    assert sorted(said) == sorted(wanted(sent))


@pytest.mark.slow
def test_sequences_and_modulation_come_where_datagrams_are_lost(wire: Wire, boards: Autd3Transport) -> None:
    wire.lose = one_in(100)
    boards.upload(b"".join(frames(300)), 300, 20000)
    boards.modulate(37.3)
    boards.play(frames(1)[0])
    boards.modulate(None)
    boards.upload(b"".join(frames(2)), 2, 40)
    assert wire.lost > 3


@pytest.mark.slow
def test_opening_and_closing_leave_the_boards_silent(wire: Wire) -> None:
    boards = described(f"autd3:{wire.address}")
    assert all(silent(reported[-1]) for reported in each_board(wire))
    wire.reported.clear()
    boards.play(frames(1)[0])
    assert not any(silent(reported[-1]) for reported in each_board(wire))
    boards.close()
    assert all(silent(reported[-1]) for reported in each_board(wire))
    boards.close()
    for ask in (lambda: boards.play(frames(1)[0]), boards.silence, lambda: boards.modulate(None)):
        with pytest.raises(BoardLost, match="closed; connect again"):
            ask()


@pytest.mark.slow
def test_silence_comes_at_once_and_again(wire: Wire, boards: Autd3Transport) -> None:
    for stir in (
        lambda: boards.play(frames(1)[0]),
        lambda: boards.upload(b"".join(frames(9)), 9, 4000),
        lambda: None,
    ):
        stir()
        begin = time.perf_counter()
        boards.silence()
        assert time.perf_counter() - begin < 0.2
        assert all(silent(reported[-1]) for reported in each_board(wire))


@pytest.mark.slow
def test_what_is_under_way_does_not_come_after_silence(wire: Wire, boards: Autd3Transport) -> None:
    first, second = frames(2)
    boards.play(first)
    wire.lose = frames_only
    player = threading.Thread(target=boards.play, args=(second,))
    player.start()
    time.sleep(0.03)
    threading.Timer(0.03, lambda: setattr(wire, "lose", lambda _: False)).start()
    boards.silence()
    player.join()
    time.sleep(0.05)
    for reported, begun in zip(sorted(each_board(wire)), sorted(wanted([first])), strict=True):
        assert reported[0] == begun[0]
        assert silent(reported[-1])
        assert not any(map(silent, reported[:-1]))


@pytest.mark.slow
def test_lost_boards_are_reported_and_left(wire: Wire, boards: Autd3Transport) -> None:
    """Drops all frames but no heartbeats. Heartbeats must stop, or the boards would play on for ever."""
    gc.disable()
    boards.play(frames(1)[0])
    time.sleep(0.1)
    assert wire.heartbeats > 2
    wire.lose = frames_only
    begin = time.perf_counter()
    with pytest.raises(BoardLost, match=r"autd3:\[::1\]:\d+: board \d did not reply within 300 ms: unplugged") as kept:
        boards.play(frames(1)[0])
    assert time.perf_counter() - begin < 2
    time.sleep(0.05)
    before = wire.heartbeats
    time.sleep(0.3)
    assert wire.heartbeats == before, kept
    gc.enable()
    with pytest.raises(BoardLost, match="connect again"):
        boards.silence()
    begin = time.perf_counter()
    boards.close()
    assert time.perf_counter() - begin < 0.1


@pytest.mark.slow
def test_a_dead_line_is_reported_within_half_a_second_and_closes(wire: Wire) -> None:
    for ask in ("play", "close"):
        wire.lose = lambda _: False
        boards = described(f"autd3:{wire.address}")
        wire.lose = lambda _: True
        begin = time.perf_counter()
        if ask == "close":
            boards.close()
        else:
            with pytest.raises(BoardLost):
                boards.play(frames(1)[0])
        assert time.perf_counter() - begin < 1.5
        boards.close()


@pytest.mark.slow
def test_boards_that_rebooted_are_lost_and_come_back(
    emulator: Packaged | Built, wire: Wire, boards: Autd3Transport
) -> None:
    boards.play(frames(1)[0])
    emulator.reboot(1)

    def play_on() -> None:
        for frame in frames(100):
            boards.play(frame)
            time.sleep(0.01)

    with pytest.raises(BoardLost, match=r"board 1 .*: unplugged, rebooted"):
        play_on()
    assert any(silent(reported[-1]) for reported in each_board(wire))
    again = described(f"autd3:{wire.address}")
    again.play(frames(1)[0])
    again.close()


@pytest.mark.slow
def test_boards_without_a_word_mute_themselves_until_they_are_opened(
    emulator: Packaged | Built, wire: Wire, boards: Autd3Transport
) -> None:
    if isinstance(emulator, Packaged):
        pytest.skip("its state cannot be read")
    (codes,) = frames(1)
    boards.play(codes)
    time.sleep(0.7)
    assert not any(device["failsafe"] for device in emulator.state())
    wire.lose = lambda _: True
    begin = time.perf_counter()
    while not all(device["failsafe"] for device in emulator.state()):
        assert time.perf_counter() - begin < 2
        time.sleep(0.01)
    assert time.perf_counter() - begin > 0.4
    with pytest.raises(BoardLost):
        boards.look()
    wire.lose = lambda _: False
    again = described(f"autd3:{wire.address}")
    again.play(codes)
    assert not any(device["failsafe"] for device in emulator.state())
    assert "".join(device["slots"][0] for device in emulator.state()) == codes.hex()
    again.close()


def test_boards_that_are_not_there_are_reported() -> None:
    with pytest.raises(
        BoardNotFound,
        match=r"autd3: no AUTD3 board answers; the array stands for 2 boards: .* speaks EtherCAT",
    ):
        described("autd3")


@pytest.mark.slow
def test_a_missing_board_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(autd3_chain, "ENUMERATION", 1)
    alone = Packaged(1)
    with pytest.raises(BoardNotFound, match=r"only 1 AUTD3 board answered; the array stands for 2 boards: check power"):
        described(f"autd3:{alone.address}")


@pytest.mark.slow
def test_a_board_too_many_is_reported() -> None:
    more = Packaged(3)
    with pytest.raises(BoardNotFound, match="more than 2 AUTD3 boards answered; the array stands for 2"):
        described(f"autd3:{more.address}")


PROGRAM = """
import sys, time, midair
array = midair.Array.preset("autd3", tiles=(2, 1))
boards = midair.connect(sys.argv[1], array=array)
boards.send([1.0] * 498)
print("plays", flush=True)
time.sleep(60)
"""


@pytest.mark.slow
@pytest.mark.parametrize("end", ["SIGKILL", "SIGTERM", "SIGINT"] if SLOW else ["SIGKILL"])
def test_boards_are_silent_when_their_program_is_ended(wire: Wire, end: str) -> None:
    command = [sys.executable, "-c", PROGRAM, f"autd3:{wire.address}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as program:
        assert program.stdout
        assert program.stdout.readline() == b"plays\n"
        assert not any(silent(reported[-1]) for reported in each_board(wire))
        program.send_signal(signal.Signals[end])
        begin = time.perf_counter()
        while not all(silent(reported[-1]) for reported in each_board(wire)) and time.perf_counter() - begin < 2:
            time.sleep(0.005)
        assert time.perf_counter() - begin < 0.25
        assert program.wait(5) != 0


@pytest.mark.slow
def test_a_connection_plays_on_the_emulator(wire: Wire) -> None:
    array = midair.Array.preset("autd3", tiles=(BOARDS, 1))
    drives = np.exp(2j * np.pi * np.random.default_rng(1).integers(0, 256, (5, len(array))) / 256)
    with midair.connect(f"autd3:{wire.address}", array=array) as boards:
        wire.reported.clear()
        boards.stream(drives, rate=50, late="wait")
        assert sorted(each_board(wire)) == sorted(wanted([boards.board.encode(drive) for drive in drives]))
        assert boards.emitting == pytest.approx(drives[-1], abs=1e-6)
        boards.modulate(200)
        assert boards.state == "modulating"
        with pytest.raises(BoardError, match="modulation at 1001 Hz: an AUTD3 board modulates at"):
            boards.modulate(1001)
        boards.send(drives[0])
        boards.off()
        assert boards.state == "off"
        assert all(silent(reported[-1]) for reported in each_board(wire))
        boards.send(drives[0])
    assert all(silent(reported[-1]) for reported in each_board(wire))


@pytest.mark.slow
def test_the_emulator_has_an_address() -> None:
    boards = described("autd3:emulator")
    boards.play(frames(1)[0])
    boards.modulate(200)
    boards.upload(b"".join(frames(2)), 2, 100)
    boards.silence()
    with pytest.raises(BoardError, match="1 frame for 2 AUTD3 boards: 10 bytes, not 996"):
        boards.play(bytes(10))
    boards.close()
