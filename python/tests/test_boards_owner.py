"""A board emits only while its owner and its guard run and reply.

If one is stopped, the board is off within 0.25 s; if one hangs, within 1 s. MIDAIR_SLOW=1 runs each test
20 times.
"""

import copy
import json
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path
from queue import SimpleQueue

import numpy as np
import pytest

import midair
from lines import Line
from midair._boards import guard, process, wire
from midair._boards.wire import Kind
from test_boards_guard import ended, programs, started  # noqa: F401, a fixture among them

TRIALS = 20 if os.environ.get("MIDAIR_SLOW") else 1
#: Longest times in s until the board is off. A stopped process is seen in /proc; a process that hangs is
#: noticed only when its heartbeats are missing.
STOPPED, MISSED = 0.25, 1.0
if not Path("/proc/self/stat").exists():
    STOPPED = MISSED


@pytest.fixture
def line():
    made = Line()
    yield made
    made.unplug()


@pytest.mark.slow
@pytest.mark.parametrize("_", range(TRIALS))
@pytest.mark.parametrize(
    ("act", "number"),
    [("sleep", signal.SIGSTOP), ("sleep", signal.SIGTSTP), ("stream", signal.SIGSTOP), ("native", None)],
    ids=lambda value: getattr(value, "name", value),
)
def test_an_owner_that_is_stopped_or_hangs_is_off(programs, line, act, number, dark, _):  # noqa: F811
    number_of_process = started(programs, act, line)
    with dark(line, MISSED if number is None else STOPPED):
        if number is not None:
            os.kill(number_of_process, number)
    os.kill(number_of_process, signal.SIGKILL)
    ended(programs)
    assert line.surface.silent


@pytest.mark.slow
def test_a_program_that_goes_on_after_ctrl_z_plays_again(line, dark):
    script = (
        "import time, midair\n"
        f"with midair.connect('sonicsurface:{line.port}') as surface:\n"
        "    for _ in range(1000):\n"
        "        surface.send([1] * 256)\n"
        "        time.sleep(0.05)\n"
    )
    # A shell starts a program like this: in a process group of its own, which the terminal can stop.
    program = subprocess.Popen([sys.executable, "-c", script], process_group=0)
    try:
        line.wait(lambda surface: len(surface.played) > 4 and surface.loud, 20)
        with dark(line, STOPPED):
            program.send_signal(signal.SIGTSTP)
        # The pause is longer than the time limit of every heartbeat.
        time.sleep(1.0)
        program.send_signal(signal.SIGCONT)
        line.wait(lambda surface: surface.loud, 10)
        time.sleep(1.0)
        assert line.surface.loud
    finally:
        with dark(line, STOPPED):
            program.kill()
            program.wait()


@pytest.mark.slow
@pytest.mark.parametrize("_", range(TRIALS))
@pytest.mark.parametrize("call", [None, "off", "send", "state", "close"])
def test_a_guard_that_is_stopped_is_missed_whatever_is_called(line, call, dark, _):
    surface = midair.connect(f"sonicsurface:{line.port}")
    try:
        surface.send([1] * 256)
        line.wait(lambda surface: surface.loud)
        with dark(line, STOPPED):
            os.kill(surface._guard._process.pid, signal.SIGSTOP)
            if call == "state":
                assert surface.state == "lost"
            elif call == "close":
                surface.close()
            elif call is not None:
                with pytest.raises(midair.BoardLost, match="guard process has ended"):
                    getattr(surface, call)(*([[1] * 256] if call == "send" else []))
    finally:
        surface.close()


@pytest.mark.slow
def test_a_program_that_only_waits_or_computes_plays_on(line):
    with midair.connect(f"sonicsurface:{line.port}") as surface:
        surface.send([1] * 256)
        line.wait(lambda surface: surface.loud)
        until = time.monotonic() + 2
        while time.monotonic() < until:
            sum(range(10_000))
        time.sleep(0.5)
        assert line.surface.loud
        assert surface.stats.lapses == 0


@pytest.mark.slow
def test_a_program_needs_nothing_more_from_the_disk_to_turn_the_board_off(line):
    script = (
        "import sys, midair\n"
        f"with midair.connect('sonicsurface:{line.port}') as surface: known = set(sys.modules)\n"
        "surface._guard._silence()\n"
        "print(*set(sys.modules) - known)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, encoding="utf-8", check=True)
    assert done.stdout.split() == []


class Slow:
    """A transport whose modulation takes longer than `hold`; then the connection is closed."""

    def __init__(self, inbox):
        self.inbox = inbox

    def play(self, frame):
        pass

    def silence(self):
        pass

    def look(self):
        pass

    def modulate(self, wave):
        time.sleep(0.3)
        self.inbox.put((Kind.CLOSE, 3, b""))


def test_a_call_that_keeps_the_device_busy_for_longer_than_hold_is_no_silence(monkeypatch):
    monkeypatch.setattr(guard, "before_what_computes", lambda: None)
    inbox, nowhere = SimpleQueue(), os.open(os.devnull, os.O_WRONLY)
    served = guard.Guard(Slow(inbox), guard.Owner(os.getppid(), hold=0.1), inbox, nowhere)
    inbox.put((Kind.PLAY, 1, wire.WHEN.pack(0.0, 0.0, wire.Late.WAIT) + b"frame"))
    inbox.put((Kind.MODULATE, 2, wire.MODULATION.pack(200.0)))
    served.run()
    os.close(nowhere)
    assert json.loads(served.status()) == {"state": "modulating", "frames": 1, "late": 0, "lapses": 0}


@pytest.mark.parametrize("executable", ["itself", None, ""])
def test_a_frozen_application_is_not_started_as_its_own_guard(monkeypatch, tmp_path, executable):
    application = tmp_path / "application"
    application.write_text("#!/bin/sh\necho started >> " + str(tmp_path / "starts") + "\n", encoding="utf-8")
    application.chmod(0o700)
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    monkeypatch.setattr(sys, "executable", str(application) if executable == "itself" else executable)
    with pytest.raises(midair.BoardError, match=r"needs a Python interpreter.*MIDAIR_PYTHON"):
        midair.connect("sonicsurface:loop")
    assert not (tmp_path / "starts").exists()


def test_a_frozen_application_may_name_an_interpreter(monkeypatch):
    monkeypatch.setenv("MIDAIR_PYTHON", sys.executable)
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    with midair.connect("sonicsurface:null") as surface:
        surface.send([1] * 256)


@pytest.mark.slow
def test_a_program_in_place_of_an_interpreter_starts_itself_once(monkeypatch, tmp_path):
    application = tmp_path / "application"
    starts = tmp_path / "starts"
    application.write_text(
        f'#!/bin/sh\necho started >> {starts}\nexec {sys.executable} -c "import sys\n'
        f"sys.executable = '{application}'\nimport midair\nmidair.connect('sonicsurface:loop')\"\n",
        encoding="utf-8",
    )
    application.chmod(0o700)
    reported = subprocess.run([application], capture_output=True, encoding="utf-8", timeout=60)
    assert reported.returncode == 1
    assert starts.read_text("utf-8").count("started") == 2


def test_a_limit_is_its_own_and_cannot_be_written_to():
    board = midair.Board("sonicsurface")
    positions, most = np.array([[0.0, 0.0, 0.15]]), np.array([5.0])
    given = {"positions": positions, "pressure": most}
    with midair.connect("sonicsurface:null", limit=given) as surface:
        positions[:], most[:] = 9.0, 1e9
        given["pressure"] = 1e9
        loud = midair.solve(midair.Scene(board.array, [[0, 0, 0.15]]))
        with pytest.raises(midair.BoardError, match=r"limit at .* is 5 Pa"):
            surface.send(loud)
        with pytest.raises(ValueError, match="read-only"):
            surface._limit._most[:] = 1e9


@pytest.mark.parametrize("pressure", [True, "5", [None], [1 + 1j]])
def test_a_limit_that_is_no_number_is_refused(pressure):
    with pytest.raises(midair.SceneError, match=r'limit\["pressure"\] is .*the pressure in Pa'):
        midair.connect("sonicsurface:null", limit={"positions": [[0, 0, 0.1]], "pressure": pressure})


def test_errors_of_a_library_come_as_errors_of_boards_in_one_line(monkeypatch, tmp_path):
    (tmp_path / "serial.py").write_text("class Odd(Exception): pass\nraise Odd('two\\nlines')\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(midair.BoardError) as error:
        midair.connect("sonicsurface:/dev/ttyUSB0")
    assert str(error.value) == "Odd: two lines"


def test_the_environment_of_a_guard_says_what_it_is():
    assert process.GUARD not in os.environ
    with midair.connect("sonicsurface:null") as surface:
        guard = Path(f"/proc/{surface._guard._process.pid}/environ")
        if guard.exists():
            assert b"MIDAIR_GUARD=1" in guard.read_bytes()


def test_a_board_is_a_value():
    corrections = np.linspace(0, 1, 256)
    for board in (
        midair.Board("sonicsurface"),
        midair.Board("openmpd_pair"),
        midair.Board("sonicsurface", corrections=corrections, channels=np.arange(256)[::-1]),
    ):
        drive = np.exp(1j * np.linspace(0, 9, len(board.array)))
        for other in (pickle.loads(pickle.dumps(board)), copy.deepcopy(board)):
            assert other.encode(drive) == board.encode(drive)
            assert other.array == board.array
