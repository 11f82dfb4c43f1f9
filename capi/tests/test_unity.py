"""The scripts of unity/, compiled and run by Mono with replacements of Unity's types, against the package."""

import os
import re
import socket
import threading
import tty
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import midair
from conftest import ROOT, need, run

# On a board with a single amplitude, the package warns that it plays louder than requested.
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")

UNITY = ROOT / "unity"

#: A library that replaces `ioctl`: calls for control lines do nothing and succeed. A pseudo-terminal has no
#: control lines, but Mono opens no port without them.
CONTROL_LINES = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdarg.h>
#include <sys/ioctl.h>
int ioctl(int port, unsigned long request, ...)
{
    int (*next)(int, unsigned long, void *) = (int (*)(int, unsigned long, void *))dlsym(RTLD_NEXT, "ioctl");
    va_list arguments;
    void *argument;

    va_start(arguments, request);
    argument = va_arg(arguments, void *);
    va_end(arguments);
    return request == TIOCMGET || request == TIOCMSET ? 0 : next(port, request, argument);
}
"""


@pytest.fixture(scope="module")
def program(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., str]:
    """Returns a function that runs the scripts in a program that tests them; compiler warnings are errors."""
    need("mcs", "mono")
    built = tmp_path_factory.mktemp("unity") / "scripts.exe"
    sources = sorted(path for name in ("Runtime", "Tests~", "Samples~") for path in (UNITY / name).rglob("*.cs"))
    run("mcs", "-warnaserror", "-r:System.dll", "-r:System.Core.dll", f"-out:{built}", *sources)

    def scripts(*words: str, given: str = "", **environment: str) -> str:
        return run("mono", built, *words, given=given, **{"LD_LIBRARY_PATH": str(prefix / "lib"), **environment})

    return scripts


def numbers(printed: str, name: str) -> list[np.ndarray]:
    """Returns the values of all lines that begin with a name."""
    lines = [line.split() for line in printed.splitlines()]
    return [np.array(words[1:], dtype=float) for words in lines if words[0] == name]


def logged(printed: str) -> list[str]:
    return [line.removeprefix("log ") for line in printed.splitlines() if line.startswith("log ")]


@pytest.fixture(scope="module")
def solved(program: Callable[..., str]) -> str:
    return program("solve")


def test_points_are_metres_in_the_arrays_own_right_handed_axes(solved: str) -> None:
    # A quarter turn about Unity's y maps local z to x, and local x to -z. Then y and z are exchanged.
    world = np.array([[0.32, 1.1, -0.24], [0.28, 1.1, -0.16]]) - [0.3, 0.8, -0.2]
    expected = np.stack([-world[:, 2], world[:, 0], world[:, 1]], axis=1) / 2
    first, second = (points.reshape(-1, 3) for points in numbers(solved, "points"))
    np.testing.assert_allclose(first, expected, atol=1e-7)
    np.testing.assert_allclose(second - first, [[0, 0, 0.01], [0, 0, 0]], atol=1e-7)


def test_the_array_lies_where_its_object_is(solved: str) -> None:
    (transducers,) = numbers(solved, "transducers")
    x, y, z = midair.Array.preset("sonicsurface").positions.T
    expected = np.stack([0.3 + 2 * y, 0.8 + 2 * z, -0.2 - 2 * x], axis=1)
    np.testing.assert_allclose(transducers.reshape(-1, 3), expected, atol=1e-6)


def solution(points: np.ndarray) -> midair.Solution:
    array = midair.Array.preset("sonicsurface")
    scene = midair.Scene(array, points.reshape(-1, 3), pressures=[1000, 800], temperature=25)
    return midair.solve(scene, "uniform")


def complexes(numbers: np.ndarray) -> np.ndarray:
    return numbers.astype(np.float32).view(np.complex64)


def test_two_foci_that_move_have_the_drives_of_the_package(solved: str) -> None:
    steps = zip(*(numbers(solved, name) for name in ("points", "drive", "answer")), strict=True)
    for points, drive, answer in steps:
        own = solution(points)
        assert np.array_equal(complexes(drive), own.drive)
        metrics = own.metrics
        assert [*answer] == [0, own.scale, metrics.accuracy, metrics.level, metrics.leak]


def test_points_at_rest_are_not_solved_again(solved: str) -> None:
    assert numbers(solved, "unmoved")[0] == [7]


def test_the_gizmo_shows_the_field_of_its_plane(solved: str) -> None:
    (values,), (alphas,) = numbers(solved, "values"), numbers(solved, "alphas")
    # The plane is turned with the array: its x and y are midair's x and z. The array's scale is 2, so lengths
    # in midair are half of those in Unity.
    x, z = ((np.arange(count) - 0.5 * (count - 1)) * 0.005 for count in (6, 5))
    places = [[across, 0, 0.15 + up] for up in z for across in x]
    expected = np.abs(solution(numbers(solved, "last")[0]).field(places).pressure)
    np.testing.assert_allclose(values, expected, rtol=1e-4, atol=0.1)
    np.testing.assert_allclose(alphas, values / values.max(), rtol=1e-6)


def drive_of(printed: str) -> np.ndarray:
    assert [line for line in logged(printed) if line.startswith("error")] == []
    return complexes(numbers(printed, "drive")[0])


def test_a_serial_board_gets_silence_frames_and_silence(program: Callable[..., str], tmp_path: Path) -> None:
    need("cc")
    (tmp_path / "lines.c").write_text(CONTROL_LINES, "utf-8")
    run("cc", "-shared", "-fPIC", "-o", tmp_path / "lines.so", tmp_path / "lines.c", "-ldl")
    master, slave = os.openpty()
    tty.setraw(slave)
    received = bytearray()

    def read() -> None:
        while not received.endswith(b"the end"):
            received.extend(os.read(master, 4096))

    reader = threading.Thread(target=read)
    reader.start()
    try:
        printed = program("play", "sonicsurface", os.ttyname(slave), LD_PRELOAD=str(tmp_path / "lines.so"))
    finally:
        os.write(slave, b"the end")
        reader.join()
        os.close(master)
        os.close(slave)
    board = midair.Board("sonicsurface")
    frame, off = bytes(board.encode(drive_of(printed))), bytes(board.silence)
    words = bytes(received).removesuffix(b"the end").replace(frame, b"F").replace(off, b"o").decode()
    # While Unity is paused, the board is off.
    assert re.fullmatch(r"o+F[Fo]*o+F+o+", words)
    assert words.count("F") > 5


def words_of(datagram: bytes) -> list[str | float]:
    """Returns the words of an OSC message: its address and its arguments, texts or floats."""
    words: list[str | float] = []

    def text() -> str:
        nonlocal datagram
        word, _, _ = datagram.partition(b"\0")
        datagram = datagram[len(word) // 4 * 4 + 4 :]
        return word.decode()

    words.append(text())
    for kind in text().removeprefix(","):
        if kind == "s":
            words.append(text())
        else:
            words.append(float(np.frombuffer(datagram[:4], ">f4")[0]))
            datagram = datagram[4:]
    assert not datagram
    return words


def test_midair_serve_gets_points_by_osc_and_then_off(program: Callable[..., str]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        server.bind(("127.0.0.1", 0))
        server.setblocking(False)
        drive_of(program("play", "autd3", f"osc://127.0.0.1:{server.getsockname()[1]} token To-ken"))
        messages = []
        with suppress(BlockingIOError):
            while True:
                messages.append(words_of(server.recv(4096)))
    *rows, off = messages
    assert len(rows) >= 20
    for address, token, *row in rows:
        assert (address, token) == ("/midair/rows", "To-ken")
        assert row == [0, 0, float(np.float32(0.15)), 1000]
    assert off == ["/midair/off", "To-ken"]


def test_a_tracked_palm_plays_while_it_is_in_the_button(program: Callable[..., str]) -> None:
    """A drawn track in place of OpenXR: from the side into the button, through it, and away."""
    side = [[0.06 - 0.002 * step, 0.01, 0.15] for step in range(25)]
    track = [*side, *([0.01, 0.01, 0.15 - 0.002 * step] for step in range(15)), None, None]
    # The array is 0.7 m above the floor; in Unity y is up.
    lines = [f"{place[0]} {place[2] + 0.7} {place[1]}" if place else "" for place in track]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        server.bind(("127.0.0.1", 0))
        server.setblocking(False)
        address = f"osc://127.0.0.1:{server.getsockname()[1]} token To-ken"
        logged_lines = logged(program("hand", address, given="\n".join(lines) + "\n"))
        messages = []
        with suppress(BlockingIOError):
            while True:
                messages.append(words_of(server.recv(4096)))
    assert [line for line in logged_lines if line.startswith("error")] == []
    wanted = [place for place in track if place and np.hypot(*place[:2]) < 0.03 and 0.13 < place[2] < 0.17]
    rows = [message[2:5] for message in messages if message[0] == "/midair/rows"]
    np.testing.assert_allclose(rows, wanted, atol=1e-6)
    names = [message[0] for message in messages]
    assert names[0] == "/midair/modulation"
    assert messages[0][1:] == ["To-ken", 200]
    assert names[-1] == "/midair/off"


def test_midair_serve_plays_what_it_gets(program: Callable[..., str]) -> None:
    pytest.importorskip("websockets")
    pytest.importorskip("pythonosc")
    from midair._serve.life import SILENCE
    from midair._serve.live import Live
    from midair._serve.server import PointServer

    with midair.connect("sonicsurface:loop", hold=SILENCE) as board, PointServer(Live(board)) as server:
        states = []
        watching = threading.Event()

        def watch() -> None:
            while not watching.wait(0.02):
                states.append(board.state)

        watcher = threading.Thread(target=watch)
        watcher.start()
        program("play", "sonicsurface", f"osc://127.0.0.1:{server.osc} token {server.token}")
        watching.set()
        watcher.join()
        assert {*states} == {"off", "playing"}
        assert board.state == "off"


def test_lines_that_cannot_play_are_refused(program: Callable[..., str]) -> None:
    def refusal(board: str, address: str) -> list[str]:
        return [line for line in logged(program("play", board, address)) if line.startswith("error")]

    assert refusal("autd3", "osc://127.0.0.1:49120") == [
        'error: address is "osc://127.0.0.1:49120": give the whole line of `midair serve`, '
        "osc://127.0.0.1:PORT token TOKEN"
    ]
    assert refusal("autd3", "/dev/ttyUSB7") == [
        "error: autd3 is not at one serial port: run `midair serve --on autd3` and give the line that it prints"
    ]
    (line,) = refusal("sonicsurface", "/dev/no-port")
    assert line.startswith("error: /dev/no-port: ")


def test_what_the_library_refuses_is_one_line_in_the_console(program: Callable[..., str]) -> None:
    assert "code unknown" in program("code").splitlines()
    lines = [line for line in logged(program("refuse")) if "no such amplitude" not in line]
    beginnings = [
        'error: unknown board "sonicsurfaces": did you mean sonicsurface?',
        'error: unknown solver "uniferm": did you mean uniform?',
        "error: pressures has 2 entries: give 1, or 1 as foci has",
        "error: points[0].pressure is NaN: give a finite number",
        "warning: points[0].pressure is 1000000 Pa, beyond reach: ",
        "warning: the pressures are missed by ",
        "error: foci[0] is empty: give a transform",
        "error: the gizmo has 0 cells in 0.06 by 0.05: give ",
    ]
    assert len(lines) == len(beginnings)
    for line, beginning in zip(lines, beginnings, strict=True):
        assert line.startswith(beginning)


def test_a_missing_library_is_one_line_with_its_cure(program: Callable[..., str]) -> None:
    lines = logged(program("refuse", LD_LIBRARY_PATH=""))
    assert lines[0] == (
        "error: the library midair is missing from Runtime/Plugins: run `make unity` in midair's repository"
    )
