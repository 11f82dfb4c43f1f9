"""Values can be pickled, copied, compared, saved, read back and shown in notebooks; results are read-only."""

import copy
import functools
import io
import json
import multiprocessing
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._support.text import html
from scenes import POINTS, numbers, same_bits, small
from test_refusals import refused

BOARD = midair.Array.preset(
    "autd3",
    (2, 1),
    directivity={"piston": 4.5e-3},
    response=np.exp(1j * np.arange(498)),
    mask=np.arange(498) != 7,
    quantization={"phases": 16, "amplitudes": [0, 1]},
)
FREE = midair.Array.preset("autd3", quantization={})
TOML = """
[array]
grid = { nx = 8, ny = 8, pitch = 10e-3 }
[[points]]
position = [0.0, 0.01, 0.15]
pressure = 1000.0
[solver]
name = "greedy"
phases = 8
[plane]
z = 0.15
size = 0.1
"""
MATRIX = 30 * np.exp(1j * np.arange(24)).reshape(2, 12)


@functools.cache
def file_scene() -> midair.Scene:
    return midair.Scene.parse(TOML)


def matrix_solution() -> midair.Solution:
    return midair.solve(
        midair.Propagation(MATRIX),
        "greedy",
        pressures=[250, 200],
        weights=[1, 2],
        quantization={"phases": 8},
        mask=np.arange(12) != 3,
        positions=midair.Array.grid(4, 3, 0.01).positions,
        order="columns",
        phases=8,
    )


def scaled_solution() -> midair.Solution:
    with pytest.warns(midair.SceneWarning, match="scale"):
        solution = midair.solve(midair.Scene(BOARD, POINTS, 300.0), "greedy", balance=True)
    assert solution.scale < 1
    return solution


def batch(**options: Any) -> midair.Batch:
    points = np.array(POINTS) + np.arange(5)[:, None, None] * 1e-3
    return midair.solve_batch(small(temperature=20), points, solver="greedy", seed=3, **options)


#: One value of each type, and of each way to make it.
VALUES: dict[str, Callable[[], Any]] = {
    "grid": lambda: midair.Array.grid(3, 2, 0.01),
    "positions": lambda: midair.Array([[0, 0, 0], [0.1, 1 / 3, 0]], [[0, 0, 1], [1, 2, 3]]),
    "board": lambda: BOARD,
    "preset with any drive": lambda: FREE,
    "plane": lambda: midair.Plane(0.15, 0.1, 3, (0.01, 1 / 3)),
    "propagation": lambda: midair.Propagation(MATRIX),
    "scene": lambda: small(pressures=[1, 2, 3, 1 / 3], weights=2, temperature=21, absorption=0.15),
    "scene of a file": file_scene,
    "metrics": lambda: midair.solve(small(), "naive").metrics,
    "solution": lambda: midair.solve(small(), "gs", trace=True, tolerance=1e-3),
    "solution of a file": lambda: midair.solve(file_scene()),
    "solution on a board": lambda: midair.solve(midair.Scene(BOARD, POINTS), "greedy", order=list(range(498))),
    "solution with a scale": scaled_solution,
    "solution of a Solver": lambda: midair.Solver(small(), "fast")(POINTS, weights=[1, 0, 1, 1]),
    "solution of a matrix": matrix_solution,
    "batch": batch,
    "batch of a matrix": lambda: midair.solve_batch(midair.Propagation(MATRIX), pressures=[[150, 150], [120, 120]]),
    "problem of a batch": lambda: batch()[-1],
    "batch metrics": lambda: batch().metrics,
    "upright plane": lambda: midair.Plane(axis="y", at=0.01, size=0.1, pixels=3, center=(1 / 3, 0.1)),
    "field in a plane": lambda: midair.field(small(), np.ones(64), midair.Plane(0.15, 0.1, 3)),
    "field of a solution": lambda: midair.field(small(), midair.solve(small(), "naive")),
    "field at points": lambda: midair.field(small(), np.ones(64), POINTS),
    "reach": lambda: small().reach(),
    "preset info": lambda: midair.presets()["autd3"],
    "solver info": lambda: midair.solvers()["greedy"],
    "option info": lambda: midair.solvers()["greedy"].options["phases"],
    "solvers": midair.solvers,
}


def attributes(value: Any) -> dict[str, Any]:
    """Returns every attribute of a value, with arrays as plain data."""
    if isinstance(value, dict):
        return value

    def plain(part: Any) -> Any:
        if isinstance(part, np.ndarray):
            return (part.dtype, part.shape, part.tobytes())
        return {key: plain(entry) for key, entry in part.items()} if isinstance(part, dict) else part

    names = [name for name in dir(value) if not name.startswith("_")]
    return {name: plain(part) for name in names if not callable(part := getattr(value, name))}


@pytest.mark.parametrize("kind", VALUES)
def test_copies_are_equal_to_the_last_bit(kind: str) -> None:
    value = VALUES[kind]()
    copies = [pickle.loads(pickle.dumps(value, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]
    for other in (*copies, copy.copy(value), copy.deepcopy(value)):
        assert type(other) is type(value)
        assert other == value
        assert attributes(other) == attributes(value)
        assert repr(other) == repr(value)
    if type(value).__hash__ is not None:
        assert len({value, *copies}) == 1


@pytest.mark.parametrize("kind", VALUES)
def test_a_value_equals_no_other(kind: str) -> None:
    value = VALUES[kind]()
    others = [make() for name, make in VALUES.items() if name != kind]
    assert all(value != other and other != value for other in others)
    assert value != 1
    assert value != "value"


def test_equality_is_by_value() -> None:
    grid = midair.Array.grid(3, 2, 0.01)
    assert grid == midair.Array(grid.positions) == midair.Array.grid(3, 2, 0.01, mask=[True] * 6)
    assert hash(grid) == hash(midair.Array(-grid.positions[::-1]))
    assert grid != midair.Array.grid(3, 2, 0.01, mask=[True] * 5 + [False])
    assert midair.solve(small(), "greedy", seed=1) == midair.solve(small(), "greedy", seed=1)
    assert midair.solve(small(), "greedy", seed=1) != midair.solve(small(), "greedy", seed=2)
    assert midair.solve(small(), "naive") != midair.solve(small(pressures=5.0), "naive", balance=True)


@pytest.mark.parametrize("kind", VALUES)
def test_answers_cannot_be_written(kind: str) -> None:
    value = VALUES[kind]()
    parts = [getattr(value, name) for name in dir(value) if not name.startswith("_")]
    parts += list(value.asdict().values()) if hasattr(value, "asdict") else []
    parts += [value.propagation()] if isinstance(value, midair.Scene) else []
    for part in parts:
        for array in part.values() if isinstance(part, dict) else [part]:
            assert not (isinstance(array, np.ndarray) and array.flags.writeable)


def drive_of(scene: midair.Scene) -> midair.Solution:
    return midair.solve(scene, "greedy", seed=1)


@pytest.mark.slow
def test_other_processes_send_equal_values() -> None:
    scenes = [small(), file_scene()]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(drive_of, scenes) == [drive_of(scene) for scene in scenes]


@pytest.mark.filterwarnings("ignore:the pressures are missed")
@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_a_copied_solver_has_its_own_memory(how: Callable[[midair.Solver], midair.Solver]) -> None:
    array = midair.Array.grid(8, 8, 0.01, mask=np.arange(64) != 3)
    solver = midair.Solver(
        array, "tikhonov", points=4, temperature=30, absorption=0.1, balance=True, regularization=0.2
    )
    other = how(solver)
    assert (other.options, repr(other)) == (solver.options, repr(solver))
    assert other(POINTS) == solver(POINTS)
    given = midair.Solver(midair.Propagation(MATRIX), "uniform", aim="target", quantization={"phases": 8})
    assert how(given)(pressures=[120, 120]) == given(pressures=[120, 120])


def test_replace_changes_what_is_named() -> None:
    scene = file_scene()
    assert scene.replace() == scene
    for name, value in {
        "points": np.array([[0.01, 0, 0.1]]), "pressures": np.array([1200.0]), "weights": np.array([2.0]),
        "array": BOARD, "frequency": 41e3, "sound_speed": 343.0, "absorption": 0.1, "density": 1.2,
        "plane": midair.Plane(0.1, 0.1),
    }.items():  # fmt: skip
        changed = scene.replace(**{name: value})
        assert changed != scene
        for part in ("points", "pressures", "weights", "array", "frequency", "sound_speed", "absorption",
                     "density", "plane", "solver"):  # fmt: skip
            wanted = value if part == name else getattr(scene, part)
            assert np.array_equal(getattr(changed, part), wanted), part
    assert scene.replace(temperature=20).sound_speed == midair.Scene(BOARD, POINTS, temperature=20).sound_speed
    assert scene.replace(source_pressure=2.0, directivity="cos").array.source_pressure == 2
    assert scene.replace(pressures=None).pressures is None
    assert scene.replace(plane=None).plane is None
    assert scene.replace(frequency=None, points=None, array=None) == scene
    assert scene.replace(points=POINTS, pressures=7).pressures.tolist() == [7] * 4
    assert midair.solve(scene.replace(frequency=41e3)).scene == scene.replace(frequency=41e3)
    refused(lambda: scene.replace(points=POINTS), "pressures", "kept from 1 points", "4 points, or None")
    refused(lambda: scene.replace(array=3), "array")
    refused(lambda: scene.replace(plane=3), "plane")
    refused(lambda: scene.replace(pressure=3), "pressure", "known are")
    refused(lambda: scene.replace(points=[[0, 0, np.nan]]), "points[0]")


def test_what_is_given_beside_a_scene_replaces_its_own() -> None:
    scene, beside = file_scene(), {"pressures": 1200.0, "weights": 2.0}
    changed = scene.replace(**beside)
    assert midair.solve(scene, **beside) == midair.solve(changed)
    assert midair.solve(scene, **beside).scene == changed
    assert midair.judge(scene, np.ones(64), **beside) == midair.judge(changed, np.ones(64))
    assert midair.bound(scene, **beside) == midair.bound(changed)
    board = {"mask": np.arange(64) != 3, "quantization": {"phases": 8}}
    array = midair.Array.grid(8, 8, 0.01, **board)
    assert midair.solve(scene, **board).scene == scene.replace(array=array)
    assert midair.solve(scene, **board).drive[3] == 0
    refused(lambda: midair.solve(scene, pressures=[1, 2]), "pressures")
    twice = small(points=[POINTS[0]] * 2)
    for replaced in (
        lambda: twice.replace(pressures=[500, 0]),
        lambda: midair.solve(twice, pressures=[500, 0]),
    ):
        with pytest.warns(midair.SceneWarning, match="points"):
            replaced()
    refused(lambda: midair.solve(scene, positions=[[0, 0, 0]]), "positions", "array")


@pytest.mark.parametrize("ending", [".npz", ".json", ".JSON"])
@pytest.mark.parametrize("kind", [kind for kind in VALUES if kind.startswith(("solution", "problem"))])
def test_solutions_are_saved_and_read(kind: str, ending: str, tmp_path: Path) -> None:
    value, path = VALUES[kind](), tmp_path / f"solution{ending}"
    if value.scene is None:
        refused(lambda: value.save(path), "matrix", "pickle")
        assert not path.exists()
        return
    value.save(path)
    loaded = midair.Solution.load(path)
    assert loaded == value
    assert attributes(loaded) == attributes(value)
    assert (loaded.scene, loaded.elapsed) == (value.scene, value.elapsed)


class Malice:
    """An object that calls a function when it is unpickled."""

    def __reduce__(self) -> Any:
        return pytest.fail, ("a file was run",)


def npz(**arrays: Any) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def test_files_that_are_no_solution_are_refused(tmp_path: Path) -> None:
    whole = tmp_path / "whole.npz"
    midair.solve(file_scene()).save(whole)
    parts = dict(np.load(whole))
    scene = json.loads(str(parts["scene"]))
    damaged: dict[str, bytes] = {
        "empty.npz": b"",
        "text.npz": b"drive",
        "cut.npz": whole.read_bytes()[:-100],
        "one.npz": npz(drive=1),
        "array.npz": pickle.dumps(Malice()),
        "malice.npz": npz(**parts | {"drive": np.array([Malice()], object)}),
        "short.npz": npz(**parts | {"drive": parts["drive"][:-1]}),
        "other.npz": npz(**parts | {"drive": -parts["drive"]}),
        "loud.npz": npz(**parts | {"drive": 2 * parts["drive"]}),
        "nan.npz": npz(**parts | {"pressures": parts["pressures"] * np.nan}),
        "scale.npz": npz(**parts | {"scale": 2.0}),
        "steps.npz": npz(**parts | {"steps": -1}),
        "targets.npz": npz(**parts | {"targets": [-1.0]}),
        "status.npz": npz(**parts | {"scene": json.dumps(scene | {"status": "well"})}),
        "scene.npz": npz(**parts | {"scene": json.dumps(scene | {"points": []})}),
        "empty.json": b"",
        "deep.json": b"[" * 100_000,
        "list.json": b"[1, 2]",
        "scene.json": file_scene().json().encode(),
        "bytes.json": b"\xff\xfe",
    }
    for name, content in damaged.items():
        path = tmp_path / name
        path.write_bytes(content)
        refused(lambda path=path: midair.Solution.load(path), name)
    refused(lambda: midair.Solution.load(tmp_path / "a.csv"), "give .npz or .json")
    with pytest.raises(FileNotFoundError):
        midair.Solution.load(tmp_path / "none.npz")


def test_a_batch_gives_the_solution_of_each_problem() -> None:
    answers = batch()
    points = np.array(POINTS) + np.arange(5)[:, None, None] * 1e-3
    scene = small(temperature=20)
    for k, solution in enumerate(answers):
        alone = midair.solve(scene.replace(points=points[k]), "greedy", seed=3)
        assert solution == alone == answers[k - 5]
        assert same_bits(solution.drive, answers.drives[k])
        assert same_bits(solution.targets, alone.targets)
        assert numbers(solution.metrics) == {name: part[k] for name, part in answers.metrics.asdict().items()}
    assert k == 4
    for index in (5, -6, 2**70):
        with pytest.raises(IndexError):
            answers[index]
    weighted = midair.solve_batch(small(), points, 900.0, "lm", weights=[1, 1, 0, 2])
    assert weighted[2] == midair.solve(small(points=points[2], pressures=900.0, weights=[1, 1, 0, 2]), "lm")
    given = VALUES["batch of a matrix"]()
    assert given[1] == midair.solve(midair.Propagation(MATRIX), given[1].solver, pressures=[120, 120])


def test_a_batch_tells_when_its_drives_were_written_over() -> None:
    out = np.zeros((5, 64), np.complex64)
    answers = batch(out=out)
    assert answers[2] == batch()[2]
    out[2] = 1
    refused(lambda: answers[2], "drives[2]", "written over")


def test_metrics_are_a_dictionary() -> None:
    solution = midair.solve(small())
    assert solution.metrics.asdict() == numbers(solution.metrics)


SHOWN = ("board", "grid", "scene", "solution", "problem", "field", "batch of", "solvers")


@pytest.mark.parametrize("kind", [kind for kind in VALUES if kind.startswith(SHOWN)])
def test_notebooks_show_tables(kind: str) -> None:
    html = VALUES[kind]()._repr_html_()
    assert html.startswith("<table>")
    assert html.count("<table>") == html.count("</table>")
    assert "script" not in html
    if kind == "solvers":
        assert "greedy" in html
        assert any(line.startswith("greedy ") for line in repr(midair.solvers()).splitlines())
    else:
        assert "midair." in html


def test_notebooks_escape_and_cut() -> None:
    text = midair.solve(small(points=np.array(POINTS * 5) + np.arange(20)[:, None] * 1e-3))._repr_html_()
    assert "the first of 20" in text
    assert "<td>&lt;b&gt;&amp;</td>" in html({"name": ["<b>&"]})


def test_refusals_name_what_to_change() -> None:
    refused(lambda: midair.solve(midair.Propagation(MATRIX), [1, 1]), "pressures=")
    dead = midair.Propagation(np.zeros((1, 3)))
    assert "array" not in refused(lambda: midair.solve(dead), "matrix", "masked")
    off = midair.Propagation(np.ones((1, 3)))
    assert "array" not in refused(lambda: midair.solve(off, mask=[False] * 3), "matrix", "masked")
    dark = midair.Array.grid(2, 2, 0.01, mask=[False] * 4)
    refused(lambda: midair.solve(midair.Scene(dark, [[0, 0, 0.1]])), "mask", "on")
