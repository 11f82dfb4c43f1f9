"""Connections without a device: addresses, arguments, streams, limits, the option `hold`, files."""

import json
import os
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest

import midair
from midair._boards.address import parse

ONES = np.ones(256)


@pytest.fixture
def loop():
    with midair.connect("sonicsurface:loop") as loop:
        yield loop


@pytest.mark.parametrize(
    ("address", "board", "kind", "where"),
    [
        ("autd3", "autd3", "udp", ""),
        ("autd3:emulator", "autd3", "udp", "emulator"),
        ("autd3:[fe80::1]:5000", "autd3", "udp", "[fe80::1]:5000"),
        ("autd3:null", "autd3", "null", ""),
        ("sonicsurface:/dev/ttyUSB0", "sonicsurface", "serial", "/dev/ttyUSB0"),
        ("sonicsurface_pair:COM3", "sonicsurface_pair", "serial", "COM3"),
        ("sonicsurface:loop", "sonicsurface", "loop", ""),
        ("openmpd:A1", "openmpd", "fifo", "A1"),
        ("openmpd:A1+B2", "openmpd_pair", "fifo", "A1+B2"),
        ("mega64:/dev/ttyACM0", "mega64", "serial", "/dev/ttyACM0"),
        ("nano16:/dev/ttyACM0", "nano16", "serial", "/dev/ttyACM0"),
        ("nano:/dev/ttyACM0", "nano", "serial", "/dev/ttyACM0"),
        ("homies:A", "homies", "fifo", "A"),
        ("null", None, "null", ""),
        ("file:/tmp/a:b.bin", None, "file", os.path.abspath("/tmp/a:b.bin")),
    ],
)
def test_addresses(address, board, kind, where):
    found = parse(address)
    assert (found.board, found.kind, found.where) == (board, kind, where)


@pytest.mark.parametrize(
    ("address", "message"),
    [
        (
            "sonic:/dev/ttyUSB0",
            "there is no such board, did you mean sonicsurface. give one of null, file:PATH, autd3,",
        ),
        ("", "there is no such board"),
        ("/dev/ttyUSB0", "write the board before its port, as in sonicsurface:/dev/ttyUSB0"),
        ("sonicsurface", "the place of the board is left out, give sonicsurface:PORT or sonicsurface:loop"),
        ("openmpd:", "openmpd:SERIAL"),
        ("openmpd:A+B+C", "give 2 serial numbers"),
        ("file:", "give file:PATH"),
        (None, "address is None: give text"),
    ],
)
def test_addresses_that_are_none(address, message):
    with pytest.raises(midair.SceneError, match=message) as caught:
        midair.connect(address)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"hold": 0}, "hold is 0: give a number above 0"),
        ({"hold": np.nan}, "hold is nan"),
        ({"board": "mega64"}, "names another"),
        ({"board": midair.Board("mega64")}, "names another"),
        ({"board": midair.Board("sonicsurface"), "array": midair.Array.preset("autd3")}, "leave one of them"),
        ({"limit": 3}, "limit is 3: give"),
        ({"limit": {"positions": [[0, 0, 0.1]]}}, "limit is"),
        ({"limit": {"positions": [[0, 0]], "pressure": 1}}, "limit.* is"),
        (
            {"limit": {"positions": [[0, 0, 0.1]], "pressure": -1}},
            'limit\\["pressure"\\] is -1.0: give numbers of at least 0',
        ),
        ({"limit": {"positions": [[0, 0, 0.1]], "pressure": "much"}}, "limit.* is"),
        ({"limit": {"positions": [[0, 0, 0.1]], "pressure": 1, "heat": 3}}, "limit is"),
    ],
)
def test_arguments_that_are_refused(keywords, message):
    with pytest.raises(midair.SceneError, match=message) as caught:
        midair.connect("sonicsurface:null", **keywords)
    assert "\n" not in str(caught.value)


def test_what_is_sent_is_emitted(loop):
    assert loop.state == "off"
    assert loop.emitting.shape == (256,)
    assert not loop.emitting.any()
    solution = midair.solve(midair.Scene(loop.board.array, [[0.01, 0, 0.15]]))
    loop.send(solution)
    np.testing.assert_allclose(loop.emitting, solution.drive, atol=1e-6)
    assert loop.state == "playing"
    loop.off()
    assert (loop.state, loop.emitting.any()) == ("off", False)
    loop.send(solution.drive)
    loop.close()
    assert (loop.state, loop.emitting.any()) == ("closed", False)
    assert loop.stats.frames == 2
    with pytest.raises(midair.BoardError, match="this connection is closed: connect again"):
        loop.send(ONES)
    loop.close()
    assert "closed" in repr(loop)


def test_drives_that_are_refused_change_nothing(loop):
    loop.send(ONES)
    for drive in (np.ones(255), np.full(256, np.nan), np.full(256, 2.0), "loud"):
        with pytest.raises((midair.SceneError, TypeError)):
            loop.send(drive)
    np.testing.assert_allclose(loop.emitting, 1, atol=1e-6)


def test_a_solution_for_another_array_is_refused(loop):
    other = midair.Array.grid(16, 16, 10e-3)
    near = midair.Array.grid(16, 16, 10.7e-3)
    solution = midair.solve(midair.Scene(other, [[0, 0, 0.15]]))
    with pytest.raises(midair.SceneError, match=r"transducer \d+ stands 5\.303 mm from its place on the board"):
        loop.send(solution)
    solution = midair.solve(midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]]))
    with pytest.raises(midair.SceneError, match="249 transducers, the board has 256: solve"):
        loop.send(solution)
    with pytest.raises(midair.SceneError, match="give the places and order of sonicsurface, to 3 mm"):
        midair.connect("sonicsurface:loop", array=other)
    with midair.connect("sonicsurface:loop", array=near) as mine:
        mine.send(midair.solve(midair.Scene(near, [[0, 0, 0.15]])))
        assert mine.state == "playing"


def frames(array, count, rate):
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    points = np.stack([0.01 * np.cos(angle), 0.01 * np.sin(angle), 0.15 + 0 * angle], axis=1)
    gains = midair.Scene(array, points).propagation()
    drives = (gains / abs(gains)).conj()
    return midair.Sequence(array, points[:, None], 1000.0, drives, rate=rate)


@pytest.mark.slow
def test_a_sequence_is_streamed_at_its_rate(loop):
    sequence = frames(loop.board.array, 15, 30)
    begin = time.monotonic()
    loop.stream(sequence)
    assert time.monotonic() - begin == pytest.approx(0.5, abs=0.1)
    drive = loop.board.decode(loop.board.encode(sequence.drive(14)))
    np.testing.assert_allclose(loop.emitting, drive, atol=1e-6)
    with pytest.raises(midair.SceneError, match="transducer"):
        loop.stream(frames(midair.Array.preset("autd3"), 3, 30))


def test_streams_of_every_kind(loop):
    loop.stream(np.ones((3, 256)))
    loop.stream([[1] * 256, [0] * 256])
    loop.stream(iter([ONES]))
    loop.stream([])
    scene = midair.Scene(loop.board.array, [[0, 0, 0.15]])
    loop.stream([midair.solve(scene)])
    assert loop.stats.frames == 7
    assert loop.state == "playing"


@pytest.mark.parametrize(
    ("drives", "keywords", "message"),
    [
        (np.ones(256), {}, r"drives is of shape \(256,\): give \(T, 256\)"),
        (3, {}, "drives is 3: give"),
        ([ONES], {"rate": 0}, "rate is 0"),
        ([ONES], {"late": "never"}, 'late is "never": give skip, wait, error'),
        ([ONES, np.ones(3)], {}, "256"),
    ],
)
def test_streams_that_are_refused(loop, drives, keywords, message):
    with pytest.raises(midair.SceneError, match=message):
        loop.stream(drives, **keywords)


def test_what_a_board_cannot_do_is_one_line(loop):
    with pytest.raises(midair.BoardError, match="sonicsurface holds no sequence: use stream"):
        loop.upload(frames(loop.board.array, 3, 30))
    with pytest.raises(midair.SceneError, match="hz is 0"):
        loop.modulate(0)
    with (
        midair.connect("mega64:loop") as mega,
        pytest.raises(midair.BoardError, match="mega64 cannot modulate: stream"),
    ):
        mega.modulate(200)


@pytest.mark.slow
def test_an_uploaded_sequence_plays_by_itself():
    with midair.connect("null") as null:
        sequence = frames(null.board.array, 4, 8)
        with pytest.warns(midair.SceneWarning, match="begins anew with a jump of"):
            null.upload(sequence)
        begin = time.monotonic()
        assert null.state == "playing"
        seen = {np.round(null.emitting, 3).tobytes()}
        while time.monotonic() < begin + 0.6:
            seen.add(np.round(null.emitting, 3).tobytes())
        assert len(seen) == 4
        null.modulate(150)
        assert null.state == "modulating"


@pytest.mark.slow
def test_the_line_is_as_slow_as_its_board(loop):
    begin = time.monotonic()
    for _ in range(20):
        loop.send(ONES)
    assert 17 / 89.3 < time.monotonic() - begin < 0.6
    with midair.connect("sonicsurface:null") as null:
        begin = time.monotonic()
        for _ in range(20):
            null.send(ONES)
        assert time.monotonic() - begin < 17 / 89.3


@pytest.mark.slow
def test_hold_turns_off_until_the_next_frame():
    with midair.connect("sonicsurface:loop", hold=0.2) as loop:
        loop.send(ONES)
        time.sleep(0.1)
        assert loop.state == "playing"
        # Reading the state is no new frame: it does not restart the time of `hold`.
        time.sleep(0.2)
        assert loop.state == "off"
        assert not loop.emitting.any()
        assert loop.stats.lapses == 1
        loop.send(ONES)
        assert loop.state == "playing"
        loop.stream([ONES] * 10, rate=20)
        loop.stream(([ONES] * 2), rate=2)
        assert loop.state == "playing"
        assert loop.stats.lapses == 1


@pytest.mark.slow
@pytest.mark.parametrize("board", ["sonicsurface:loop", "mega64:loop"])
def test_off_again_and_again_makes_the_next_frame_wait_no_longer(board):
    with midair.connect(board) as loop:
        frame = np.ones(len(loop.board.array))
        for _ in range(60):
            loop.off()
        begin = time.monotonic()
        loop.send(frame)
        assert loop.state == "playing"
        assert time.monotonic() - begin < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("board", ["sonicsurface:loop", "openmpd:null", "null"])
def test_a_drive_that_is_sent_again_and_again_plays_on(board):
    with midair.connect(board, hold=0.2) as loop:
        frame = np.ones(len(loop.board.array))
        for _ in range(40):
            loop.send(frame)
            time.sleep(0.02)
        assert loop.state == "playing"


def test_a_limit_refuses_what_is_too_loud():
    array = midair.Board("sonicsurface").array
    ear = midair.ear([0.0, 0.1, 0.15])
    loud = midair.solve(midair.Scene(array, [[0.0, 0.1, 0.15]]))
    quiet = midair.solve(midair.Scene(array, [[0.0, 0.0, 0.15]]))
    for positions in (ear, ear.points, [0.0, 0.1, 0.15]):
        with midair.connect("sonicsurface:null", limit={"positions": positions, "pressure": 900}) as null:
            null.send(quiet)
            with pytest.raises(midair.BoardError, match=r"limit at \(.*\) m is 900 Pa, this drive makes") as reported:
                null.send(loud)
            np.testing.assert_allclose(null.emitting, quiet.drive, atol=1e-6)
            with pytest.raises(midair.BoardError, match="limit"):
                null.stream([quiet, loud])
            # A drive that is rejected during a stream turns the board off.
            assert null.state == "off"
    scene = midair.Scene(array, [[0.0, 0.1, 0.15]])
    pressure = abs(midair.field(scene, loud, [[0.0, 0.1, 0.15]]).pressure[0])
    assert f"{pressure:.4g} Pa" in str(reported.value)


def test_a_limit_in_the_air_that_is_there():
    array = midair.Board("sonicsurface").array
    place = [[0.0, 0.05, 0.15]]
    drive = midair.solve(midair.Scene(array, place)).drive
    in_it = abs(midair.field(midair.Scene(array, place, temperature=60), drive, place).pressure[0])
    limit = {"positions": place, "pressure": 1.001 * in_it}
    with midair.connect("sonicsurface:null", limit={**limit, "temperature": 60}) as null:
        null.send(drive)
    with midair.connect("sonicsurface:null", limit=limit) as null, pytest.raises(midair.BoardError):
        null.send(drive)


def test_each_place_has_its_own_limit():
    array = midair.Array.preset("sonicsurface")
    drive = midair.solve(midair.Scene(array, [[0, 0, 0.15]])).drive
    places = [[0, 0, 0.15], [0, 0.1, 0.15]]
    loud, soft = abs(midair.field(midair.Scene(array, places), drive, places).pressure)
    for order in (slice(None), slice(None, None, -1)):
        limit = {"positions": places[order], "pressure": [1.1 * loud, 0.9 * soft][order]}
        with (
            midair.connect("sonicsurface:null", limit=limit) as null,
            pytest.raises(midair.BoardError, match=r"limit at \(0, 0\.1, 0\.15\) m"),
        ):
            null.send(drive)


def test_a_file_begins_and_ends_off(tmp_path):
    path = tmp_path / "frames.bin"
    board = midair.Board("sonicsurface")
    codes = [board.encode(ONES), board.encode(-ONES)]
    with midair.connect(f"file:{path}", board="sonicsurface") as file:
        file.stream([ONES, -ONES])
        with pytest.raises(midair.BoardError, match="no modulation"):
            file.modulate(200)
    assert path.read_bytes() == b"".join([board.off_frame, *codes, board.off_frame])
    with pytest.raises(midair.BoardError, match="cannot be written"):
        midair.connect(f"file:{tmp_path}/none/frames.bin")
    with pytest.raises(midair.SceneError, match=r"give one that ends in \.bin"):
        midair.connect(f"file:{tmp_path}/mine.txt")


def test_a_board_that_is_louder_than_requested_is_reported_once():
    board = midair.Board("sonicsurface")
    soft = midair.Scene(board.array, [[0, 0, 0.15]], pressures=500)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        solution = midair.solve(soft)
    assert solution.scale < 0.3
    with midair.connect("sonicsurface:null") as null:
        with pytest.warns(midair.SceneWarning, match=r"plays 5\.4\d* times the requested pressures"):
            null.send(solution)
        null.send(solution)


@pytest.mark.slow
def test_ctrl_c_stops_a_stream_and_turns_it_off(loop):
    import signal

    threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT]).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        loop.stream(ONES for _ in range(10**9))
    assert time.monotonic() - begin < 0.8
    assert loop.state == "off"
    loop.send(ONES)
    assert loop.state == "playing"


def test_a_forked_child_does_not_speak_for_its_owner(loop):
    loop.send(ONES)
    script = "the child's word"
    read, write = os.pipe()
    with warnings.catch_warnings():
        # From Python 3.12 on, os.fork warns in programs with threads.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        try:
            loop.send(ONES)
        except midair.BoardError as error:
            script = str(error)
        loop.close()
        os.write(write, script.encode())
        os._exit(0)
    os.waitpid(child, 0)
    reported = os.read(read, 1000).decode()
    os.close(read)
    os.close(write)
    assert f"is that of process {os.getpid()}" in reported
    assert loop.state == "playing"


@pytest.mark.slow
def test_several_threads_may_send(loop):
    threads = [threading.Thread(target=lambda: [loop.send(ONES) for _ in range(5)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert loop.stats.frames == 20


def python(script, *paths):
    """Runs a script in a new interpreter and returns its output."""
    code = f"import sys; sys.path[:0] = {json.dumps([str(path) for path in paths])}\n{script}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True)
    return done.stdout.strip()


@pytest.mark.slow
def test_import_loads_no_link():
    loaded = python("import midair; print(sorted({'serial', 'pyftdi', 'usb', 'autd3'} & set(sys.modules)))")
    assert loaded == "[]"


@pytest.mark.slow
def test_a_guard_starts_without_numpy():
    script = """
import midair, subprocess, os
with midair.connect("sonicsurface:loop") as loop:
    print(open(f"/proc/{loop._guard._process.pid}/maps").read().count("numpy"))
"""
    if os.path.exists("/proc/self/maps"):
        assert python(script) == "0"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "call", "message"),
    [
        ("serial", 'connect("sonicsurface:/dev/ttyUSB0")', 'pip install "midair[serial]"'),
        ("serial", "ports()", 'pip install "midair[serial]"'),
        ("pyftdi", 'connect("openmpd:A")', 'pip install "midair[ftdi]"'),
    ],
)
def test_a_missing_extra_is_one_line(module, call, message):
    script = f"""
import importlib.util, midair, midair._boards.address
found = importlib.util.find_spec
importlib.util.find_spec = lambda name, *more: None if name == {module!r} else found(name, *more)
midair._boards.address.find_spec = importlib.util.find_spec
sys.modules[{module!r}] = None
try:
    midair.{call}
except midair.BoardError as error:
    print(error)
"""
    reported = python(script)
    assert reported.endswith(message)
    assert "\n" not in reported
