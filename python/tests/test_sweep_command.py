"""`midair sweep`: the files it writes, and a message of one line for every bad request."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import zarr

import midair
from midair._sweep import table as files
from sweeps import REQUESTED, TOML, changed


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


Run = Callable[..., tuple[int, str, str]]


def test_the_command_writes_what_python_gives(run: Run) -> None:
    Path("sweep.toml").write_text(TOML, "utf-8")
    status, out, err = run("sweep", "sweep.toml", "-o", "table.csv", "--drives", "drives.zarr")
    assert (status, err) == (0, "")
    assert "wrote 18 rows to table.csv and drives.zarr" in out
    midair.sweep("sweep.toml", "again.csv")
    assert Path("table.csv").read_bytes() == Path("again.csv").read_bytes()
    assert zarr.open("drives.zarr", mode="r")["drive"].shape == (18, 400)


POINTS = REQUESTED["points"]
BAD: dict[str, tuple[dict[str, Any], str]] = {
    "an unknown key": ({"sedes": 4}, 'unknown key "sedes": did you mean seeds? known are seed, seeds'),
    "an unknown key of points": ({"points": {**POINTS, "w": 1}}, 'unknown key of points "w"'),
    "an unknown key of the array": (
        {"array": {"prest": "paper20"}},
        'sweep.json, line 1, column 35: unknown key of array "prest": did you mean preset?',
    ),
    "an unknown key of the medium": ({"medium": {"temprature": 20}}, 'unknown key of medium "temprature"'),
    "a medium that is none": ({"medium": 3}, "medium"),
    "an unknown solver": ({"solver": {"name": "gredy"}}, 'unknown solver "gredy": did you mean greedy?'),
    "no solver": ({"solver": None}, "solver is missing"),
    "an unknown option": ({"solver": {"name": "naive", "phases": 3}}, "phases"),
    "an option out of range": ({"solver": {"name": "greedy", "phases": [16, 1]}}, "phases"),
    "an empty list of an option": (
        {"solver": {"name": "greedy", "phases": []}},
        "phases of greedy is an empty list",
    ),
    "an empty list of points": ({"points": {**POINTS, "count": []}}, "points.count is an empty list"),
    "an empty list of seeds": ({"seeds": []}, "seeds is empty"),
    "an empty list of arrays": ({"array": []}, "array is missing"),
    "no seeds": ({"seeds": 0}, "seeds is 0: give a whole number, 1 or above"),
    "half a seed": ({"seed": 1.5}, "seed is 1.5"),
    "a seed below 0": ({"seeds": [3, -1]}, "seeds[1] is -1"),
    "no points": ({"points": None}, "points is missing"),
    "points of 0": ({"points": {**POINTS, "count": 0}}, "points.count is 0"),
    "more points than memory holds": ({"points": {**POINTS, "count": 10**17}}, "points.count is 1000"),
    "no range": (
        {"points": {"count": 2, "x": 0.0, "y": 0.0}},
        "points.z is None: give a number or [low, high]",
    ),
    "a range turned round": ({"points": {**POINTS, "x": [1.0, -1.0]}}, "points.x is [1.0, -1.0]"),
    "a range that is none": (
        {"points": {**POINTS, "x": [0.0, float("nan")]}},
        "no JSON here (a value is missing, or not a number",
    ),
    "more than 10^9": (
        {"seeds": 10**8},
        "4 x 3 x 100000000 problems: at most 10^9",
    ),
    "scenes beside an array": ({"scenes": ["a.toml"]}, "array is given beside scenes"),
    "no scenes": ({"scenes": [], "array": None, "points": None}, "scenes is empty"),
    "scenes in words": ({"scenes": "a.toml", "array": None, "points": None}, "scenes is 'a.toml'"),
    "a point on a transducer": (
        {"array": {"positions": [[0, 0, 0]]}, "points": {"count": 1, "x": 0, "y": 0, "z": 0}},
        "seed 0, 1 points: points[0]",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_request_is_one_line_and_nothing_is_written(name: str, run: Run) -> None:
    tables, words = BAD[name]
    Path("sweep.json").write_text(json.dumps(changed(**tables)), encoding="utf-8")
    status, out, err = run("sweep", "sweep.json", "-o", "table.csv")
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert err.startswith("error: ")
    assert words in err
    assert not Path("table.csv").exists()


def test_files_that_cannot_be_written_are_refused_first(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("sweep.toml").write_text(TOML, "utf-8")
    Path("mine.zarr").mkdir()
    for arguments, words in (
        (["-o", "table.txt"], "no known ending"),
        (["-o", "nowhere/table.csv"], "not there"),
        (["-o", "table.csv", "--drives", "drives"], "ends in .zarr"),
        (["-o", "table.csv", "--drives", "mine.zarr"], "made by no sweep"),
        (["-o", "table.csv", "--drives", "nowhere/drives.zarr"], "cannot be written"),
        (["-o", "table.csv", "--seeds", "4"], "--seeds"),
        ([], "--output"),
    ):
        status, _, err = run("sweep", "sweep.toml", *arguments)
        assert (status, err.count("\n")) == (2, 1), err
        assert words in err
    for content, words in (("[array\n", "sweep.toml"), ("\x00", "sweep.toml")):
        Path("sweep.toml").write_text(content, "utf-8")
        status, _, err = run("sweep", "sweep.toml", "-o", "table.csv")
        assert (status, err.count("\n")) == (2, 1)
        assert words in err
    assert "No such file" in run("sweep", "missing.toml", "-o", "table.csv")[2]


def test_what_an_extra_brings_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "find_spec", lambda name: None)
    for places in ({"output": "table.parquet"}, {"drives": "drives.zarr"}):
        with pytest.raises(midair.SceneError, match=r'pip install "midair\[sweep\]"'):
            midair.sweep(REQUESTED, **places)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(midair.SceneError, match=r'pip install "midair\[cluster\]"'):
        midair.sweep(REQUESTED, scheduler="tcp://127.0.0.1:1")
