"""A board turns off when its program ends: programs that play on a pseudo-terminal are ended in every way.

MIDAIR_SLOW=1 ends each program twenty times.
"""

import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import pytest

from lines import Line

DEATHS = 20 if os.environ.get("MIDAIR_SLOW") else 2
HANGS = 20 if os.environ.get("MIDAIR_SLOW") else 1
ALLOWED = 0.25
HOLD = 0.3

#: Acts of programs.py, and the signals that end them; an act without signals ends by itself.
ENDS = {
    "sleep": [signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP],
    "send": [signal.SIGKILL, signal.SIGINT],
    "stream": [signal.SIGKILL, signal.SIGTERM, signal.SIGINT],
    "modulate": [signal.SIGKILL, signal.SIGINT],
    "solve": [signal.SIGKILL, signal.SIGINT],
    "bare": [signal.SIGINT, signal.SIGTERM],
    "forked": [signal.SIGKILL],
    "exception": [None],
    "segfault": [None],
    "exit": [None],
    "forgotten": [None],
}
CASES = [(act, number) for act, numbers in ENDS.items() for number in numbers]


def forking():
    """Starts a process that has imported midair and forks a program for each line that it reads."""
    script = str(Path(__file__).with_name("programs.py"))
    # A process group of its own: the kernel drops SIGTSTP in a group without a parent outside of it.
    return subprocess.Popen(
        [sys.executable, script],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
        process_group=0,
    )


@pytest.fixture(scope="module")
def programs():
    with forking() as process:
        yield process
        process.stdin.close()


@pytest.fixture
def line():
    made = Line()
    yield made
    made.unplug()


def started(programs, act, line, hold=60.0):
    """Starts a program, waits until it plays, and returns its process number."""
    programs.stdin.write(f"{act} {line.port} {hold}\n")
    programs.stdin.flush()
    # If an earlier test failed, the "ended" of its program is still unread.
    while (reported := programs.stdout.readline()) == "ended\n":
        pass
    process = int(reported)
    line.wait(lambda surface: surface.loud, 20)
    assert programs.stdout.readline() == "playing\n"
    time.sleep(0.03)
    return process


def ended(programs):
    """Waits for the end of the program."""
    assert programs.stdout.readline() == "ended\n"


@pytest.mark.slow
@pytest.mark.parametrize("_", range(DEATHS))
@pytest.mark.parametrize(("act", "number"), CASES, ids=lambda value: getattr(value, "name", value))
def test_what_ends_is_off(programs, line, act, number, dark, _):
    process = started(programs, act, line)
    with dark(line, ALLOWED):
        if number is None:
            programs.stdin.write("go\n")
            programs.stdin.flush()
        else:
            os.kill(process, number)
    ended(programs)
    time.sleep(0.02)
    assert line.surface.silent
    assert line.taken[0] == 151
    assert [codes for _, codes in line.commits()[:2]] == [[32] * 256] * 2


@pytest.mark.slow
@pytest.mark.parametrize("_", range(HANGS))
def test_a_group_that_is_killed_is_off(line, dark, _):
    with forking() as group:
        started(group, "sleep", line)
        with dark(line, ALLOWED):
            os.killpg(group.pid, signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.parametrize("_", range(HANGS))
@pytest.mark.parametrize("act", ["stopped", "spin", "native"])
def test_what_hangs_is_off_after_the_hold_or_before(programs, line, act, _):
    begin = time.monotonic()
    process = started(programs, "sleep" if act == "stopped" else act, line, HOLD)
    begin = time.monotonic()
    if act == "stopped":
        os.kill(process, signal.SIGSTOP)
    assert line.wait(lambda surface: surface.silent) - begin < HOLD + ALLOWED
    os.kill(process, signal.SIGKILL)
    ended(programs)


@pytest.mark.parametrize("_", range(DEATHS))
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM], ids=lambda number: number.name)
def test_a_guard_that_is_killed_is_missed(line, number, dark, _):
    import midair

    with midair.connect(f"sonicsurface:{line.port}") as surface:
        surface.send([1] * 256)
        line.wait(lambda surface: surface.loud)
        with dark(line, ALLOWED):
            os.kill(surface._guard._process.pid, number)
        with pytest.raises(midair.BoardLost, match="guard"):
            surface.send([1] * 256)
        with pytest.raises(midair.BoardLost, match="guard"):
            surface.off()
        assert surface.state == "lost"
        assert not surface.emitting.any()
    assert surface.state == "closed"


@pytest.mark.slow
def test_an_opening_that_is_interrupted_is_given_up(monkeypatch, tmp_path):
    import midair

    (tmp_path / "serial.py").write_text("import time\ntime.sleep(30)\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    threading.Timer(0.5, os.kill, [os.getpid(), signal.SIGINT]).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        midair.connect("sonicsurface:/dev/ttyUSB0")
    assert time.monotonic() - begin < 1


@pytest.mark.slow
def test_a_guard_that_hangs_is_replaced(line):
    import midair

    surface = midair.connect(f"sonicsurface:{line.port}")
    surface.send([1] * 256)
    line.wait(lambda surface: surface.loud)
    os.kill(surface._guard._process.pid, signal.SIGSTOP)
    begin = time.monotonic()
    surface.close()
    assert time.monotonic() - begin < 2
    line.wait(lambda surface: surface.silent)


@pytest.mark.slow
def test_a_guard_survives_what_is_meant_for_its_owner(line):
    import midair

    with midair.connect(f"sonicsurface:{line.port}") as surface:
        guard = surface._guard._process.pid
        assert os.getsid(guard) == guard
        surface.send([1] * 256)
        for number in (signal.SIGINT, signal.SIGHUP):
            os.kill(guard, number)
        time.sleep(0.1)
        assert surface.state == "playing"
        assert line.surface.loud
    with suppress(ProcessLookupError):
        os.kill(guard, 0)
        pytest.fail("the guard lives on")
    assert line.surface.silent
