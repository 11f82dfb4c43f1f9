"""`midair boards`, `ports`, `play` and `off`, on links without a device."""

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import firmware
from midair import BoardError, ports

SCENE = '[array]\npreset = "sonicsurface"\n\n[[points]]\nposition = [0.0, 0.0, 0.15]\n'


def midair(*words: str, status: int = 0) -> subprocess.CompletedProcess[str]:
    done = subprocess.run([sys.executable, "-m", "midair", *words], capture_output=True, encoding="utf-8", timeout=60)
    assert done.returncode == status, done.stderr
    return done


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE, "utf-8")
    return path


@pytest.mark.slow
def test_boards_are_listed_and_reported() -> None:
    known = json.loads(midair("boards", "--json").stdout)
    assert set(known) == set(firmware.KINDS)
    assert known["sonicsurface"]["frame_bytes"] == 258
    assert known["mega64"]["phases"] == 10
    assert "230400 baud" in midair("boards", "sonicsurface_pair").stdout
    assert 'unknown board "sonicsurfac": did you mean sonicsurface?' in midair("boards", "sonicsurfac", status=2).stderr


@pytest.mark.slow
def test_ports_opens_none() -> None:
    assert isinstance(json.loads(midair("ports", "--json").stdout), list)


@pytest.mark.slow
def test_a_scene_a_drive_and_a_sequence_are_played(scene: Path, tmp_path: Path) -> None:
    reported = midair("play", str(scene), "--on", "sonicsurface:loop", "--for", "300ms", "--modulate", "200").stderr
    assert "dB SPL" in reported
    assert "1 frame, 0 late" in reported
    drive = tmp_path / "drive.npz"
    midair("solve", str(scene), "-o", str(drive))
    frames = tmp_path / "frames.bin"
    midair("play", str(drive), "--on", f"file:{frames}", "--for", "100ms", status=2)
    midair("play", str(drive), "--on", "sonicsurface:null", "--for", "100ms")
    motion = tmp_path / "motion.toml"
    motion.write_text(
        '[array]\npreset = "sonicsurface"\n\n[motion]\nrate = 40\nchange = 3.2\n\n'
        '[[motion.path]]\nkind = "line"\nstart = [0, 0, 0.15]\nend = [0.02, 0, 0.15]\nspeed = 0.04\n',
        encoding="utf-8",
    )
    found = re.search(r"(\d+) frames, (\d+) late", midair("play", str(motion), "--on", "sonicsurface:loop").stderr)
    assert found is not None
    # A busy machine skips frames, and counts them.
    assert int(found[1]) + int(found[2]) == 21


@pytest.mark.slow
def test_ctrl_c_turns_off(scene: Path) -> None:
    program = subprocess.Popen(
        [sys.executable, "-m", "midair", "play", str(scene), "--on", "sonicsurface:loop"],
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    assert program.stderr is not None
    assert "playing" in program.stderr.readline()
    begin = time.monotonic()
    program.send_signal(signal.SIGINT)
    rest = program.communicate(timeout=20)[1]
    assert program.returncode == 130
    assert "off after" in rest
    assert time.monotonic() - begin < 5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--on", "sonicsurface:loop", "--for", "ten"], '--for is "ten": give a time such as'),
        (["--on", "nano:loop"], "transducers is 256: nano has 1 to 8 channels"),
        (["--on", "autd3:loop"], "array has 256 transducers: each autd3 has 249: give whole boards"),
        (["--on", "sonicsurface:/dev/no-such-port"], 'port "/dev/no-such-port" is not there'),
        (["--on", "surface:loop"], "there is no such board"),
        (["--on", "openmpd:loop", "--modulate", "200"], "openmpd cannot modulate"),
        (["--on", "openmpd_pair:loop", "--modulate", "200"], "openmpd cannot modulate"),
        (["--on", "sonicsurface:loop", "--modulate", "nan"], "--modulate is nan: give a finite number"),
        (["--on", "sonicsurface:loop", "--modulate", "0"], "--modulate is 0.0: give a number above 0"),
    ],
)
def test_what_cannot_be_played_is_one_line(scene: Path, words: list[str], reported: str) -> None:
    error = midair("play", str(scene), *words, status=2).stderr
    lines = [line for line in error.splitlines() if line.startswith("error")]
    assert len(lines) == 1
    assert reported in lines[0]


@pytest.mark.slow
def test_modulation_is_requested_before_anything_is_read_or_solved() -> None:
    error = midair("play", "not-there.toml", "--on", "sonicsurface:loop", "--modulate", "nan", status=2).stderr
    assert error.startswith("error: --modulate is nan")


@pytest.mark.slow
def test_off_says_which_board_it_was_reported_as() -> None:
    assert "null is off" in midair("off", "null").stdout
    assert "a file plays nothing" in midair("off", "file:mine.bin", status=2).stderr
    assert "is not there" in midair("off", "/dev/no-such-port", status=2).stderr


@pytest.mark.slow
def test_a_file_of_what_moves_is_sent_to_the_command_for_it(tmp_path: Path) -> None:
    path = tmp_path / "motion.toml"
    path.write_text(SCENE.split("[[points]]")[0] + "[motion]\nrate = 40\n", encoding="utf-8")
    assert (
        "its points move: midair motion solves it and midair play plays it"
        in midair("solve", str(path), status=2).stderr
    )


def test_a_system_that_does_not_list_its_ports_gets_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    from serial.tools import list_ports

    # The error of Wine.
    def failing() -> None:
        raise AttributeError("function 'CM_MapCrToWin32Err' not found")

    monkeypatch.setattr(list_ports, "comports", failing)
    with pytest.raises(BoardError, match=r"list its serial ports \(function .* found\): give the port"):
        ports()


def test_ports_say_what_an_adapter_could_lead_to(monkeypatch: pytest.MonkeyPatch) -> None:
    from serial.tools import list_ports, list_ports_common

    found = []
    for name, vid, pid in (("a", 0x2341, 0x42), ("b", 0x1A86, 0x7523), ("c", 0x1A86, 1), ("d", None, None)):
        port = list_ports_common.ListPortInfo(name)
        port.vid, port.pid = vid, pid
        found.append(port)
    for product in ("FT245R USB FIFO", "FT232R USB UART"):
        port = list_ports_common.ListPortInfo(product)
        port.vid, port.pid, port.product = 0x0403, 0x6001, product
        found.append(port)
    monkeypatch.setattr(list_ports, "comports", lambda: found)
    (serial, fifo, *reported) = [port.could_be for port in ports()]
    assert "sonicsurface" in serial
    assert fifo == "an FT245: openmpd"
    assert "mega64" in reported[0]
    assert "sonicsurface" in reported[1]
    assert reported[2:] == ["", ""]
