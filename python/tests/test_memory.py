"""Requests above the existing or allowed memory fail before the allocation;
the message has N, M and the bytes. Many calls take no more memory and no more files than a few.
"""

import os
import subprocess
import sys
from pathlib import Path

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
    program = "import resource; resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))\n" + PROGRAM.format(code)
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


#: Repeats some calls. Prints those after which memory or files stay in use, with the bytes of a call.
REPEATED = """
import ctypes, gc, os, pickle, warnings
import midair, numpy as np

class Info(ctypes.Structure):
    names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in names.split()]

mallinfo = ctypes.CDLL(None).mallinfo2
mallinfo.restype = Info

def in_use():
    gc.collect()
    info = mallinfo()
    return info.uordblks + info.hblkhd

def files():
    gc.collect()
    return sorted(os.readlink(f"/proc/self/fd/{name}") for name in os.listdir("/proc/self/fd") if name != "3")

def quietly(call, *errors):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            call()
        except errors:
            pass

def played():
    with midair.connect("nano16:loop") as connection:
        connection.send(np.ones(16))

def stored():
    sequence.save("sequence.npz")
    assert midair.Sequence.load("sequence.npz") == sequence
    scene.save("scene.toml")
    assert midair.Scene.load("scene.toml") == scene
    solution.save("drive.npz")

array, point = midair.Array.grid(4, 4, pitch=0.01), [[0, 0, 0.1]]
frames = np.array([point, [[1e-4, 0, 0.1]]])
scene = midair.Scene(array, point, 500)
solution, solver, board = midair.solve(scene), midair.Solver(array, "glide"), midair.Board("nano16")
sequence = midair.sequence(array, frames, rate=1000)
moving = {"rate": 1000, "signature": "trap", "aim": "max"}
calls = {
    "array": lambda: array.moved(translation=[0, 0, 1]),
    "scene": lambda: midair.Scene.parse(midair.Scene(array, point, temperature=20).json()),
    "solve": lambda: midair.solve(scene),
    "fast": lambda: midair.solve(scene, "fast", trace=True),
    "batch": lambda: midair.solve_batch(array, frames, solver="fast", threads=1),
    "solver": lambda: midair.Solver(array, "fast")(point),
    "follow": lambda: (solver.reset(), solver.follow(frames), solver.restore(*solver.last())),
    "field": lambda: midair.field(solution, point),
    "judge": lambda: midair.judge(solution),
    "gorkov": lambda: midair.gorkov(solution, point),
    "propagation": lambda: midair.Propagation(scene.propagation().copy()),
    "pickle": lambda: pickle.loads(pickle.dumps((solution, scene, solver))),
    "sequence": lambda: midair.sequence(array, frames, rate=1000),
    "board": lambda: board.decode(board.encode(solution)),
    "error": lambda: quietly(lambda: midair.Scene(array, [[0, 0, 1e9]]), midair.SceneError),
    "warning": lambda: quietly(lambda: midair.Scene(array, point, frequency=40)),
}
for name, call in calls.items():
    for _ in range(400):
        call()
    # A table may grow once; what leaks grows in each round.
    for _ in range(3):
        before = in_use()
        for _ in range(1600):
            call()
        if (each := (in_use() - before) / 1600) <= 16:
            break
    else:
        print(name, each)
for call in (stored, played):
    call()
    before = files()
    call()
    if (after := files()) != before:
        print(call.__name__, before, after)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the memory in use is that of glibc")
def test_many_calls_take_no_more_memory_and_files(tmp_path: Path) -> None:
    # An allocator of Python's own would hide objects that are never freed.
    environment = {"PYTHONMALLOC": "malloc", "OPENBLAS_NUM_THREADS": "1"}
    ran = subprocess.run(
        [sys.executable, "-c", REPEATED],
        env=os.environ | environment,
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert (ran.stdout, ran.stderr) == ("", "")
