"""Watcher: a third process, which turns the device off if the guard and its owner die at the same time.

The guard forks it at its start, twice and into a session of its own, so that ending the guard's process group
or process tree does not end it. On Windows, which has no fork, a program that then ends starts it. It reads
beats from the guard. If the beats end without END, the owner turns the device off; if the owner is gone too,
the watcher does. The watcher kills a guard that is stopped or silent.

It cannot help if all three processes are ended. Process states come from /proc; on systems without it, a
process that exists counts as running.
"""

import json
import os
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from .transport import open_transport, prepare
from .wire import BEATS

#: Letters in /proc for the state of a process: dead (but still listed), stopped, stopped by a debugger.
DEAD, STOPPED, TRACED = "ZX", "T", "t"

#: Links whose boards continue to play without a connection. AUTD3 boards mute themselves; the others are no
#: devices.
WATCHED = ("serial", "fifo")

#: A guard that sends no beat for this time, in s, is killed. The owner has the same time to turn the device
#: off. This time is longer than the one in which owner and guard detect missing beats.
SILENT = 1.5

#: Number of attempts to open a port that another process still uses, and the pause in s between them.
TRIES = 50
PAUSE = 0.02

#: Time in s between two checks whether guard or owner is stopped.
LOOK = 0.04

BEAT, END = b".", b"E"


def runs(process: int) -> bool:
    """Return whether a process exists and is neither stopped nor a zombie."""
    if sys.platform == "win32":
        return _exists(process)
    if state := _state(process):
        return state not in DEAD + STOPPED + TRACED
    try:
        os.kill(process, 0)
    except OSError:
        return False
    # On a system without /proc, an existing process counts as running.
    return not Path("/proc/self/stat").exists()


def _exists(process: int) -> bool:
    """Return whether Windows has a process of this number that has not ended."""
    import ctypes

    kernel = ctypes.CDLL("kernel32")
    synchronize, timeout = 0x100000, 258
    handle = kernel.OpenProcess(synchronize, False, process)
    waited = kernel.WaitForSingleObject(handle, 0)
    kernel.CloseHandle(handle)
    return bool(waited == timeout)


def is_stopped(process: int) -> bool:
    """Return whether a signal has stopped a process."""
    return _state(process) == STOPPED


class Stops:
    """Detects a stopped process. It counts as stopped only if two consecutive checks find it stopped."""

    def __init__(self, process: int) -> None:
        self._process = process
        self._before = False

    def look(self) -> bool:
        """Return whether the process is stopped now and was stopped at the check before."""
        before, self._before = self._before, is_stopped(self._process)
        return before and self._before


def _state(process: int) -> str:
    """Return the letter of a process's state from /proc, "" if it cannot be read."""
    with suppress(OSError):
        return Path(f"/proc/{process}/stat").read_text("utf-8", "replace").rpartition(")")[2].split()[0]
    return ""


class Watch:
    """The guard's end of the pipe to its watcher. It must be made before the guard starts threads."""

    def __init__(self) -> None:
        self._pipe = _forked() if hasattr(os, "fork") else None
        self._over = threading.Event()

    def begin(self, setting: dict[str, Any]) -> None:
        """Send the watcher the description of the transport, and beats from now on."""
        if setting["transport"]["kind"] not in WATCHED:
            self.end()
            return
        if self._pipe is None:
            # The stream is kept, because Python closes one that is not.
            self._stream = _spawned(str(os.getpid()), str(setting["owner"]), "by another program").stdin
            assert self._stream is not None
            self._pipe = self._stream.fileno()
        self._write(json.dumps(setting).encode() + b"\n")
        # Before Python 3.12 Windows lacks this.
        with suppress(AttributeError):
            os.set_blocking(self._pipe, False)
        threading.Thread(target=self._beat, daemon=True).start()

    def end(self) -> None:
        """End the watcher: the guard has turned the device off."""
        self._over.set()
        if self._pipe is not None:
            self._write(END)

    def _beat(self) -> None:
        while not self._over.wait(BEATS):
            self._write(BEAT)

    def _write(self, content: bytes) -> None:
        # The pipe may be closed or full, if the watcher has ended or is stopped.
        with suppress(OSError):
            os.write(self._pipe or -1, content)


def _forked() -> int:
    """Fork the watcher twice, so that it is no child of the guard; return the guard's end of the pipe."""
    guard, owner = os.getpid(), os.getppid()
    theirs, ours = os.pipe()
    if child := os.fork():
        os.waitpid(child, 0)
        os.close(theirs)
        return ours
    try:
        os.setsid()
        if os.fork() == 0:
            # Close this process's copies of the guard's pipes: the pipes must close when guard and owner end.
            nothing = os.open(os.devnull, os.O_RDWR)
            for standard in range(3):
                os.dup2(nothing, standard)
            os.closerange(3, theirs)
            os.closerange(theirs + 1, max(ours, nothing) + 1)
            _watch(theirs, guard, owner)
    finally:
        os._exit(0)


def _spawned(*words: str, source: Any = subprocess.PIPE) -> subprocess.Popen[bytes]:
    """Start this module's `main` in a process whose standard input is a pipe or a given stream."""
    return subprocess.Popen(
        [sys.executable, "-I", "-S", str(Path(__file__).with_name("start.py")), *words],
        stdin=source,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )


def main(guard: str, owner: str, *more: str) -> None:
    """Watch these processes by beats from standard input; with one more word, start a process that does."""
    if more:
        _spawned(guard, owner, source=sys.stdin)
    else:
        _watch(0, int(guard), int(owner))
    os._exit(0)


def _watch(pipe: int, guard: int, owner: int) -> None:
    """Read beats until the guard reports its end or the beats stop; then turn the device off if needed."""
    with open(pipe, "rb", buffering=0, closefd=False) as stream:
        line = stream.readline()
    if not line.endswith(b"\n"):
        return
    setting = json.loads(line)
    node = _node(setting["transport"])
    sys.path[:] = setting["path"]
    prepare(setting["transport"])
    beats: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_listen, args=(pipe, beats), daemon=True).start()
    stops, silent = Stops(guard), time.monotonic() + SILENT
    while time.monotonic() < silent and not (stops.look() and not runs(owner)):
        try:
            came, silent = beats.get(timeout=LOOK), time.monotonic() + SILENT
        except Empty:
            continue
        if END in came or (not came and _left_to(owner)):
            return
        if not came:
            break
    else:
        # An owner that still runs would have killed the guard already. 9 is SIGKILL; on Windows any kills.
        with suppress(OSError):
            os.kill(guard, 9)
    _silence(setting["transport"], node, owner)


def _listen(pipe: int, beats: SimpleQueue[bytes]) -> None:
    """Queue all that comes from a pipe, at its end nothing: Windows has no `select` for pipes."""
    with suppress(OSError):
        while came := os.read(pipe, 4096):
            beats.put(came)
    beats.put(b"")


def _node(transport: dict[str, Any]) -> tuple[int, ...] | None:
    """Return the identity of a port's node in /dev; it changes if the device is plugged in again."""
    with suppress(OSError, KeyError):
        found = os.stat(transport["port"])
        return found.st_ino, found.st_rdev, found.st_ctime_ns
    return None


def _left_to(owner: int) -> bool:
    """Return whether the owner still runs after the time that it has to turn the device off."""
    until = time.monotonic() + SILENT
    while runs(owner):
        if time.monotonic() > until:
            return True
        time.sleep(PAUSE / 2)
    return False


def _silence(transport: dict[str, Any], node: tuple[int, ...] | None, owner: int) -> None:
    """Turn the device off as soon as its port is free. Stops if another device is now at that port."""
    for _ in range(TRIES):
        if _node(transport) != node:
            return
        if transport["kind"] == "serial" and is_stopped(owner):
            # The owner may have been stopped while it was turning the device off; then its port stays in
            # exclusive use.
            transport = {**transport, "exclusive": False}
        with suppress(Exception):
            device = open_transport(transport)
            try:
                device.silence()
                return
            finally:
                device.close()
        time.sleep(PAUSE)
