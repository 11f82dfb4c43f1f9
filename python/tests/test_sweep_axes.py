"""Axes of sweeps: a varied parameter is a column, and a row is what `solve` gives for its scene."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import zarr

import midair
from midair._sweep.request import read
from sweeps import equal

GRID = {"nx": 8, "ny": 8, "pitch": 0.01}
PLACES = [[-0.02, 0.0, 0.12], [0.015, 0.01, 0.12]]

#: A sweep without randomness: every row can be computed by a line of Python.
STILL: dict[str, Any] = {
    "array": {"grid": GRID},
    "points": {"positions": PLACES, "pressure": 200.0},
    "solver": {"name": "gspat", "balance": True},
}


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def solved(points: Any = PLACES, pressures: Any = 200.0, medium: Any = None, **array: Any) -> float:
    """Returns the residual of `solve` for a scene."""
    grid = {**GRID, **array.pop("grid", {})}
    scene = midair.Scene(midair.Array.grid(**grid, **array), points, pressures, **(medium or {}))
    return midair.solve(scene, "gspat", balance=True).metrics.residual


#: Values of each axis, and a function that computes the residual of one value.
AXES: dict[str, tuple[list[Any], Callable[[Any], float]]] = {
    "medium.temperature": ([15, 25.5], lambda value: solved(medium={"temperature": value})),
    "medium.frequency": ([40e3, 25e3], lambda value: solved(medium={"frequency": value})),
    "array.grid.pitch": ([0.009, 0.0105], lambda value: solved(grid={"pitch": value})),
    "array.source_pressure": ([2.0, 4.386], lambda value: solved(source_pressure=value)),
    "array.directivity": (["point", {"cos": 2.0}], lambda value: solved(directivity=value)),
    "array.mask": (
        [np.arange(64) > 5, np.arange(64) < 50],
        lambda value: solved(mask=value),
    ),
    "array.quantization": ([{"phases": 4}, {}], lambda value: solved(quantization=value or None)),
    "array.quantization.phases": ([4, 16], lambda value: solved(quantization={"phases": value})),
    "points.pressure": ([100, 250.0], lambda value: solved(pressures=value)),
    "points.pressures": ([[100, 200], [300, 150]], lambda value: solved(pressures=value)),
    "points.positions": (
        [[[0, 0, 0.1]], [[0, 0, 0.1], [0.02, 0, 0.1], [0, 0.02, 0.1]]],
        lambda value: solved(value),
    ),
    "points.shift": (
        [[0, 0, 0], (0.01, 0.0, -0.02)],
        lambda value: solved(np.add(PLACES, value)),
    ),
}


@pytest.mark.parametrize("name", AXES)
def test_an_axis_is_a_column_and_its_rows_are_what_solve_gives(name: str) -> None:
    values, expected = AXES[name]
    # The axis points.pressures replaces the request's points.pressure.
    table = midair.sweep({**STILL, "axes": {name: values}})
    assert name in list(table)
    assert table["residual"].tolist() == [expected(value) for value in values]
    assert len(set(table[name].tolist())) == 2
    scalar = all(isinstance(value, int | float) for value in values)
    assert not scalar or table[name].tolist() == values


@pytest.mark.slow
def test_axes_are_crossed_and_a_random_point_is_the_same_along_them() -> None:
    request = {
        "array": [{"grid": GRID}, {"preset": "autd3"}],
        "medium": {"temperature": [15, 35]},
        "points": {"count": [1, 2], "x": [-0.03, 0.03], "y": 0.0, "z": 0.1, "pressure": [500, 600]},
        "axes": {"points": {"z": [0.1, 0.15], "shift": [[0, 0, 0], [0, 0.01, 0]]}},
        "solver": {"name": "naive", "limit": ["clamp", "normalize"], "balance": True},
        "seeds": 3,
    }
    table = midair.sweep(request, drives="drives.zarr")
    assert list(table)[1:10] == [
        *("array", "transducers", "points", "medium.temperature", "points.z", "points.shift"),
        *("solver", "limit", "balance"),
    ]
    assert len(table["index"]) == 2 * 2 * 2 * 2 * 2 * 2 * 3
    stored = zarr.open("drives.zarr", mode="r")
    points = stored["points"][:].reshape(2, 2, 2, 2, 2, 2, 3, 2, 3)
    targets = stored["targets"][:].reshape(2, 2, 2, 2, 2, 2, 3, 2)
    assert np.array_equal(points[0], points[1], equal_nan=True)
    assert (targets == targets[:1, :, :1, :1, :1, :1]).all()
    one = points[:, 1]
    assert (one[:, 0] == one[:, 1]).all()
    assert (one[:, :, 0, ..., 2] == 0.1).all()
    assert (one[:, :, 1, ..., 2] == 0.15).all()
    assert (one[..., 0, :, :, :, 1] == 0.0).all()
    assert (one[..., 1, :, :, :, 1] == 0.01).all()
    assert (one[:, :, 0, ..., 0] == one[:, :, 1, ..., 0]).all()


@pytest.mark.slow
def test_files_spell_axes_in_every_way_of_toml() -> None:
    rest = """
        [array]
        grid = { nx = 8, ny = 8, pitch = 0.01 }
        [[points]]
        position = [0.0, 0.0, 0.1]
        pressure = 200
        [solver]
        name = "gspat"
        balance = true
    """
    ways = {
        "dots": "[axes]\nmedium.temperature = [15, 25]\narray.quantization = [{ phases = 4 }, {}]\n",
        "quotes": '[axes]\n"medium.temperature" = [15, 25]\n"array.quantization" = [{ phases = 4 }, {}]\n',
        "tables": "[axes.medium]\ntemperature = [15, 25]\n[axes.array]\nquantization = [{ phases = 4 }, {}]\n",
    }
    found = []
    for name, text in ways.items():
        Path(f"{name}.toml").write_text(text + rest, "utf-8")
        found.append(midair.sweep(f"{name}.toml", f"{name}.csv"))
    assert equal(found[0], found[1])
    assert equal(found[0], found[2])
    assert found[0]["array.quantization"].tolist() == ['{"phases": 4}', "{}"] * 2
    assert Path("dots.csv").read_text("utf-8").startswith("index,array,transducers,points,medium.temperature,array.")
    midair.sweep("dots.toml", "dots.parquet")
    assert pq.read_table("dots.parquet")["medium.temperature"].to_pylist() == [15, 15, 25, 25]


def test_a_list_where_one_value_is_meant_is_an_axis() -> None:
    request = {**STILL, "array": {"grid": GRID, "source_pressure": [1.0, 4.0]}, "medium": {"density": [1, 2]}}
    axes = {"array.source_pressure": [1.0, 4.0], "medium.density": [1, 2]}
    table = midair.sweep(request)
    assert equal(table, midair.sweep({**STILL, "axes": axes}))
    assert list(table)[4:6] == list(axes)


def test_fixed_points_are_those_of_a_scene_file() -> None:
    points = [{"position": place, "pressure": 200.0, "weight": 0.5 + k} for k, place in enumerate(PLACES)]
    table = midair.sweep({**STILL, "points": points, "solver": {"name": "lm", "seed": 2, "balance": True}})
    scene = midair.Scene(midair.Array.grid(8, 8, 0.01), PLACES, 200.0, weights=[0.5, 1.5])
    assert table["residual"].tolist() == [midair.solve(scene, "lm", seed=2, balance=True).metrics.residual]
    drawn = midair.sweep({**STILL, "points": {"positions": PLACES, "pressure": [150, 250]}, "seeds": 4})
    assert len(set(drawn["residual"])) == 4


ARRAYS = {
    "grid": midair.Array.grid(8, 8, 0.01, source_pressure=2.0, directivity={"cos": 2.0}),
    "preset": midair.Array.preset("autd3", (2, 1)),
    "positions": midair.Array(
        np.random.default_rng(0).uniform(-0.05, 0.05, (30, 3)) * [1, 1, 0],
        response=np.exp(1j * np.arange(30.0)),
        mask=np.arange(30) > 3,
        quantization={"phases": 8, "amplitudes": [0.25, 1.0]},
    ),
}


def test_arrays_may_be_objects() -> None:
    points = {"positions": np.array(PLACES), "pressure": np.float32(300)}
    request = {"array": list(ARRAYS.values()), "points": points, "solver": {"name": "gspat", "balance": True}}
    table = midair.sweep(request, drives="drives.zarr")
    assert table["array"].tolist() == [0, 1, 2]
    drives = zarr.open("drives.zarr", mode="r")["drive"]
    for index, array in enumerate(ARRAYS.values()):
        alone = midair.sweep({**request, "array": array})
        solution = midair.solve(midair.Scene(array, PLACES, 300.0), "gspat", balance=True)
        assert table["residual"][index] == alone["residual"][0] == solution.metrics.residual
        assert np.array_equal(drives[index, : len(array)], solution.drive)
    mixed = midair.sweep({**request, "array": [ARRAYS["grid"], {"preset": "autd3"}]})
    assert mixed["transducers"].tolist() == [64, 249]


@pytest.mark.slow
def test_scenes_may_be_objects_beside_files() -> None:
    scenes = [
        midair.Scene(array, PLACES, [300.0, 200.0], weights=[1.0, 0.5], temperature=20.0) for array in ARRAYS.values()
    ]
    scenes[0].save("scene.toml")
    request = {"scenes": ["scene.toml", *scenes], "solver": {"name": "gspat", "balance": True}}
    table = midair.sweep(request, "table.parquet")
    assert table["scene"].tolist() == ["scene.toml", 1, 2, 3]
    assert pq.read_table("table.parquet")["scene"].to_pylist() == ["scene.toml", "1", "2", "3"]
    expected = [midair.solve(scene, "gspat", balance=True).metrics.residual for scene in (scenes[0], *scenes)]
    assert table["residual"].tolist() == expected
    axis = midair.sweep({**request, "scenes": scenes[:1], "axes": {"medium.temperature": [20.0, 30.0]}})
    assert axis["residual"][0] == expected[0]
    assert axis["residual"][1] != expected[0]
    assert axis["scene"].tolist() == [0, 0]


def test_positions_may_lie_in_files_beside_the_sweep() -> None:
    Path("study").mkdir()
    bowl = ARRAYS["positions"].positions
    np.savetxt("study/bowl.csv", bowl, delimiter=",", fmt="%.17g")
    np.savetxt("study/flat.csv", bowl[:9], delimiter=",", fmt="%.17g")
    values = [{"file": "bowl.csv"}, {"file": "flat.csv"}]
    request = {"array": {"positions": values[0]}, "axes": {"array.positions": values}}
    points = {"positions": PLACES, "pressure": 20.0}
    Path("study/sweep.json").write_text(json.dumps({**STILL, **request, "points": points}), encoding="utf-8")
    table = midair.sweep("study/sweep.json")
    assert table["transducers"].tolist() == [30, 9]
    for residual, array in zip(table["residual"], (bowl, bowl[:9]), strict=True):
        scene = midair.Scene(midair.Array(array), PLACES, 20.0)
        assert residual == midair.solve(scene, "gspat", balance=True).metrics.residual
    with pytest.raises(midair.SceneError, match=r"flat\.csv\" itself"):
        midair.sweep("study/sweep.json", "study/flat.csv")


def test_an_axis_of_presets_brings_their_own_pressure_even_to_an_object() -> None:
    array = midair.Array.preset("paper20")
    scene = midair.Scene(array, PLACES)
    names = ["paper20", "autd3"]
    for own in ({"array": array, "points": {"positions": PLACES}}, {"scenes": [scene]}):
        # A scene has its own medium; without a scene each array has its default medium.
        air = scene.medium if "scenes" in own else {}
        each = [midair.Scene(midair.Array.preset(name), PLACES, **air) for name in names]
        expected = [midair.solve(one, "uniform").pressures for one in each]
        request = {**own, "axes": {"array.preset": names}, "solver": {"name": "uniform"}}
        midair.sweep(request, drives="drives.zarr")
        assert np.array_equal(zarr.open("drives.zarr", mode="r")["pressures"][:], expected)


def test_numbers_and_kept_results_depend_on_what_is_requested_and_not_on_how() -> None:
    objects = read({**STILL, "array": midair.Array.grid(8, 8, 0.01)}).blocks
    again = read({**STILL, "array": midair.Array.grid(np.int64(8), 8, 0.01)}).blocks
    other = read({**STILL, "array": midair.Array.grid(8, 8, 0.01, mask=np.arange(64) > 0)}).blocks
    assert objects[0].settings == again[0].settings != other[0].settings
    assert json.dumps(objects[0].settings) == json.dumps(again[0].settings)


SELF: list[Any] = []
SELF.append(SELF)

BAD: dict[str, tuple[dict[str, Any], str]] = {
    "a key that is none": ({"axes": {"medium.temprature": [15]}}, "medium.temprature = 15"),
    "no table": ({"axes": {"temperature": [15]}}, 'unknown axis "temperature": give a key of array, medium'),
    "a whole table": ({"axes": {"array": [{"preset": "autd3"}]}}, 'unknown axis "array"'),
    "an option": ({"axes": {"solver.limit": ["full"]}}, "options of a solver and points.count take lists"),
    "one value": (
        {"axes": {"medium.temperature": 15}},
        "axis medium.temperature is 15: give a list of values",
    ),
    "no value": ({"axes": {"medium": {"temperature": []}}}, "axis medium.temperature is []: give a list"),
    "no axes": ({"axes": [15]}, "axes is [15]: give a table [axes]"),
    "a word for a number": ({"axes": {"medium.temperature": [15, "hot"]}}, "medium.temperature = 'hot'"),
    "given twice": (
        {"medium": {"temperature": [15]}, "axes": {"medium.temperature": [20]}},
        "axis medium.temperature is given twice",
    ),
    "a mask of another length": ({"axes": {"array.mask": [[True]]}}, "array.mask"),
    "fixed and random points": ({"axes": {"points.count": [2]}}, "points.count is given beside positions"),
    "pressures for others": (
        {"points": {"positions": PLACES, "pressures": [1.0]}},
        "points.pressures is [1.0]: give 2 numbers, one a point",
    ),
    "both pressures": (
        {"points": {"positions": PLACES, "pressures": [1.0, 2.0], "pressure": 3.0}},
        "points.pressure is given beside pressures",
    ),
    "positions of two numbers": ({"points": {"positions": [[0, 0.1]]}}, "points.positions is [[0, 0.1]]"),
    "weights of random points": (
        {"points": {"count": 1, "x": 0, "y": 0, "z": 0.1, "weights": [1.0]}},
        "points.weights is given without positions",
    ),
    "a shift of one number": ({"axes": {"points.shift": [0.1]}}, "points.shift is 0.1: give three numbers"),
    "a range of three": (
        {"points": {"count": 1, "x": 0, "y": 0, "z": [0.1, 0.15, 0.2]}},
        "several go into an axis, points.z = [...] in [axes]",
    ),
    "a point without position": ({"points": [{"pressure": 3.0}]}, "points[0] is {'pressure': 3.0}"),
    "a pressure here and there": (
        {"points": [{"position": PLACES[0], "pressure": 1.0}, {"position": PLACES[1]}]},
        "points: 1 of 2 have a pressure",
    ),
    "an array that is a scene": ({"array": midair.Scene(ARRAYS["grid"], PLACES)}, "array is "),
    "a set": ({"array": {"preset": {"autd3"}}}, "preset is {'autd3'}: give numbers, words, lists and tables"),
    "a list that holds itself": ({"axes": {"points.shift": SELF}}, "nested too deep, or holds itself"),
    "no number": (
        {"axes": {"medium.density": [float("nan")]}},
        "axes.medium.density[0] is nan: give a finite",
    ),
    "too many combinations": (
        {"axes": {"medium.density": [1.0] * 2000, "medium.absorption": [0.1] * 2000}},
        "4000000 combinations of its axes: at most 10^6",
    ),
    "a solver's name that is none": ({"solver": {"name": ["naive", "gs"]}}, "solver.name is ['naive', 'gs']"),
    "no option of a solver": (
        {"solver": {"name": "naive", "trace": True}},
        'unknown option of naive "trace"',
    ),
    "an argument of solve": ({"solver": {"name": "naive", "scene": 1}}, 'unknown option of naive "scene"'),
    "no Unicode": ({"solver": {"name": "\ud800"}}, "solver.name has '\\ud800'"),
    "a line break": ({"axes": {"array.directivity": ["point\n"]}}, "axes.array.directivity[0] has 'point"),
    "a scene for a number": (
        {"axes": {"points.z": [midair.Scene(ARRAYS["grid"], PLACES)]}},
        "axes.points.z[0] is <midair.Scene",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_axis_or_object_is_refused_in_one_line(name: str) -> None:
    tables, words = BAD[name]
    with pytest.raises(midair.SceneError) as refused:
        midair.sweep({**STILL, **tables}, "table.csv")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
    assert not list(Path().iterdir())


def test_two_columns_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from midair._sweep import request

    monkeypatch.setattr(request, "METRICS", (*request.METRICS, "limit"))
    with pytest.raises(midair.SceneError, match='two columns of the table would be called "limit"'):
        midair.sweep({**STILL, "solver": {"name": "naive", "limit": "full"}})
