"""Progress reports, stops and Ctrl-C, and the same bits on any number of threads."""

import os
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

FORKED = """
import os, sys, midair, numpy as np
scene = midair.Scene(midair.Array.grid(9, 7, pitch=0.01), [[0, 0, 0.1], [0.02, 0, 0.1]])
plane, points = midair.Plane(0.1, 0.1), np.tile(scene.points, (2000, 1, 1))
still, drive = midair.path.still([[0, 0, 0.1]], duration=0.01), np.ones(63)
traps = midair.sequence(scene.array, still, rate=500, signature="trap")
def work():
    answers = [
        midair.field(scene, drive, plane).pressure,
        midair.solve_batch(scene, points, solver="fast").drives,
        midair.gorkov(scene, drive, points[:40, 0]).force,
        midair.gorkov(scene, drive, points[0], bead={"radius": 4e-3}).force,
        midair.grad.force(scene, drive, points[:40, 0]).points,
        midair.rest(scene, drive).place,
        midair.fly(traps, duration=0.004).places,
        midair.skin(traps).fast,
        midair.tolerate(scene, phase=5, trials=10).rows["phase"].level,
    ]
    return b"".join(answer.tobytes() for answer in answers)
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
        [sys.executable, "-c", code],
        env=os.environ | environment,
        check=True,
        capture_output=True,
        encoding="utf-8",
    )
    return ran.stdout


@pytest.mark.slow
def test_results_have_the_same_bits_on_any_number_of_threads() -> None:
    one, two, five = (run(PICTURE, MIDAIR_THREADS=threads) for threads in "125")
    assert len(one.split()) == 4
    assert one == two == five


@pytest.mark.slow
def test_a_bad_number_of_threads_is_one_line() -> None:
    command = [sys.executable, "-m", "midair", "solve", "--preset", "autd3", "--at", "0,0,0.15"]
    for given in ("many", "0", "-1", "1e3"):
        ran = subprocess.run(command, env=os.environ | {"MIDAIR_THREADS": given}, capture_output=True, encoding="utf-8")
        refusal = f'error: MIDAIR_THREADS is "{given}": give a whole number of threads, 1 to 1024\n'
        assert (ran.returncode, ran.stdout, ran.stderr) == (2, "", refusal)


POSIX = pytest.mark.skipif(os.name == "nt", reason="signals and fork of POSIX")


@pytest.mark.slow
@POSIX
def test_a_forked_child_has_threads_of_its_own() -> None:
    # The parent has used all its threads before the fork; the child must start its own.
    ran = subprocess.run(
        [sys.executable, "-c", FORKED], capture_output=True, encoding="utf-8", timeout=HANG, check=True
    )
    assert ran.stdout == "0 True\n"


LEFT_BEHIND = """
import os, signal, threading, time
from midair._support.ctrl_c import LIBRARY, interruptibly, leave
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
# Python waits at its end for the threads that it knows.
running = sum(thread.is_alive() for thread in threading.enumerate() if thread.name == LIBRARY)
print(len(late), min(late) < 0.1, running, flush=True)
{0}
leave(130)
"""


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("end", ["", "library.set()"])
def test_ctrl_c_leaves_a_call_of_a_library_behind(end: str) -> None:
    command = [sys.executable, "-c", LEFT_BEHIND.format(end)]
    ran = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=HANG / 2)
    assert (ran.stdout, ran.stderr, ran.returncode) == ("3 True 3\n", "", 130)


def test_a_call_of_a_library_returns_and_raises() -> None:
    assert interruptibly(max, [3, 1], default=0) == 3
    with pytest.raises(ZeroDivisionError):
        interruptibly(divmod, 1, 0)
