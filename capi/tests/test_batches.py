"""Batches of a session and of scenes have the same bits as `midair.solve_batch` and `midair.solve`."""

from ctypes import c_char_p, c_void_p

import numpy as np
import pytest

import midair
from library import ANSWER, METRICS, Library
from test_same_bits import STATUSES
from test_scenes import POINTS, SCENES, SPHERE, WALL

PROBLEMS, COUNT = 40, 3
GRID = "[array]\ngrid = { nx = 12, ny = 10, pitch = 0.0105 }\n"
HEADS = {
    "plain": GRID,
    "wall": GRID + WALL,
    "sphere": GRID + SPHERE,
    "trap": 'signature = "trap"\n' + GRID,
    "greedy": GRID + '[solver]\nname = "greedy"\nphases = 32\nseed = 7\n',
    "glide": GRID + '[solver]\nname = "glide"\naim = "max"\n',
    "fast": GRID + '[solver]\nname = "fast"\nbalance = true\n',
}
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")


def requests() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    points = rng.uniform(-0.03, 0.03, (PROBLEMS, COUNT, 3)) + np.array([0, 0, 0.14])
    return points, rng.uniform(300, 900, (PROBLEMS, COUNT)), rng.integers(0, 3, (PROBLEMS, COUNT)) + 0.5


def batch(
    library: Library,
    session: c_void_p,
    size: int,
    threads: int,
    points: np.ndarray,
    *lists: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray, str]:
    drives, answers = np.zeros((len(points), size), np.complex64), np.zeros(len(points), ANSWER)
    given = (session, points, *lists, *points.shape[:2], threads, drives, size, answers)
    return drives, answers, library.done("session_solve_batch", *given)


@pytest.mark.parametrize("name", HEADS)
def test_a_batch_has_the_bits_of_the_package(library: Library, name: str) -> None:
    text = HEADS[name] + POINTS
    scene = midair.Scene.parse(text)
    points, pressures, weights = requests()
    session = library.new("session_open", text, None)
    for lists in ((pressures, weights), (pressures, None), (None, None)):
        mine = midair.solve_batch(scene, points, lists[0], weights=lists[1])
        for threads in (1, 2, 0):
            drives, answers, _ = batch(library, session, len(scene.array), threads, points, *lists)
            assert drives.tobytes() == mine.drives.tobytes()
            assert [STATUSES[status] for status in answers["status"]] == list(mine.status)
            assert answers["steps"].tolist() == mine.steps.tolist()
            assert answers["scale"].tolist() == mine.scale.tolist()
            for metric in METRICS:
                assert answers[metric].tolist() == getattr(mine.metrics, metric).tolist()
    library.plain("session_free", session)


def test_a_batch_over_threads_has_the_bits_of_the_package(library: Library) -> None:
    array = library.new("array_grid", 12, 10, 0.0105)
    session = library.session(array, "naive")
    # There are so many problems that several threads get a part.
    points = np.random.default_rng(6).uniform(-0.03, 0.03, (6000, 2, 3)) + np.array([0, 0, 0.14])
    mine = midair.solve_batch(midair.Array.grid(12, 10, 0.0105), points, solver="naive")
    for threads in (1, 2, 10**9):
        assert batch(library, session, 120, threads, points, None, None)[0].tobytes() == mine.drives.tobytes()
    library.plain("session_free", session)
    library.plain("array_free", array)


def test_a_batch_warns_as_the_package_does(library: Library) -> None:
    session = library.new("session_open", GRID + POINTS, None)
    points, pressures, _ = requests()
    with pytest.warns(midair.SceneWarning) as caught:
        midair.solve_batch(midair.Scene.parse(GRID + POINTS), points, 9e4 * pressures)
    said = batch(library, session, 120, 2, points, 9e4 * pressures, None)[2]
    assert said.splitlines() == [str(one.message) for one in caught]
    library.plain("session_free", session)


def test_what_no_batch_can_be_is_refused_and_nothing_is_written(library: Library) -> None:
    session = library.new("session_open", GRID + POINTS, None)
    points, pressures, _ = requests()
    drives = np.full((PROBLEMS, 120), 7, np.complex64)
    wrong = points.copy()
    wrong[17, 1, 2] = np.nan
    for given, fault in [
        (
            (wrong, pressures, None, PROBLEMS, COUNT, 2, drives, 120),
            "problems[17]: points[1]",
        ),
        ((points, -pressures, None, PROBLEMS, COUNT, 2, drives, 120), "problems[0]: points[0].pressure is -"),
        ((points, None, None, PROBLEMS, COUNT, 2, drives, 119), "transducers is 119: the session has 120"),
        ((points, None, None, 0, COUNT, 2, drives, 120), "batch is 0: give at least one problem"),
        ((points, None, None, 2**62, COUNT, 2, drives, 120), "no memory holds so many"),
        ((points, None, None, PROBLEMS, COUNT, 2, None, 120), "drives is NULL"),
        ((None, None, None, PROBLEMS, COUNT, 2, drives, 120), "points is NULL"),
    ]:
        result, message = library.call("session_solve_batch", session, *given, None)
        assert result == 1, message
        assert fault in message
        assert "\n" not in message
    assert (drives == 7).all()
    library.plain("session_free", session)


def scenes(library: Library, texts: list[str], threads: int, size: int) -> tuple[int, str, np.ndarray, np.ndarray]:
    drives, answers = np.full((len(texts), size), 7, np.complex64), np.zeros(len(texts), ANSWER)
    list_of = (c_char_p * len(texts))(*(text.encode() for text in texts))
    found = library.call("solve_scenes", list_of, None, len(texts), threads, drives, size, answers)
    return *found, drives, answers


@pytest.mark.parametrize("threads", [0, 1, 3])
def test_several_scenes_have_the_bits_of_the_package(library: Library, threads: int) -> None:
    texts = [head + POINTS for head in SCENES.values()]
    mine = [midair.solve(midair.Scene.parse(text)) for text in texts]
    size = max(len(one.drive) for one in mine)
    result, message, drives, answers = scenes(library, texts, threads, size)
    assert result == 0, message
    for one, drive, answer in zip(mine, drives, answers, strict=True):
        row = np.zeros(size, np.complex64)
        row[: len(one.drive)] = one.drive
        assert drive.tobytes() == row.tobytes()
        assert STATUSES[answer["status"]] == one.status
        assert [answer[metric] for metric in METRICS] == [getattr(one.metrics, metric) for metric in METRICS]


@pytest.mark.parametrize(
    ("text", "size", "fault"),
    [
        ('[array]\nprest = "autd3"\n', 256, "scenes[1], line 2, column 1: unknown key of array"),
        (GRID + POINTS, 119, "scenes[1] is 120 transducers: a row of drives has room for 119"),
        (
            GRID + POINTS.replace("-0.02, 0.01, 0.12", "-0.00525, 0.00525, 0.0"),
            256,
            "scenes[1]: points[0] is ",
        ),
    ],
)
def test_a_refused_scene_is_named_and_nothing_is_written(library: Library, text: str, size: int, fault: str) -> None:
    first = "[array]\ngrid = { nx = 3, ny = 3, pitch = 0.01 }\n" + POINTS
    result, message, drives, _ = scenes(library, [first, text, first], 2, size)
    assert result == 1
    assert message.startswith(fault)
    assert (drives == 7).all()
