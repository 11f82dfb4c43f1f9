"""Arrays of other libraries: inputs by `__dlpack__` or `__array_interface__`,
and results that others read.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._midair import numbers

ARRAY = midair.Array.preset("autd3")
POINTS = np.array([[-0.02, 0, 0.15], [0.02, 0.01, 0.15]])


class Tensor:
    """An array with DLPack alone, like a tensor of another library."""

    def __init__(self, values: Any, device: tuple[int, int] = (1, 0)) -> None:
        # This version of DLPack cannot mark arrays as read-only, so the array must be writable.
        self.values = np.require(values, requirements="W")
        self.device = device

    def __dlpack__(self, *, dl_device: tuple[int, int] | None = None, **options: Any) -> Any:
        # The memory of a GPU is exported as a copy for the CPU if the caller requests one.
        if self.device != (1, 0) and dl_device != (1, 0):
            raise BufferError("on the GPU")
        return self.values.__dlpack__()

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.device


class Interface:
    """An array with NumPy's interface alone."""

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values)
        self.__array_interface__ = self.values.__array_interface__


class Locked(Tensor):
    """A tensor that cannot be exported, like one that records gradients."""

    def __dlpack__(self, **options: Any) -> Any:
        raise BufferError("detach it")

    def __array__(self, *given: Any, **options: Any) -> Any:
        raise RuntimeError("detach it")


OTHERS = {"dlpack": Tensor, "interface": Interface}


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_points_drives_and_fields_of_another_library(other: Any) -> None:
    scene = midair.Scene(ARRAY, POINTS, [800, 600])
    same = midair.Scene(ARRAY, other(POINTS), other([800.0, 600.0]))
    np.testing.assert_array_equal(same.points, scene.points)
    solution = midair.solve(scene)
    np.testing.assert_array_equal(midair.solve(same).drive, solution.drive)
    drive = other(solution.drive)
    np.testing.assert_array_equal(
        midair.field(scene, drive, other(POINTS)).pressure, midair.field(scene, solution, POINTS).pressure
    )
    board = midair.Board("autd3")
    assert board.encode(drive) == board.encode(solution)
    frames = [other(POINTS + np.array([0.0005 * t, 0, 0])) for t in range(3)]
    streamed = list(midair.stream(ARRAY, frames, rate=80.0))
    np.testing.assert_array_equal(streamed, list(midair.stream(ARRAY, [frame.values for frame in frames], rate=80.0)))


SCENE = midair.Scene(ARRAY, POINTS, [800, 600])
SOLUTION = midair.solve(SCENE)
DRIVE = SOLUTION.drive
FRAMES = np.array([POINTS + np.array([0, 1e-4 * t, 0]) for t in range(4)])
PATH = midair.path.from_array(FRAMES, rate=100)
SEQUENCE = midair.sequence(ARRAY, FRAMES, rate=1000)
LEVITATING = midair.sequence(ARRAY, FRAMES[:, :1], rate=1000, signature="trap")
SKIN = midair.skin(SEQUENCE)
FEW = midair.Array.grid(4, 4, 0.01)
PLAYED = midair.calibration_drives(FEW, 8, microphones=2)
MICROPHONES = np.array([[0, 0, 0.1], [0.01, 0, 0.1]])
SMALL = midair.Scene(FEW, MICROPHONES)
READINGS = np.abs(PLAYED @ SMALL.propagation().T)
MATRIX = SCENE.propagation()
ONES = np.ones(len(ARRAY))
TETRAHEDRON = 0.01 * np.array([[0, 0, 10], [1, 0, 10], [0, 1, 10], [0, 0, 11.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
PAIR = midair.Array.preset("openmpd_pair", quantization={})
RING = 5e-3 * np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
Wrap = Callable[[Any], Any]


def held_out(path: Path) -> midair.Dataset:
    """Return a small data set."""
    request = {
        "array": {"preset": "paper20"},
        "points": {"count": 2, "x": [0, 0.1], "y": 0.0, "z": 0.1},
        "seeds": 10,
    }
    return midair.dataset({**request, "solver": {"name": "naive"}}, path)


def read_out(drive: Any) -> Any:
    """Return |p| at the microphones."""
    return np.abs(SMALL.propagation() @ drive)


def played(w: Wrap) -> bytes:
    """Return the bytes of a simulated board that sent, streamed and modulated."""
    limit = {"positions": w(np.array([[0, 0.3, 0.3]])), "pressure": w(np.array([1e5]))}
    with midair.connect("null", array=ARRAY, limit=limit) as connection:
        connection.send(w(DRIVE))
        connection.stream(w(np.stack([DRIVE, DRIVE])), rate=50)
        connection.stream([w(DRIVE)], rate=50)
        connection.modulate(w(np.linspace(0, 1, 4)))
    return b""


#: Each public function that takes points, pressures, drives, places or other numbers. `w` wraps an array.
TAKE_ARRAYS: dict[str, Callable[[Wrap], Any]] = {
    "Array": lambda w: (
        midair.Array(w(FEW.positions), w(FEW.normals), response=w(np.ones(16)), mask=w(np.ones(16) > 0)).positions
    ),
    "Array.channels": lambda w: midair.Array(w(FEW.positions), channels=w(np.arange(16))).channels,
    "Array.quantization": lambda w: midair.Array.grid(
        2, 2, 0.01, quantization={"phases": 8, "amplitudes": w(np.array([0.0, 0.5, 1.0]))}
    ).quantization["amplitudes"],
    "Scene": lambda w: midair.Scene(ARRAY, w(POINTS), w(np.array([800.0, 600.0])), weights=w(np.ones(2))).points,
    "Scene.signature": lambda w: midair.Scene(ARRAY, POINTS, signature=w(ONES + 0j)).propagation(),
    "Scene.replace": lambda w: SCENE.replace(points=w(POINTS), pressures=w(np.ones(2))).points,
    "Wall": lambda w: midair.Wall(w(np.array([0, 0, 1.0])), w(np.array([0, 0, -1.0]))).point,
    "Sphere": lambda w: midair.Sphere(w(np.array([0, 0, 0.1])), 0.01).center,
    "Mesh": lambda w: midair.Mesh(w(TETRAHEDRON), w(FACES)).vertices,
    "Propagation": lambda w: midair.solve(midair.Propagation(w(MATRIX)), "naive", pressures=w(np.ones(2))).drive,
    "solve": lambda w: midair.solve(SCENE, pressures=w(np.ones(2)), start=w(DRIVE)).drive,
    "Solver": lambda w: midair.Solver(ARRAY)(w(POINTS), w(np.ones(2))).drive,
    "Solver.follow": lambda w: midair.Solver(ARRAY).follow(w(FRAMES), w(np.ones((4, 2)))),
    "solve_batch": lambda w: midair.solve_batch(ARRAY, w(FRAMES), w(np.ones((4, 2)))).drives,
    "bound": lambda w: midair.bound(SCENE, pressures=w(np.ones(2))),
    "judge": lambda w: midair.judge(SCENE, w(DRIVE)).level,
    "judge of an array": lambda w: (
        midair.judge(ARRAY, w(DRIVE[None]), points=w(POINTS[None]), pressures=w(np.ones(2))).level
    ),
    "Solution.judge": lambda w: SOLUTION.judge(pressures=w(np.ones(2))).level,
    "field": lambda w: midair.field(SCENE, w(DRIVE), w(POINTS)).pressure,
    "gorkov": lambda w: midair.gorkov(SCENE, w(DRIVE), w(POINTS)).potential,
    "rest": lambda w: midair.rest(LEVITATING.scene(0), w(LEVITATING.drive(0)), w(FRAMES[0, :1])).place,
    "grad.pressure": lambda w: midair.grad.pressure(SCENE, w(DRIVE), w(POINTS), w(np.ones(2) + 0j)).drive,
    "compare": lambda w: [
        each.drive
        for each in midair.compare(SCENE, ["naive"], pressures=w(np.ones(2)), weights=w(np.array([1.0, 0.0]))).solutions
    ],
    "exposure": lambda w: (
        midair.exposure(
            SCENE,
            w(DRIVE),
            {"ear": w(np.array([0, 0.1, 0.5])), "box": w(np.array([[0.1, 0, 0.5], [0.2, 0, 0.6]]))},
        ).worst.spl
    ),
    "streaming": lambda w: midair.streaming(SCENE, w(DRIVE), w(POINTS)).force,
    "tolerate": lambda w: midair.tolerate(SCENE, drive=w(DRIVE), phase=0.1, trials=2).rows["phase"].level,
    "calibrate": lambda w: midair.calibrate(FEW, w(PLAYED), w(READINGS), microphones=w(MICROPHONES)).response,
    "calibrate second_board": lambda w: (
        midair.calibrate(SMALL, PLAYED, READINGS, second_board=w(np.arange(8))).response
    ),
    "tune": lambda w: (
        midair.tune(
            lambda drive: w(read_out(drive)),
            SMALL,
            "spsa",
            targets=w(np.ones(2)),
            start=w(np.ones(16) + 0j),
            steps=2,
        ).drive
    ),
    "doctor": lambda w: midair.doctor(FEW, lambda drive: w(read_out(drive)), microphones=w(MICROPHONES)).response,
    "beam": lambda w: midair.beam(SCENE, w(np.array([0, 0.1, 1.0]))),
    "ear": lambda w: midair.ear(w(np.array([0, 0, 0.1]))).points,
    "sequence": lambda w: midair.sequence(ARRAY, w(FRAMES), rate=1000, pressures=w(np.ones((4, 2)))).drives,
    "sequence of a list": lambda w: midair.sequence(ARRAY, list(map(w, FRAMES)), rate=1000).drives,
    "stream": lambda w: list(midair.stream(ARRAY, [w(frame) for frame in FRAMES], rate=1000.0)),
    "stream of pairs": lambda w: list(
        midair.stream(ARRAY, [(w(frame), w(np.ones(2))) for frame in FRAMES], rate=1000.0)
    ),
    "Sequence": lambda w: midair.Sequence(ARRAY, w(FRAMES), w(np.ones((4, 2))), w(SEQUENCE.drives), rate=1000).drives,
    "Sequence of codes": lambda w: (
        midair.Sequence(
            ARRAY,
            w(FRAMES),
            w(np.ones(2)),
            w(np.zeros((4, len(ARRAY)), np.uint8)),
            rate=1000,
            quantization={"phases": 8},
        ).drives
    ),
    "Sequence.felt": lambda w: SEQUENCE.felt(w(POINTS[0])).values,
    "Solution.modulated": lambda w: SOLUTION.modulated(w(np.linspace(0, 1, 4)), samples_rate=500).drives,
    "fly": lambda w: midair.fly(LEVITATING, w(FRAMES[0, :1]), speeds=w(np.zeros((1, 3))), duration=0.004).places,
    "Skin.spectrum": lambda w: SKIN.spectrum(w(SKIN.places[0])),
    "Skin.along": lambda w: SKIN.along(w(SKIN.places[:2])),
    "Skin.width": lambda w: [SKIN.width(w(SKIN.places[0])), SKIN.focus_width(w(SKIN.places[0]))],
    "Skin.motion": lambda w: SKIN.motion(w(np.array([0.0, 1e-3]))),
    "haptic": lambda w: midair.haptic(w(np.array([[-0.01, 0, 0.15], [0.01, 0, 0.15]])), ARRAY, rate=500).strength,
    "path.circle": lambda w: midair.path.circle(
        w(POINTS[0]), 0.01, normal=w(np.array([0, 0, 1.0])), frequency=5, pressures=w(np.ones(1))
    ).at([0.0]),
    "path.line": lambda w: midair.path.line(w(POINTS[0]), w(POINTS[1]), speed=1).at([0.0]),
    "path.polyline": lambda w: midair.path.polyline(w(FRAMES[:, 0]), speed=1).at([0.0]),
    "path.lissajous": lambda w: midair.path.lissajous(
        w(POINTS[0]), w(np.array([0.01, 0.01])), w(np.array([1, 2])), frequency=5
    ).at([0.0]),
    "path.still": lambda w: midair.path.still(w(POINTS), duration=1).at([0.0]),
    "path.morph": lambda w: midair.path.morph(w(POINTS), w(POINTS[::-1]), duration=1).at([0.5]),
    "path.from_array": lambda w: midair.path.from_array(w(FRAMES), rate=100, pressures=w(np.ones((4, 2)))).at([0.0]),
    "Path.at": lambda w: PATH.at(w(np.array([0.0, 0.01]))),
    "Path.modulated": lambda w: PATH.modulated(w(np.linspace(0, 1, 4)), samples_rate=200).frames(1000)[1],
    "path.fastest": lambda w: midair.path.fastest(w(RING), PAIR, margin=0.3).duration,
    "shape.line": lambda w: midair.shape.line(w(POINTS[0]), w(POINTS[1])),
    "shape.circle": lambda w: midair.shape.circle(w(POINTS[0]), 0.01, normal=w(np.array([0, 0, 1.0]))),
    "shape.polyline": lambda w: midair.shape.polyline(w(FRAMES[:, 0])),
    "Board": lambda w: midair.Board("autd3", corrections=w(0.1 * ONES)).encode(w(DRIVE)),
    "Connection": played,
}


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
@pytest.mark.parametrize("name", TAKE_ARRAYS)
def test_every_function_reads_arrays_of_another_library(name: str, other: Wrap) -> None:
    call = TAKE_ARRAYS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", midair.SceneWarning)
        np.testing.assert_equal(call(other), call(lambda values: values))


#: What is no array of finite numbers, by name; made from the array that a call needs.
ABSURD: dict[str, Wrap] = {
    "object": lambda _: object(),
    "text": lambda _: "1",
    "ragged": lambda _: [[1.0, 2.0], [3.0]],
    "huge": lambda _: [10**5000],
    "array of objects": lambda values: np.array(values, object),
    "masked": lambda values: np.ma.masked_all_like(values),
    "not finite": lambda values: values * np.nan,
    "empty": lambda _: [],
    "deep": lambda _: [[[[[0.0]]]]],
}


#: Functions of any number of times; and bodies whose numbers are checked when a scene is made.
ACCEPTED = {("Path.at", "empty"), ("Skin.motion", "empty"), ("Wall", "not finite"), ("Sphere", "not finite")}


@pytest.mark.parametrize(
    ("name", "absurd"), [pair for pair in itertools.product(TAKE_ARRAYS, ABSURD) if pair not in ACCEPTED]
)
def test_what_is_no_array_is_refused_in_one_line(name: str, absurd: str) -> None:
    with pytest.raises(midair.SceneError) as caught:
        TAKE_ARRAYS[name](ABSURD[absurd])
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_files_and_data_sets(other: Wrap, tmp_path: Path) -> None:
    for name, given in (("a.csv", DRIVE), ("a.npz", np.stack([DRIVE, DRIVE]))):
        midair.write(tmp_path / name, other(given))
        np.testing.assert_allclose(midair.read(tmp_path / name), given, atol=1e-15)
    midair.write(tmp_path / "points.csv", other(FRAMES), layout="points", rate=10)
    found = held_out(tmp_path / "set")
    drives = np.ones((sum(len(part["trial"]) for part in found.read("held_out")), 400), np.complex64)
    np.testing.assert_equal(found.judge(other(drives)), found.judge(drives))


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_memory_is_shared_where_the_layout_allows(other: Any) -> None:
    for values in (POINTS, POINTS.astype(np.float32), POINTS[::-1], np.asfortranarray(POINTS)):
        read = numbers("values", other(values), None, "", copy=False)
        assert np.shares_memory(read, values)
        np.testing.assert_array_equal(read, values)
        midair.Scene(ARRAY, other(values))


def test_a_gpu_gives_a_copy() -> None:
    if tuple(map(int, np.__version__.split(".")[:2])) < (2, 1):
        pytest.skip("numpy of before 2.1 does not ask for one")
    # In DLPack, (2, 0) is CUDA device 0.
    np.testing.assert_array_equal(midair.Scene(ARRAY, Tensor(POINTS, (2, 0))).points, POINTS)


def test_what_gives_nothing_away_is_refused_in_one_line() -> None:
    with pytest.raises(midair.SceneError, match="points is") as caught:
        midair.Scene(ARRAY, Locked(POINTS))
    assert "\n" not in str(caught.value)


def test_answers_go_out_in_place() -> None:
    solution = midair.solve(midair.Scene(ARRAY, POINTS))
    for answer in (
        solution.drive,
        solution.pressures,
        midair.field(solution.scene, solution, POINTS).pressure,
    ):
        assert np.shares_memory(np.from_dlpack(answer), answer)
        assert np.shares_memory(np.asarray(Interface(answer)), answer)
