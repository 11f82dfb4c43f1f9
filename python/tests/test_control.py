"""Progress reports, stops and Ctrl-C, and the same bits on any number of threads."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import midair
from midair._support.ctrl_c import interruptibly
from scenes import same_bits, small, usable

#: A solver with one step per transducer, and one with one step per iteration.
SOLVERS = ("greedy", "gs")

#: Time limit in s, far above the time that Ctrl-C may take: a hang is a failed test, not a hung test suite.
HANG = 60

INTERRUPTED = """
import signal, midair, numpy as np
# A shell that runs the tests in the background has its children ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
random = np.random.default_rng(0)
array, board = midair.Array.grid(200, 200, pitch=0.005), midair.Array.preset("autd3", (2, 2))
def scene(count):
    return midair.Scene(array, random.uniform(-0.1, 0.1, (count, 3)) + [0, 0, 0.3])
few, many, most = scene(16), scene(3000), scene(20_000)
drive = np.ones(40_000)
batch = random.uniform(-0.1, 0.1, (20_000, 64, 3)) + [0, 0, 0.3]
try:
    print("ready", flush=True)
    {0}
except KeyboardInterrupt:
    print("interrupted", flush=True)
else:
    print("finished", flush=True)
"""

#: Calls that take seconds to minutes if they are not interrupted.
LONG = {
    "greedy": 'midair.solve(few, "greedy", amplitudes=256, phases=4096, objective="l1")',
    "evd": 'midair.solve(many, "evd")',
    "sdp": 'midair.solve(many, "sdp")',
    "tikhonov": 'midair.solve(many, "tikhonov")',
    "uniform": 'midair.solve(many, "uniform")',
    "lm": 'midair.Solver(array, "lm")(many.points)',
    "batch": 'midair.solve_batch(board, batch, solver="lm")',
    "batch on one thread": 'midair.solve_batch(board, batch, solver="lm", threads=1)',
    "field": "midair.field(few, drive, midair.Plane(0.2, 0.2, pixels=2000))",
    "propagation": "most.propagation()",
    "reach": "many.reach()",
    "judge": "midair.judge(many, drive)",
    "bound": "midair.bound(few)",
    "ahead": "midair.sequence(board, batch[:, :4], rate=1e3, ahead=500)",
}

FORKED = """
import os, sys, midair, numpy as np
scene = midair.Scene(midair.Array.grid(9, 7, pitch=0.01), [[0, 0, 0.1], [0.02, 0, 0.1]])
plane, points = midair.Plane(0.1, 0.1), np.tile(scene.points, (2000, 1, 1))
def work():
    field = midair.field(scene, np.ones(63), plane)
    return field.pressure.tobytes() + midair.solve_batch(scene, points, solver="fast").drives.tobytes()
before = work()
child = os.fork()
if child == 0:
    os._exit(0 if work() == before else 1)
_, status = os.waitpid(child, 0)
print(os.waitstatus_to_exitcode(status), work() == before)
"""

PICTURE = """
import hashlib, midair, numpy as np
rng = np.random.default_rng(0)
scene = midair.Scene(midair.Array.grid(9, 7, pitch=0.01), [[0, 0, 0.1], [0.02, 0, 0.1]])
drive = rng.uniform(0, 1, 63) * np.exp(1j * rng.uniform(0, 6, 63))
field = midair.field(scene, drive, midair.Plane(0.1, 0.1, pixels=151))
solution = midair.solve(scene, "greedy", amplitudes=2)
for array in (field.pressure, scene.propagation(), solution.drive, solution.pressures):
    print(hashlib.sha256(array.tobytes()).hexdigest())
"""


@pytest.mark.parametrize("solver", SOLVERS)
def test_progress_is_reported_every_step(solver: str) -> None:
    reported = []
    scene = small()
    solution = midair.solve(scene, solver, progress=lambda *step: reported.append(step), trace=True)
    assert [step for step, _, _ in reported] == list(range(1, solution.steps + 1))
    # An iterative method may converge before its last step.
    (steps,) = {steps for _, steps, _ in reported}
    assert steps >= len(reported) == solution.steps
    assert {tuple(map(type, step)) for step in reported} == {(int, int, float)}
    assert np.array_equal([residual for _, _, residual in reported], solution.trace)
    # The last step's residual comes from an f32 field that the search updates. The solution's residual comes
    # from a field that is computed anew.
    assert reported[-1][2] == pytest.approx(solution.metrics.residual, abs=1e-5)
    assert same_bits(midair.solve(scene, solver).drive, solution.drive)


def test_progress_of_a_balanced_solve_speaks_of_the_final_drive() -> None:
    reported = []
    scene = small(pressures=1.0)
    midair.solve(scene, "greedy", balance=True, progress=lambda *step: reported.append(step[2]))
    solution = midair.solve(scene, "greedy", balance=True)
    # The pressures of the drive before it was scaled down to the targets, relative to the level.
    before = np.abs(solution.pressures) / solution.amplitudes.max() / scene.reach().level
    assert reported[-1] == pytest.approx(np.mean((1 - before) ** 2), abs=1e-4)
    assert solution.metrics.residual <= reported[-1]
    assert reported[0] > 0.9


@pytest.mark.parametrize(("solver", "no"), [("greedy", False), ("gs", np.False_)])
def test_false_stops_and_leaves_a_usable_answer(solver: str, no: object) -> None:
    last = 5 if solver == "greedy" else 1
    solution = midair.solve(small(), solver, progress=lambda step, *_: no if step == last else None)
    assert (solution.status, solution.steps) == ("stopped", last)
    assert usable(solution)
    assert solution.drive.any()
    if solver == "greedy":
        assert np.count_nonzero(solution.drive) == last


def test_nothing_but_false_stops() -> None:
    for answer in (None, True, 0, "no", object()):
        assert midair.solve(small(), "greedy", progress=lambda *_, answer=answer: answer).status == "done"


def test_stop_at_the_last_step_leaves_the_whole_answer() -> None:
    whole = midair.solve(small(), "greedy")
    stopped = midair.solve(small(), "greedy", progress=lambda step, steps, _: step < steps)
    assert (stopped.status, stopped.steps) == ("stopped", 64)
    assert same_bits(stopped.drive, whole.drive)


@pytest.mark.parametrize("error", [RuntimeError("mine"), KeyboardInterrupt(), SystemExit(3)], ids=repr)
def test_exception_of_the_callback_comes_out(error: BaseException) -> None:
    steps = []

    def raising(step: int, *_: object) -> None:
        steps.append(step)
        if step == 3:
            raise error

    with pytest.raises(type(error)) as caught:
        midair.solve(small(), "greedy", progress=raising)
    assert caught.value is error
    assert steps == [1, 2, 3]


def test_callback_may_solve_by_itself() -> None:
    scene, inner = small(), []
    midair.solve(scene, "greedy", progress=lambda *_: inner.append(midair.solve(scene, "naive").drive))
    assert len(inner) == 64
    assert same_bits(inner[0], inner[-1])


def run(code: str, **environment: str) -> str:
    """Runs code in a new interpreter and returns its output."""
    ran = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | environment, check=True, capture_output=True, text=True
    )
    return ran.stdout


@pytest.mark.slow
def test_results_have_the_same_bits_on_any_number_of_threads() -> None:
    one, two, five = (run(PICTURE, RAYON_NUM_THREADS=threads) for threads in "125")
    assert len(one.split()) == 4
    assert one == two == five


POSIX = pytest.mark.skipif(os.name == "nt", reason="signals and fork of POSIX")


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("call", LONG)
def test_interrupt_ends_whatever_takes_long(call: str) -> None:
    program = INTERRUPTED.format(LONG[call])
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "ready\n"
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=HANG)
    finally:
        child.kill()
        child.wait()
    assert (out, child.returncode) == ("interrupted\n", 0)


@pytest.mark.slow
@POSIX
def test_a_forked_child_has_threads_of_its_own() -> None:
    # The parent has used all its threads before the fork; the child must start its own.
    ran = subprocess.run(
        [sys.executable, "-c", FORKED], capture_output=True, text=True, timeout=HANG, check=True
    )
    assert ran.stdout == "0 True\n"


LEFT_BEHIND = """
import os, signal, threading, time
from midair._support.ctrl_c import interruptibly, leave
signal.signal(signal.SIGINT, signal.default_int_handler)
library, late = threading.Event(), []
def interrupt():
    global sent
    sent = time.monotonic()
    os.kill(os.getpid(), signal.SIGINT)
for attempt in range(3):
    threading.Timer(0.1, interrupt).start()
    try:
        interruptibly(library.wait, 60)
    except KeyboardInterrupt:
        late.append(time.monotonic() - sent)
print(len(late), min(late) < 0.1, flush=True)
{0}
leave(130)
"""


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("end", ["", "library.set()"])
def test_ctrl_c_leaves_a_call_of_a_library_behind(end: str) -> None:
    command = [sys.executable, "-c", LEFT_BEHIND.format(end)]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=HANG / 2)
    assert (ran.stdout, ran.stderr, ran.returncode) == ("3 True\n", "", 130)


def test_a_call_of_a_library_returns_and_raises() -> None:
    assert interruptibly(max, [3, 1], default=0) == 3
    with pytest.raises(ZeroDivisionError):
        interruptibly(divmod, 1, 0)
