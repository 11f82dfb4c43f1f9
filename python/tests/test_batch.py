"""`solve_batch` and `Solver`: the same bits as single solves, all kinds of arguments, error messages."""

import threading

import numpy as np
import pytest

import midair

B, M = 9, 4
RNG = np.random.default_rng(5)
POINTS = RNG.uniform(-0.05, 0.05, (B, M, 3)) + np.array([0, 0, 0.15])
PRESSURES = RNG.uniform(0.7, 1.1, (B, M))
ARRAY = midair.Array.preset("paper20")


def single(k: int, solver: str, **options: object) -> midair.Solution:
    scene = midair.Scene(ARRAY, POINTS[k], PRESSURES[k])
    return midair.solve(scene, solver, **options)


#: A solver that solves problems together, one that solves them one by one, and one with the option `aim`.
KINDS = ("fast", "gs", "uniform")


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("solver", KINDS)
def test_a_batch_is_its_problems_bit_for_bit(solver: str) -> None:
    batch = midair.solve_batch(ARRAY, POINTS, PRESSURES, solver)
    assert len(batch) == B
    for array, shape, dtype in [
        (batch.drives, (B, 400), np.complex64),
        (batch.pressures, (B, M), np.complex64),
        (batch.metrics.sigma, (B,), np.float64),
        (batch.scale, (B,), np.float64),
        (batch.steps, (B,), np.int64),
    ]:
        assert (array.shape, array.dtype) == (shape, dtype)
    assert batch.elapsed > 0
    for k in range(B):
        alone = single(k, solver)
        assert batch.drives[k].tobytes() == alone.drive.tobytes()
        assert batch.pressures[k].tobytes() == alone.pressures.tobytes()
        assert (batch.status[k], batch.steps[k], batch.scale[k]) == (alone.status, alone.steps, alone.scale)
        for name in ("accuracy", "sigma", "uniformity", "level", "residual", "leak"):
            assert getattr(batch.metrics, name)[k] == getattr(alone.metrics, name)


@pytest.mark.parametrize("solver", ["greedy", *KINDS])
def test_neither_threads_nor_out_change_a_bit(solver: str) -> None:
    alone = midair.solve_batch(ARRAY, POINTS, PRESSURES, solver, threads=1)
    out = np.full((B, 400), np.nan, np.complex64)
    batch = midair.solve_batch(ARRAY, POINTS, PRESSURES, solver, threads=3, out=out)
    assert batch.drives is out
    assert out.tobytes() == alone.drives.tobytes()


def test_pressures_and_weights_of_every_shape() -> None:
    def drives(**keywords: object) -> bytes:
        return midair.solve_batch(ARRAY, POINTS, solver="fast", **keywords).drives.tobytes()

    one = drives(pressures=0.5)
    assert one == drives(pressures=[0.5] * M) == drives(pressures=np.full((B, M), 0.5))
    # A point of weight 0 is padding: the result is the same as without it.
    weights = np.ones((B, M))
    weights[2, 3] = 0
    padded = midair.solve_batch(ARRAY, POINTS, PRESSURES, "fast", weights=weights)
    scene = midair.Scene(ARRAY, POINTS[2, :3], PRESSURES[2, :3])
    assert padded.drives[2].tobytes() == midair.solve(scene, "fast").drive.tobytes()


def test_a_scene_lends_its_array_and_medium() -> None:
    scene = midair.Scene(ARRAY, POINTS[0], frequency=25e3, absorption=0.1)
    from_scene = midair.solve_batch(scene, POINTS, 0.5, "fast")
    from_array = midair.solve_batch(ARRAY, POINTS, 0.5, "fast", frequency=25e3, absorption=0.1)
    assert from_scene.drives.tobytes() == from_array.drives.tobytes()
    assert from_scene.drives.tobytes() != midair.solve_batch(ARRAY, POINTS, 0.5, "fast").drives.tobytes()


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_a_scenes_own_solver_counts() -> None:
    text = """
        [array]
        grid = { nx = 6, ny = 5, pitch = 0.01 }
        [solver]
        name = "greedy"
        phases = 16
        balance = true
        [[points]]
        position = [0, 0, 0.1]
    """
    scene = midair.Scene.parse(text)
    own = midair.solve_batch(scene, POINTS)
    assert own == midair.solve_batch(scene, POINTS, solver="greedy", phases=16, balance=True)
    assert own[0].options["phases"] == midair.Solver(scene).options["phases"] == 16
    assert own[0].options["balance"] is True
    # Keywords override the options of the scene's solver; another solver does not use those options.
    assert midair.solve_batch(scene, POINTS, phases=8)[0].options["phases"] == 8
    assert midair.solve_batch(scene, POINTS, solver="fast")[0].solver == "fast"


def test_starts_of_both_kinds() -> None:
    first = midair.solve_batch(ARRAY, POINTS, PRESSURES, "gs", steps=5)
    phases = np.zeros((B, M))
    for start in (first.drives, phases):
        batch = midair.solve_batch(ARRAY, POINTS, PRESSURES, "gs", start=start)
        alone = single(1, "gs", start=start[1])
        assert batch.drives[1].tobytes() == alone.drive.tobytes()


def test_progress_and_stop() -> None:
    reported: list[tuple[int, int, float]] = []
    midair.solve_batch(ARRAY, POINTS, PRESSURES, "fast", progress=lambda *now: reported.append(now))
    assert reported[-1][:2] == (B, B)
    assert 0 <= reported[-1][2] < 1
    many = np.tile(POINTS, (60, 1, 1))
    out = np.full((60 * B, 400), 7, np.complex64)
    stopped = midair.solve_batch(ARRAY, many, 0.5, "fast", threads=1, out=out, progress=lambda *now: False)
    done = 60 * B - stopped.status.count("stopped")
    assert 0 < done < 60 * B
    assert not stopped.drives[done:].any()
    # A problem that was not started has the all-zero drive and the status "stopped".
    silent = {"accuracy": 0, "sigma": 0, "uniformity": 0, "level": 0, "residual": 1, "leak": 0}
    assert stopped[-1].metrics.asdict() == silent
    assert {name: part[-1] for name, part in stopped.metrics.asdict().items()} == silent


BAD = {
    "points of a scene": ({"points": POINTS[0]}, r"points is of shape \(4, 3\)"),
    "no problems": ({"points": np.zeros((0, 4, 3))}, r"points is of shape \(0, 4, 3\)"),
    "one bad point": (
        {"points": np.where(np.arange(B)[:, None, None] == 6, np.nan, POINTS)},
        r"problems\[6\]: points\[0\]",
    ),
    "a negative pressure": ({"pressures": [1, 1, -1, 1]}, r"problems\[0\]: points\[2\]\.pressure is -1"),
    "pressures of another shape": ({"pressures": np.ones((B, 3))}, r"pressures is of shape \(9, 3\)"),
    "text": ({"pressures": "loud"}, "pressures is 'loud'"),
    "an option of another": ({"steps": 3}, 'unknown option of fast "steps"'),
    "a start unused": ({"start": np.zeros((B, M))}, "start is given to"),
    "out of another type": ({"out": np.zeros((B, 400))}, "out is"),
    "no threads": ({"threads": 0}, "threads is 0"),
    "less than no threads": ({"threads": -1}, "threads is -1"),
    "an aim unused": ({"aim": "max"}, "aim is given to"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_batches_are_refused_in_one_line(case: str) -> None:
    keywords, text = BAD[case]
    arguments = {"points": POINTS, "solver": "fast", **keywords}
    with pytest.raises(midair.SceneError, match=text) as refused:
        midair.solve_batch(ARRAY, **arguments)
    assert "\n" not in str(refused.value)


def test_a_first_argument_of_another_class() -> None:
    with pytest.raises(TypeError, match=r"midair\.Scene, midair\.Array or midair\.Propagation"):
        midair.solve_batch(POINTS, POINTS)
    with pytest.raises(TypeError, match=r"midair\.Scene, midair\.Array or midair\.Propagation"):
        midair.Solver("paper20", points=2)


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("solver", KINDS)
def test_a_solver_gives_single_answers_into_out(solver: str) -> None:
    fixed = midair.Solver(ARRAY, solver, points=M)
    out = np.empty(400, np.complex64)
    for k in range(3):
        alone = single(k, solver)
        answer = fixed(POINTS[k], PRESSURES[k], out=out)
        assert answer is fixed
        assert out.tobytes() == alone.drive.tobytes() == answer.drive.tobytes()
        assert (answer.metrics, answer.status, answer.steps) == (alone.metrics, alone.status, alone.steps)
        assert answer.pressures.tobytes() == alone.pressures.tobytes()
        assert fixed(POINTS[k], PRESSURES[k]).drive.tobytes() == alone.drive.tobytes()


def test_a_solver_takes_lists_fewer_points_and_a_start() -> None:
    solver = midair.Solver(ARRAY, "wgs", points=M, steps=20)
    first = solver(POINTS[0].tolist(), PRESSURES[0].tolist())
    again = solver(POINTS[0], PRESSURES[0], start=first)
    assert again.metrics.sigma <= first.metrics.sigma + 1e-3
    assert solver(POINTS[0, :2]).pressures.shape == (2,)
    assert solver(POINTS[0], weights=[1, 0, 1, 1]).status == "done"
    assert solver.options["steps"] == 20
    assert "wgs" in repr(solver)


def test_a_solver_refuses_in_one_line_and_goes_on() -> None:
    solver = midair.Solver(ARRAY, "fast", points=M)
    out = np.empty(400, np.complex64)
    before = solver(POINTS[0], out=out).drive
    for arguments, keywords, text in [
        ((np.zeros((5, 3)),), {}, "made for 4"),
        (([[0, 0, float("nan")]],), {}, r"points\[0\]\.position"),
        ((POINTS[0], -1.0), {}, r"points\[0\]\.pressure is -1"),
        ((POINTS[0], [1.0]), {}, "pressures is of shape"),
        ((POINTS[0],), {"out": np.empty(399, np.complex64)}, "out is"),
        ((POINTS[0],), {"start": np.zeros(M)}, "start is given"),
    ]:
        with pytest.raises(midair.SceneError, match=text):
            solver(*arguments, **keywords)
        assert solver(POINTS[0], out=out).drive.tobytes() == before.tobytes()
    with pytest.raises(midair.SceneError, match="points is 0"):
        midair.Solver(ARRAY, points=0)
    with pytest.raises(midair.SceneError, match="none yet"):
        _ = midair.Solver(ARRAY, points=1).drive


def test_a_solver_at_work_refuses_a_second_thread_in_one_line() -> None:
    busy = midair.Solver(ARRAY, "lm", steps=5000, eps=0.0)
    points = np.random.default_rng(1).uniform(-0.1, 0.1, (64, 3)) + np.array([0, 0, 0.2])
    refused = threading.Event()

    def work() -> None:
        while not refused.is_set():
            busy(points)

    def look_on() -> None:
        while at_work.is_alive():
            _ = busy.elapsed

    at_work = threading.Thread(target=work)
    at_work.start()
    try:
        with pytest.raises(midair.SceneError, match=r"solver is at work in another thread: give each thread"):
            look_on()
    finally:
        refused.set()
        at_work.join()
