"""Watcher: a third process, which turns the device off if its guard and the guard's owner die together.

The guard forks it first of all, twice and into a session of its own, so that what ends a group or a tree of
processes does not find it. It reads the guard's beats. Where these end without a word, the owner turns the
device off; where the owner is gone, too, the watcher does. A guard that is stopped or silent is ended.

It does not survive what ends all three, and Windows, which cannot fork, has none. Whether a process
runs or is stopped is as /proc has it; elsewhere, whether it is there.
"""

from __future__ import annotations

import json
import os
import select
import signal
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from .transport import open_transport
from .wire import BEATS

#: States of a dead process that its parent has not waited for, and of stopped ones.
DEAD, STOPPED, TRACED = "ZX", "T", "t"

#: Links behind which a board plays on: AUTD3 mutes itself, others are no device.
WATCHED = ("serial", "fifo")

#: A guard silent for this time, in s, is ended, and an owner has this time to turn the device off: longer
#: than owner and guard may miss each other's beats.
SILENT = 1.5

#: Number of attempts to open a port that another process keeps, and the seconds between them.
TRIES = 50
PAUSE = 0.02

#: Time in s between two checks whether guard and owner are stopped.
LOOK = 0.04

BEAT, END = b".", b"E"


def runs(process: int) -> bool:
    """Whether a process exists and is neither stopped nor a zombie."""
    if state := _state(process):
        return state not in DEAD + STOPPED + TRACED
    try:
        os.kill(process, 0)
    except OSError:
        return False
    # Without /proc, an existing process counts as running.
    return not Path("/proc/self/stat").exists()


def is_stopped(process: int) -> bool:
    """Whether a process is stopped by a signal."""
    return _state(process) == STOPPED


class Stops:
    """Notes whether a process is stopped by a signal, at two checks one after another."""

    def __init__(self, process: int) -> None:
        self._process = process
        self._before = False

    def look(self) -> bool:
        """Whether it is stopped now and was at the check before."""
        before, self._before = self._before, is_stopped(self._process)
        return before and self._before


def _state(process: int) -> str:
    """The letter of a process's state, none if it cannot be read."""
    with suppress(OSError):
        return Path(f"/proc/{process}/stat").read_text(errors="replace").rpartition(")")[2].split()[0]
    return ""


class Watch:
    """The guard's end of the pipe to its watcher; made before there are threads."""

    def __init__(self) -> None:
        self._pipe = _forked() if hasattr(os, "fork") else None
        self._over = threading.Event()

    def begin(self, setting: dict[str, Any]) -> None:
        """Send the description of the device's transport, and beat from now on."""
        if self._pipe is None or setting["transport"]["kind"] not in WATCHED:
            self.end()
            return
        self._write(json.dumps(setting).encode() + b"\n")
        os.set_blocking(self._pipe, False)
        threading.Thread(target=self._beat, daemon=True).start()

    def end(self) -> None:
        """End the watch: the device is off."""
        self._over.set()
        if self._pipe is not None:
            self._write(END)

    def _beat(self) -> None:
        while not self._over.wait(BEATS):
            self._write(BEAT)

    def _write(self, content: bytes) -> None:
        # A watcher that was ended, or stopped for long, reads nothing.
        with suppress(OSError):
            os.write(self._pipe or -1, content)


def _forked() -> int:
    """Read end of the pipe, in a watcher whose parent is not the guard."""
    guard, owner = os.getpid(), os.getppid()
    theirs, ours = os.pipe()
    if child := os.fork():
        os.waitpid(child, 0)
        os.close(theirs)
        return ours
    try:
        os.setsid()
        if os.fork() == 0:
            # The pipes between guard and owner end with them.
            nothing = os.open(os.devnull, os.O_RDWR)
            for standard in range(3):
                os.dup2(nothing, standard)
            os.closerange(3, theirs)
            os.closerange(theirs + 1, max(ours, nothing) + 1)
            _watch(theirs, guard, owner)
    finally:
        os._exit(0)


def _watch(pipe: int, guard: int, owner: int) -> None:
    """Read beats until the guard reports the end, or stops."""
    with os.fdopen(pipe, "rb", buffering=0) as beats:
        line = beats.readline()
        if not line.endswith(b"\n"):
            return
        setting = json.loads(line)
        node = _node(setting["transport"])
        sys.path[:] = setting["path"]
        stops, silent = Stops(guard), time.monotonic() + SILENT
        while time.monotonic() < silent and not (stops.look() and not runs(owner)):
            if not select.select([beats], [], [], LOOK)[0]:
                continue
            came, silent = os.read(pipe, 4096), time.monotonic() + SILENT
            if END in came or (not came and _left_to(owner)):
                return
            if not came:
                break
        else:
            # An owner that runs would have turned it off before.
            with suppress(OSError):
                os.kill(guard, signal.SIGKILL)
    _silence(setting["transport"], node, owner)


def _node(transport: dict[str, Any]) -> tuple[int, ...] | None:
    """The node in /dev of a port: a port that was pulled and plugged in again has another."""
    with suppress(OSError, KeyError):
        found = os.stat(transport["port"])
        return found.st_ino, found.st_rdev, found.st_ctime_ns
    return None


def _left_to(owner: int) -> bool:
    """Whether an owner runs for as long as it may need to turn the device off."""
    until = time.monotonic() + SILENT
    while runs(owner):
        if time.monotonic() > until:
            return True
        time.sleep(PAUSE / 2)
    return False


def _silence(transport: dict[str, Any], node: tuple[int, ...] | None, owner: int) -> None:
    """Turn the device off as soon as it is free and accepts bytes; not another device in its place."""
    for _ in range(TRIES):
        if _node(transport) != node:
            return
        if transport["kind"] == "serial" and is_stopped(owner):
            # The process may have been stopped while it turned the device off itself, and then keeps the
            # port.
            transport = {**transport, "exclusive": False}
        with suppress(Exception):
            device = open_transport(transport)
            try:
                device.silence()
                return
            finally:
                device.close()
        time.sleep(PAUSE)
