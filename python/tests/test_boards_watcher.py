"""A board turns off whichever two of owner, guard and watcher end at once.

MIDAIR_SLOW=1 runs each test twenty times.
"""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

import midair
from lines import Line
from midair._boards import watcher
from midair._boards.watcher import runs
from test_boards_guard import ended, programs, started  # noqa: F401, a fixture among them

TRIALS = 20 if os.environ.get("MIDAIR_SLOW") else 5

#: Time limit in s until the board is off.
ALLOWED = 0.25

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds processes by /proc")


@pytest.fixture
def line():
    made = Line()
    yield made
    made.unplug()


def guard_of(owner: int) -> int:
    """Returns the process number of the guard: the owner's only child."""
    (guard,) = Path(f"/proc/{owner}/task/{owner}/children").read_text("utf-8").split()
    return int(guard)


def watcher_of(guard: int) -> int:
    """Returns the process number of the watcher, no child of the guard: its only pipe is the guard's.

    Other tests run guards and watchers with the same command line at the same time.
    """
    # A process that was begun a moment ago has other pipes, too.
    for _ in range(100):
        for path in Path("/proc").glob("[0-9]*"):
            with suppress(OSError):
                if int(path.name) != guard and (pipes := pipes_of(path)) and pipes <= pipes_of(Path(f"/proc/{guard}")):
                    return int(path.name)
        time.sleep(0.05)
    raise AssertionError("no watcher")


def pipes_of(process: Path) -> set[str]:
    return {link for path in (process / "fd").iterdir() if (link := os.readlink(path)).startswith("pipe:")}


@pytest.mark.slow
@pytest.mark.parametrize("_", range(TRIALS))
@pytest.mark.parametrize(
    ("owner_by", "guard_by"),
    [
        (signal.SIGKILL, signal.SIGKILL),
        (signal.SIGSTOP, signal.SIGKILL),
        (signal.SIGKILL, signal.SIGSTOP),
        (signal.SIGSTOP, signal.SIGSTOP),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_owner_and_guard_at_once(programs, line, owner_by, guard_by, dark, _):  # noqa: F811
    owner = started(programs, "sleep", line)
    guard = guard_of(owner)
    try:
        with dark(line, ALLOWED):
            # The owner is first: if it were stopped while it turns the board off, the port would stay open.
            os.kill(owner, owner_by)
            os.kill(guard, guard_by)
    finally:
        with suppress(ProcessLookupError):
            os.kill(owner, signal.SIGKILL)
    ended(programs)
    assert line.surface.silent


@pytest.mark.slow
@pytest.mark.parametrize("_", range(TRIALS))
@pytest.mark.parametrize("with_owner", [True, False])
def test_the_watcher_and_another_at_once(programs, line, with_owner, dark, _):  # noqa: F811
    owner = started(programs, "sleep", line)
    guard = guard_of(owner)
    os.kill(watcher_of(guard), signal.SIGKILL)
    with dark(line, ALLOWED):
        os.kill(owner if with_owner else guard, signal.SIGKILL)
    if not with_owner:
        os.kill(owner, signal.SIGKILL)
    ended(programs)


@pytest.mark.slow
def test_an_owner_that_is_stopped_with_the_port_in_its_hands(line):
    with midair.connect(f"sonicsurface:{line.port}") as surface:
        transport = surface._guard._transport
    script = "import serial, sys; port = serial.Serial(sys.argv[1], exclusive=True); print(); sys.stdin.read()"
    command = [sys.executable, "-c", script, line.port]
    line.surface.banks[0][0][0] = 0
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as owner:
        owner.stdout.readline()
        owner.send_signal(signal.SIGSTOP)
        watcher._silence(transport, watcher._node(transport), owner.pid)
        line.wait(lambda surface: surface.silent)
        owner.kill()


@pytest.mark.slow
def test_a_watcher_ends_with_its_guard(programs, line):  # noqa: F811
    owner = started(programs, "sleep", line)
    process = watcher_of(guard_of(owner))
    os.kill(owner, signal.SIGTERM)
    line.wait(lambda surface: surface.silent)
    ended(programs)
    until = time.monotonic() + 5
    while runs(process) and time.monotonic() < until:
        time.sleep(0.01)
    assert not runs(process)
