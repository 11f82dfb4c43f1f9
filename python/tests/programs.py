"""Programs that play and end in various ways. Each input line "act port hold" starts one program as a
child process; with these three words as arguments, this process is the program.

The output has each program's process number when it plays, and "ended" when it has ended.
"""

import ctypes
import os
import signal
import sys
import time

import numpy as np

import midair

DRIVE = np.ones(256)


def wait_for_word():
    sys.stdin.readline()


def bare(surface):
    time.sleep(30)


def solve(surface):
    points = np.random.default_rng(0).uniform([-0.05, -0.05, 0.1], [0.05, 0.05, 0.2], (64, 3))
    while True:
        surface.send(midair.solve(midair.Scene(surface.board.array, points), "greedy"))


def send(surface):
    while True:
        surface.send(DRIVE)


def stream(surface):
    surface.stream(DRIVE for _ in range(10**6))


def modulate(surface):
    surface.modulate(200)
    time.sleep(30)


def forked(surface):
    """Forks a child that outlives the program and keeps the program's end of the pipe to the guard open."""
    if os.fork() == 0:
        os.closerange(0, 3)
        time.sleep(3)
        os._exit(0)
    time.sleep(30)


def spin(surface):
    while True:
        pass


def native(surface):
    """Hangs while it has the interpreter's lock."""
    ctypes.PyDLL(None).sleep(30)


def exception(surface):
    wait_for_word()
    raise ValueError("of the program")


def segfault(surface):
    wait_for_word()
    ctypes.string_at(0)


def exit(surface):
    wait_for_word()
    os._exit(1)


def killed(surface):
    """Kills itself; on Windows by TerminateProcess."""
    wait_for_word()
    os.kill(os.getpid(), 9)


def guardless(surface):
    """Kills its guard."""
    wait_for_word()
    surface._guard._process.kill()
    time.sleep(30)


def alone(surface):
    """Kills its guard, then itself: the watcher is left."""
    wait_for_word()
    surface._guard._process.kill()
    os.kill(os.getpid(), 9)


def forgotten(surface):
    """Ends the program without closing the board or keeping a reference to it."""
    wait_for_word()


ACTS = {act.__name__: act for act in (bare, solve, send, stream, modulate, forked)}
ACTS |= {act.__name__: act for act in (spin, native, exception, segfault, exit, killed, guardless, alone, forgotten)}
ACTS["sleep"] = bare


def play(name, port, hold):
    surface = midair.connect(f"sonicsurface:{port}", hold=float(hold))
    surface.send(DRIVE)
    os.write(1, b"playing\n")
    if name in ("bare", "forgotten"):
        ACTS[name](surface)
    else:
        with surface:
            ACTS[name](surface)


def main():
    if len(sys.argv) > 1:
        # Windows cannot fork.
        return play(*sys.argv[1:])
    # nohup makes programs ignore SIGHUP.
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    # Each line is read when it arrives, and this process forks the program for it.
    while line := sys.stdin.readline():
        process = os.fork()
        if process == 0:
            os.write(1, f"{os.getpid()}\n".encode())
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            return play(*line.split())
        os.waitpid(process, 0)
        os.write(1, b"ended\n")
    return None


if __name__ == "__main__":
    main()
