"""Ctrl-C at random moments of every function that may take long: it acts within half a second of CPU time."""

import os
import random
import signal
import subprocess
import sys

import pytest

#: Moments for each call. MIDAIR_SLOW takes more of them, and two threads too.
SLOW = os.environ.get("MIDAIR_SLOW") == "1"
MOMENTS, THREADS = (20, (1, 2)) if SLOW else (3, (1,))

#: Largest CPU time in s of a thread from the signal to the end of the call; latest moment of the signal.
ALLOWED, LATEST = 0.5, 1.5

#: Time limit in s, far above the time that Ctrl-C may take: a hang is a failed test, not a hung test suite.
HANG = 120

#: The child runs the call again and again; each time a timer of CPU time sends Ctrl-C. A call that ends before
#: is begun again, until the signal has come.
PROGRAM = """
import signal, sys, tempfile, time, warnings, midair, numpy as np
warnings.simplefilter("ignore")
signal.signal(signal.SIGPROF, lambda *_: signal.raise_signal(signal.SIGINT))
signal.signal(signal.SIGINT, signal.default_int_handler)
random = np.random.default_rng(0)
def near(*shape, z=0.2):
    return random.uniform(-0.05, 0.05, (*shape, 3)) + [0, 0, z]
def large(count):
    return midair.Scene(midair.Array.grid(200, 200, pitch=0.005), near(count, z=0.3))
def mesh(steps):
    u, v = np.meshgrid(np.linspace(0, 1, steps), np.linspace(0, 1, steps), indexing="ij")
    flat = np.stack([0.1 * u - 0.05, 0.1 * v - 0.05, 0.02 * u * v + 0.2], -1).reshape(-1, 3)
    i = (np.arange(steps - 1)[:, None] * steps + np.arange(steps - 1)).ravel()
    return midair.Mesh(flat, np.r_[np.c_[i, i + 1, i + steps], np.c_[i + 1, i + steps + 1, i + steps]])
four, pair = midair.Array.preset("autd3", (2, 2)), midair.Array.preset("openmpd_pair", quantization={})
angle = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
circle = np.stack([0.02 * np.cos(angle), 0.02 * np.sin(angle), 0 * angle], -1)[:, None]
SETUP
def call():
    return CALL
for moment in MOMENTS:
    begin = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, moment)
    try:
        while time.process_time() - begin < moment:
            call()
    except KeyboardInterrupt:
        pass
    print(time.process_time() - begin - moment, flush=True)
"""

#: The calls, each with what it needs: the whole call takes much longer than `LATEST`.
CALLS = {
    "solve, greedy": ('midair.solve(few, "greedy", amplitudes=256, phases=4096, objective="l1")', "few = large(16)"),
    "solve, evd": ('midair.solve(many, "evd")', "many = large(3000)"),
    "solve, sdp": ('midair.solve(many, "sdp")', "many = large(3000)"),
    "solve, tikhonov": ('midair.solve(many, "tikhonov")', "many = large(3000)"),
    "solve, uniform": ('midair.solve(many, "uniform")', "many = large(3000)"),
    "solve, descent": ('midair.solve(many, "descent", steps=100000)', "many = large(300)"),
    "solve, lm": ('midair.solve(many, "lm")', "many = large(3000)"),
    "solve, traps": ('midair.solve(many)', 'many = midair.Scene(four, near(64), signature="trap")'),
    "Solver": ("follow(points)", 'follow, points = midair.Solver(large(1).array, "lm"), near(3000)'),
    "solve_batch": ('midair.solve_batch(four, points, solver="lm")', "points = near(20000, 64)"),
    "compare": ("midair.compare(many)", "many = large(300)"),
    "field": ("midair.field(few, drive, midair.Plane(0.2, 0.2, pixels=2000))", "few, drive = large(4), np.ones(40000)"),
    "field beside a mesh": (
        "midair.field(midair.Scene(four, near(1, z=.1), obstacles=[mesh(36)]), np.ones(len(four)), midair.Plane(.1, .1))",
        "",
    ),
    "propagation": ("large(20000).propagation()", ""),
    "propagation, a large matrix": ("midair.solve(matrix, 'gs')", "matrix = midair.Propagation(random.normal(size=(3000, 6000)) + 1j)"),
    "reach": ("many.reach()", "many = large(3000)"),
    "judge": ("midair.judge(many, np.ones(40000))", "many = large(5000)"),
    "judge, many drives": ("midair.judge(four, drives, points=near(8))", "drives = np.ones((60000, len(four)), np.complex64)"),
    "bound": ("midair.bound(few)", "few = large(16)"),
    "gorkov": ("midair.gorkov(few, np.ones(40000), points)", "few, points = large(1), near(20000)"),
    "gorkov, large spheres": (
        'midair.gorkov(midair.Scene(four, points), np.ones(len(four)), points, bead={"radius": 4e-3})',
        "points = near(8000)",
    ),
    "rest": ("midair.rest(scene, np.ones(len(pair)), points)", 'points = near(20000, z=0); scene = midair.Scene(pair, points)'),
    "streaming": ("midair.streaming(few, np.ones(40000), midair.Plane(0.2, 0.2, pixels=1000))", "few = large(4)"),
    "exposure": ('midair.exposure(few, np.ones(40000), {"head": near(200000)})', "few = large(4)"),
    "grad.amplitude": ("midair.grad.amplitude(few, np.ones(40000), points)", "few, points = large(1), near(20000)"),
    "grad.force": ("midair.grad.force(few, np.ones(40000), points, np.ones((20000, 3)))", "few, points = large(1), near(20000)"),
    "grad.stiffness": ("midair.grad.stiffness(few, np.ones(40000), points)", "few, points = large(1), near(20000)"),
    "sequence": ("midair.sequence(four, near(4000, 8), rate=1e3)", ""),
    "sequence, foci ahead": ('midair.sequence(four, near(2000, 8), rate=1e3, ahead="all", change=0.1)', ""),
    "sequence, traps ahead": (
        'midair.sequence(pair, circle, rate=4e3, signature="trap", ahead="all", closed=True)', ""
    ),
    "sequence.judge": ("played.judge()", "played = midair.Sequence(four, near(20000, 8), np.ones((20000, 8)), np.ones((20000, len(four)), np.complex64), rate=1e3)"),
    "stream": ("list(midair.stream(four, near(4000, 8), rate=1e3))", ""),
    "haptic": ("midair.haptic([[-0.02, 0, 0.15], [0.02, 0, 0.15]], four, rate=8e3)", ""),
    "haptic within a bound": ("midair.haptic([[-0.02, 0, 0.15], [0.02, 0, 0.15]], four, rate=2e4, change=0.5)", ""),
    "skin": ("midair.skin(played)", "played = midair.Sequence(four, near(20000, 1), np.ones((20000, 1)), np.ones((20000, len(four)), np.complex64), rate=2e4)"),
    "felt": ("played.felt(near(50))", "played = midair.Sequence(four, near(20000, 1), np.ones((20000, 1)), np.ones((20000, len(four)), np.complex64), rate=2e4)"),
    "fly": (
        "midair.fly(played, duration=100)",
        'X = circle[::10] + 0.012 * np.array([[1, 1, 0], [-1, 1, 0], [1, -1, 0], [-1, -1, 0]]); played = midair.sequence(pair, X, rate=1e3, signature="trap")',
    ),
    "path.fastest": ("midair.path.fastest(circle[::4, 0], pair)", ""),
    "tolerate": ("midair.tolerate(scene, phase=20, trials=10**6)", "scene = midair.Scene(four, near(16))"),
    "calibrate": (
        "midair.calibrate(four, drives, received, microphones=places)",
        "places = near(6); drives = midair.calibration_drives(four, 4.0, microphones=6); received = np.abs(drives @ midair.Scene(four, places).propagation().T) * random.normal(1, .05, (len(drives), 6))",
    ),
    "doctor": (
        "midair.doctor(four, lambda drive: np.abs(matrix @ drive) * random.normal(1, .02, 6), microphones=places)",
        "places = near(6); matrix = midair.Scene(four, places).propagation() * random.choice([0, 1, 1, -1], len(four))",
    ),
    "tune": (
        'midair.tune(lambda drive: np.abs(matrix @ drive), four, "greedy", phases=256, tries=True)',
        "matrix = midair.Scene(four, near(2000)).propagation()",
    ),
    "sweep": (
        'midair.sweep({"array": {"preset": "paper20"}, "points": {"count": 4, "x": [-.1, .1], "y": [-.1, .1], "z": 0.2}, "solver": {"name": ["fast", "gs"]}, "seeds": 10**6})',
        "",
    ),
    "dataset": (
        'midair.dataset({"array": {"preset": "sonicsurface"}, "points": {"count": [2, 3], "x": [-.04, .04], "y": [-.04, .04], "z": [.1, .15]}, "solver": {"name": "fast"}, "seeds": 10**6}, tempfile.mkdtemp())',
        "",
    ),
    "bodies": ("midair.Scene(four, near(3), obstacles=[mesh(44)]).propagation()", ""),
}


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals and timers of POSIX")
@pytest.mark.parametrize("threads", THREADS)
@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_acts_at_any_moment_of_whatever_takes_long(name: str, threads: int) -> None:
    call, setup = CALLS[name]
    moments = [random.uniform(0.01, LATEST * threads) for _ in range(MOMENTS)]
    program = PROGRAM.replace("SETUP", setup).replace("CALL", call).replace("MOMENTS", repr(moments))
    environment = os.environ | {"RAYON_NUM_THREADS": str(threads), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", program]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=HANG * MOMENTS)
    assert ran.returncode == 0, ran.stderr[-2000:]
    late = [float(line) for line in ran.stdout.split()]
    print(f"{name}: at most {max(late):.2f} s of CPU after the signal")
    assert len(late) == MOMENTS
    assert max(late) < ALLOWED * threads, dict(zip(moments, late, strict=True))
