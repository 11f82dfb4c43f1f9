"""Progress, stops and Ctrl-C, and the same bits on any number of threads."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import midair
from scenes import same_bits, small, usable

#: One step a transducer, and one step an iteration.
SOLVERS = ("greedy", "gs")

#: Nobody waits this long for Ctrl-C; it is there so that a hang is a failure and not a hung suite.
HANG = 60

SEARCH = """
import signal, sys, midair, numpy as np
# A shell that runs the tests in the background has its children ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
points = np.random.default_rng(0).uniform(-0.1, 0.1, (16, 3)) + [0, 0, 0.3]
scene = midair.Scene(midair.Array.grid(200, 200, pitch=0.005), points)
try:
    print("ready", flush=True)
    midair.solve(scene, "greedy", amplitudes=256, phases=4096, objective="l1")
except KeyboardInterrupt:
    print("interrupted", flush=True)
else:
    print("finished", flush=True)
"""

BATCH = """
import signal, midair, numpy as np
signal.signal(signal.SIGINT, signal.default_int_handler)
points = np.random.default_rng(0).uniform(-0.1, 0.1, (20_000, 64, 3)) + [0, 0, 0.3]
try:
    print("ready", flush=True)
    midair.solve_batch(midair.Array.preset("autd3", (2, 2)), points, solver="lm", threads=2)
except KeyboardInterrupt:
    print("interrupted", flush=True)
else:
    print("finished", flush=True)
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
def test_progress_is_told_every_step(solver: str) -> None:
    told = []
    scene = small()
    solution = midair.solve(scene, solver, progress=lambda *step: told.append(step), trace=True)
    assert [step for step, _, _ in told] == list(range(1, solution.steps + 1))
    # An iterative method may be done before its steps run out.
    (steps,) = {steps for _, steps, _ in told}
    assert steps >= len(told) == solution.steps
    assert {tuple(map(type, step)) for step in told} == {(int, int, float)}
    assert np.array_equal([residual for _, _, residual in told], solution.trace)
    # The last step's residual is the answer's: an f32 field kept along the way, and one computed anew.
    assert told[-1][2] == pytest.approx(solution.metrics.residual, abs=1e-5)
    assert same_bits(midair.solve(scene, solver).drive, solution.drive)


def test_progress_of_a_balanced_solve_speaks_of_the_final_drive() -> None:
    told = []
    scene = small(pressures=1.0)
    midair.solve(scene, "greedy", balance=True, progress=lambda *step: told.append(step[2]))
    solution = midair.solve(scene, "greedy", balance=True)
    assert told[-1] == pytest.approx(solution.metrics.residual, abs=1e-5)
    assert told[0] > 0.9


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
    """What a fresh interpreter prints."""
    ran = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | environment, check=True, capture_output=True, text=True
    )
    return ran.stdout


def test_results_have_the_same_bits_on_any_number_of_threads() -> None:
    one, two, five = (run(PICTURE, RAYON_NUM_THREADS=threads) for threads in "125")
    assert len(one.split()) == 4
    assert one == two == five


@pytest.mark.skipif(not hasattr(signal, "SIGINT") or os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("program", [SEARCH, BATCH], ids=["solve", "solve_batch"])
def test_interrupt_ends_a_long_solve(program: str) -> None:
    # A step takes milliseconds, and there are tens of thousands: what ends within HANG was interrupted.
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "ready\n"
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=HANG)
    finally:
        child.kill()
        child.wait()
    assert (out, child.returncode) == ("interrupted\n", 0)
