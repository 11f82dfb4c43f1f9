"""Requests above the existing or allowed memory fail before the allocation;
the message has N, M and the bytes.
"""

import os
import subprocess
import sys

import pytest

from test_control import POSIX

#: Calls that need too much memory, with expected words of the message.
TOO_MUCH = {
    "gspat": (
        'midair.solve(scene(4, 200_000), "gspat")',
        "N = 4 transducers and M = 200000 points needs 320",
    ),
    "uniform": ('midair.solve(scene(4, 200_000), "uniform")', "M = 200000 points needs 320"),
    "lm": ('midair.solve(scene(4, 100_000), "lm")', "M = 100000 points needs"),
    "propagation": (
        "scene(90_000, 20_000).propagation()",
        "N = 90000 transducers and M = 20000 points needs 14",
    ),
    "solve_batch": (
        'midair.solve_batch(scene(90_000, 1), np.ones((20_000, 1, 3)), solver="fast")',
        "20000",
    ),
    "skin": ("midair.skin(played(4, 9_000, rate=0.01))", "the spectrum at a skin"),
    "fly": ("midair.fly(played(900, 9, rate=0.01))", "the drives at knots of N = 900 transducers"),
    "a long flight": (
        "midair.fly(played(4, 9, closed=True), duration=1e9)",
        "1e+09 s: the tracks of the beads need",
    ),
}

PROGRAM = """
import midair, numpy as np
def scene(count, points):
    points = np.random.default_rng(0).uniform(-0.1, 0.1, (points, 3)) + [0, 0, 0.3]
    return midair.Scene(midair.Array.grid(count // 2, 2, pitch=0.001), points)
def played(count, frames, rate=1e3, closed=False):
    places, drives = np.full((frames, 1, 3), 0.1), np.ones((frames, count))
    return midair.Sequence(scene(count, 1).array, places, 1.0, drives, rate=rate, closed=closed)
try:
    {0}
except MemoryError as error:
    print(error)
"""


def run(code: str, **environment: str) -> str:
    """Returns the output of code that runs in a process with 3 GiB of address space."""
    program = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))\n" + PROGRAM.format(code)
    )
    ran = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | environment,
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    return ran.stdout


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("case", TOO_MUCH)
def test_too_much_is_refused_in_one_line(case: str) -> None:
    code, want = TOO_MUCH[case]
    said = run(code)
    assert said.count("\n") == 1
    assert want in said
    assert "GB" in said
    assert "MIDAIR_MEMORY" in said


@pytest.mark.slow
@POSIX
def test_the_limit_can_be_set() -> None:
    code = 'midair.solve(scene(100, 1000), "gspat"); print("done")'
    assert run(code) == "done\n"
    assert "the limit is 0.001 GB" in run(code, MIDAIR_MEMORY="1MB")
    # MIDAIR_MEMORY allows this size, but the process cannot allocate it.
    assert "GB" in run('midair.solve(scene(4, 30_000), "gspat")', MIDAIR_MEMORY="1TB")
    assert (
        "give bytes, such as 2e9"
        in subprocess.run(
            [sys.executable, "-c", PROGRAM.format("scene(4, 2).propagation()")],
            env=os.environ | {"MIDAIR_MEMORY": "lots"},
            capture_output=True,
            encoding="utf-8",
            check=False,
        ).stderr
    )
