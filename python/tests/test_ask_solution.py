"""Functions accept a Solution instead of its scene and drive,
and a Solution has the same functions as methods.
"""

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._boards import connection

POINTS = [[-0.02, 0.0, 0.12], [0.02, 0.01, 0.13]]
PLACES = {"ear": [0.0, 0.0, 0.6]}
PLANE = midair.Plane(0.12, 0.06, 16)
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")


def scenes() -> dict[str, midair.Scene]:
    array = midair.Array.preset("openmpd_board")
    return {
        "plain": midair.Scene(array, POINTS, 300.0),
        # This board has few amplitudes, so a scale below 1 remains for the supply voltage.
        "scaled": midair.Scene(midair.Array.preset("sonicsurface"), POINTS, 20.0),
        "trap": midair.Scene(array, POINTS, signature="trap"),
        "wall": midair.Scene(array, POINTS, obstacles=[midair.Wall([0, 0.09, 0], [0, -1, 0])]),
    }


@pytest.fixture(params=scenes())
def solution(request: pytest.FixtureRequest) -> midair.Solution:
    return midair.solve(scenes()[request.param])


def same(one: midair.Field, other: midair.Field) -> None:
    assert one.pressure.tobytes() == other.pressure.tobytes()


def test_field(solution: midair.Solution) -> None:
    for place in (None, PLANE, POINTS):
        long = midair.field(solution.scene, solution, place)
        same(midair.field(solution, place), long)
        same(midair.field(solution, plane=place), long)
        same(solution.field(place), long)
        assert solution.field(place).solution == solution


def test_judge(solution: midair.Solution) -> None:
    long = midair.judge(solution.scene, solution)
    assert long == midair.judge(solution) == solution.judge()
    weighted = midair.judge(solution.scene, solution, weights=[1, 2])
    assert weighted == solution.judge(weights=[1, 2])


def test_forces_and_streaming() -> None:
    solution = midair.solve(scenes()["trap"])
    for points in (None, POINTS[:1]):
        bead = midair.Bead(radius=5e-4)
        long = midair.gorkov(solution.scene, solution, points, bead=bead)
        assert long == midair.gorkov(solution, points, bead=bead) == solution.gorkov(points, bead=bead)
    force = midair.streaming(solution.scene, solution, POINTS).force
    np.testing.assert_array_equal(force, midair.streaming(solution, POINTS).force)
    own = solution.scene.absorption
    np.testing.assert_array_equal(force, solution.streaming(POINTS, absorption=own).force)


def test_exposure(solution: midair.Solution) -> None:
    long = midair.exposure(solution.scene, solution, PLACES)
    assert long == midair.exposure(solution, PLACES) == solution.exposure(PLACES, limit="howard")
    assert long == midair.exposure(solution, places=PLACES)


def test_exposure_of_a_sequence() -> None:
    ring = midair.path.circle([0, 0, 0.15], 0.01, frequency=5)
    sequence = midair.sequence(midair.Array.preset("sonicsurface"), ring, rate=100, change=np.pi)
    long = midair.exposure(sequence.scene(0), sequence, PLACES)
    assert long == midair.exposure(sequence, PLACES) == sequence.exposure(PLACES)


def test_tolerate() -> None:
    solution = midair.solve(scenes()["plain"])
    long = midair.tolerate(solution.scene, drive=solution, phase=20, trials=5)
    for short in (midair.tolerate(solution, phase=20, trials=5), solution.tolerate(phase=20, trials=5)):
        np.testing.assert_array_equal(short["phase"].level, long["phase"].level)
    with pytest.raises(midair.SceneError, match='solver is "uniform": drive is played as it is'):
        midair.tolerate(solution, "uniform", phase=20)


def test_levels_in_decibels() -> None:
    solution = midair.solve(scenes()["plain"])
    rms = np.abs(solution.pressures.astype(complex)) / np.sqrt(2)
    np.testing.assert_allclose(solution.spl, 20 * np.log10(rms / 20e-6), rtol=1e-12)
    assert solution.spl == pytest.approx(140.51, abs=0.3)
    dead = midair.solve(solution.scene.replace(pressures=[300.0, 0.0]), "bounded")
    assert dead.spl[1] < dead.spl[0]


@pytest.mark.parametrize(
    "made",
    [lambda one: pickle.loads(pickle.dumps(one)), copy.copy, lambda one: midair.solve_batch(
        midair.Array.preset("openmpd_board"), [POINTS], pressures=300.0)[0]],
)  # fmt: skip
def test_wherever_a_solution_comes_from(made: Callable[[midair.Solution], midair.Solution]) -> None:
    solution = midair.solve(scenes()["plain"])
    same(made(solution).field(POINTS), solution.field(POINTS))
    assert made(solution).judge() == solution.judge()


def test_a_session_s_and_a_file_s_solution(tmp_path: Path) -> None:
    solution = midair.Solver(midair.Array.preset("openmpd_board"))(POINTS, 900.0)
    same(solution.field(POINTS), midair.field(solution.scene, solution, POINTS))
    solution.save(tmp_path / "a.npz")
    same(midair.read(tmp_path / "a.npz").field(POINTS), solution.field(POINTS))


def test_a_matrix_has_metrics_and_no_air() -> None:
    scene = scenes()["plain"]
    own = midair.Propagation(scene.propagation())
    solution = midair.solve(own, pressures=900.0)
    assert solution.judge() == midair.judge(own, solution, pressures=900.0)
    assert solution.judge(pressures=500.0) == midair.judge(own, solution, pressures=500.0)
    asks: list[Callable[[], Any]] = [
        lambda: solution.field(POINTS),
        lambda: solution.gorkov(POINTS),
        lambda: solution.exposure(PLACES),
        lambda: solution.streaming(POINTS),
        lambda: solution.tolerate(phase=10),
        lambda: solution.play("null"),
    ]
    for ask in asks:
        with pytest.raises(midair.SceneError, match=r"^solution\.scene is None: ") as refusal:
            ask()
        assert "\n" not in str(refusal.value)


def test_a_drive_left_out_or_twice_is_named() -> None:
    solution = midair.solve(scenes()["plain"])
    assert solution.scene is not None
    with pytest.raises(midair.SceneError, match="drive is None: give one"):
        midair.field(solution.scene)
    with pytest.raises(midair.SceneError, match="drive is None: give one"):
        midair.judge(solution.scene)
    with pytest.raises(TypeError, match="the Solution has its own"):
        midair.judge(solution, solution)
    with pytest.raises(TypeError, match="the Solution has its own"):
        midair.field(solution, solution, POINTS)
    for ask in (midair.field, midair.gorkov, midair.streaming, midair.judge):
        with pytest.raises(TypeError, match=r"expected a midair\.Scene or "):
            ask(3, solution.drive)


def test_play_switches_off_at_its_end(tmp_path: Path) -> None:
    solution = midair.solve(midair.Scene(midair.Array.preset("sonicsurface"), POINTS))
    frames = tmp_path / "frames.bin"
    solution.play(f"file:{frames}", board="sonicsurface", seconds=0.15)
    board = midair.Board("sonicsurface", solution.scene.array)
    played = frames.read_bytes()
    assert -1 < played.rfind(bytes(board.encode(solution))) < played.rfind(bytes(board.off_frame))
    with pytest.raises(midair.SceneError, match="seconds is 0"):
        solution.play("null", seconds=0)


def test_an_array_names_its_preset() -> None:
    assert repr(midair.Array.preset("autd3")).startswith('<midair.Array "autd3" of 249 transducers, ')
    assert repr(midair.Array.preset("autd3", (2, 1))).startswith('<midair.Array "autd3", 2 x 1 boards, of 498 tr')
    assert repr(midair.Array.grid(4, 4, 0.01)).startswith("<midair.Array of 16 transducers, ")


def test_every_solution_keeps_the_bead_of_plain_foci() -> None:
    """A bead of 1.2 mm and 900 kg/m^3 has 6.51 mg, and half the displaced air beside them: 4.2 ug."""
    bead = {"density": 900.0, "radius": 1.2e-3}
    array = midair.Array.preset("openmpd_pair")
    points = [[0.0, 0.0, 0.0]]
    scene = midair.Scene(array, points, bead=bead)
    solver = midair.Solver(scene, "uniform")
    batch = midair.solve_batch(scene, [points], solver="uniform")
    keywords = midair.Solver(array, "uniform", bead=bead)(points)
    answers = [midair.solve(scene), solver(points), batch[0], keywords]
    answers += [pickle.loads(pickle.dumps(one)) for one in (answers[1], batch)]
    answers[-1] = answers[-1][0]
    for answer in answers:
        assert answer.scene.bead == scene.bead
        assert answer.gorkov().mass == pytest.approx(6.518e-6, rel=1e-3)
        assert answer.rest().mass == answer.gorkov().mass
    changed = scene.replace(points=[[0.0, 0.0, 0.001]], pressures=10.0)
    assert changed.bead == scene.bead


@pytest.mark.slow
def test_a_solution_is_played_on_the_array_that_it_is_of(monkeypatch: pytest.MonkeyPatch) -> None:
    array = midair.Array.preset("sonicsurface", mask=[True] * 250 + [False] * 6)
    solution = midair.solve(midair.Scene(array, [[0, 0, 0.15]]))
    connect, given = connection.connect, []

    def connected(address: str, **options: Any) -> midair.Connection:
        given.append(options)
        return connect(address, **options)

    monkeypatch.setattr(connection, "connect", connected)
    solution.play("sonicsurface:null", seconds=0.01)
    board = midair.Board("sonicsurface", array)
    solution.play("sonicsurface:null", seconds=0.01, board=board)
    assert given == [{"array": array}, {"board": board}]
