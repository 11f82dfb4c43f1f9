"""Sweeps: the same numbers however they are worked off, whole files or none, bad requests in one line."""

import csv
import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import zarr

import midair
from midair import cli, output
from midair.sweep import block, work
from midair.sweep.engine import Job
from midair.sweep.request import read
from scenes import METRICS

#: There so that a hang is a failure and not a hung suite.
HANG = 60

ASKED: dict[str, Any] = {
    "seed": 3,
    "seeds": 5,
    "array": [{"preset": "paper20"}, {"grid": {"nx": 8, "ny": 8, "pitch": 0.01}}],
    "points": {"count": [2, 5], "x": [-0.04, 0.04], "y": [-0.04, 0.04], "z": 0.15, "pressure": [1.0, 2.0]},
    "solver": [{"name": "greedy", "phases": [8, 16]}, {"name": "naive", "balance": True}],
}

SCENE = """
[array]
grid = { nx = 8, ny = 6, pitch = 0.01 }
[[points]]
position = [-0.02, 0.0, 0.1]
pressure = 1900.0
[[points]]
position = [0.015, 0.01, 0.1]
pressure = 1700.0
weight = 0.5
"""

TOML = """
seeds = 3
[array]
preset = "paper20"
[points]
count = [2, 4]
x = [-0.05, 0.05]
y = [-0.05, 0.05]
z = 0.15
[[solver]]
name = "greedy"
[[solver]]
name = "gspat"
limit = ["clamp", "full"]
"""


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def changed(**tables: Any) -> dict[str, Any]:
    """ASKED with other tables, or without those given as None."""
    return {key: value for key, value in {**deepcopy(ASKED), **tables}.items() if value is not None}


def equal(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> bool:
    return list(a) == list(b) and all(np.array_equal(a[name], b[name]) for name in a)


def test_the_table_has_a_row_for_each_problem_in_order() -> None:
    table = midair.sweep(ASKED)
    assert list(table) == [
        *("index", "array", "transducers", "points", "solver", "phases", "balance", "trial"),
        *METRICS,
        "status",
    ]
    assert table["index"].tolist() == list(range(2 * 2 * 3 * 5))
    assert table["transducers"].tolist() == [400] * 30 + [64] * 30
    assert table["points"].tolist() == ([2] * 15 + [5] * 15) * 2
    assert table["phases"].tolist() == ([8] * 5 + [16] * 5 + [None] * 5) * 4
    assert table["trial"].tolist() == list(range(5)) * 12
    assert set(table["status"]) == {"done"}


def test_a_row_is_what_solve_gives_for_its_scene() -> None:
    drives = Path("drives.zarr")
    table = midair.sweep(ASKED, drives=drives)
    group = zarr.open(drives, mode="r")
    for index in (12, 40, 59):
        count, solver = table["points"][index], table["solver"][index]
        array = [midair.Array.preset("paper20"), midair.Array.grid(8, 8, 0.01)][table["array"][index]]
        scene = midair.Scene(array, group["points"][index, :count], group["targets"][index, :count])
        if solver == "greedy":
            # Its own seed is no column: what it reached must be what its drive gives.
            drive = group["drive"][index, : len(array)]
        else:
            solution = midair.solve(scene, "naive", balance=True)
            drive = solution.drive
            assert np.array_equal(drive, group["drive"][index, : len(array)])
            assert solution.metrics.accuracy == table["accuracy"][index]
        # The two precisions agree to f32 rounding of 400 summands.
        assert midair.judge(scene, drive).accuracy == pytest.approx(table["accuracy"][index], abs=1e-4)
        assert not group["drive"][index, len(array) :].any()
        assert np.isnan(group["points"][index, count:]).all()
        assert not group["targets"][index, count:].any()


def test_every_solver_gets_the_same_points_and_every_trial_its_own() -> None:
    midair.sweep(changed(array={"preset": "paper20"}), drives="drives.zarr")
    points = zarr.open("drives.zarr", mode="r")["points"][:15, :2].reshape(3, 5, 2, 3)
    assert (points[0] == points[1]).all()
    assert (points[0] == points[2]).all()
    assert len(np.unique(points[0].reshape(5, -1), axis=0)) == 5
    assert (np.abs(points[..., :2]) <= 0.04).all()
    assert (points[..., 2] == 0.15).all()


def test_a_longer_axis_changes_no_row_that_was_there() -> None:
    few = midair.sweep(changed(array={"preset": "paper20"}))
    points = {**ASKED["points"], "count": [5, 7]}
    many = midair.sweep(changed(array={"preset": "paper20"}, seeds=9, points=points))
    for trial in range(5):
        (a,) = few["accuracy"][(few["points"] == 5) & (few["trial"] == trial) & (few["phases"] == 8)]
        (b,) = many["accuracy"][(many["points"] == 5) & (many["trial"] == trial) & (many["phases"] == 8)]
        assert a == b


def test_seeds_may_be_listed() -> None:
    table = midair.sweep(changed(seeds=[7, 2]))
    assert table["trial"].tolist() == [7, 2] * 12
    assert table["accuracy"][1] == midair.sweep(ASKED)["accuracy"][2]


def test_threads_and_chunks_change_no_number() -> None:
    whole = midair.sweep(ASKED)
    assert equal(midair.sweep(ASKED, threads=1), whole)
    for chunk in (1, 2, 7):
        parts: list[dict[str, list[Any]]] = []
        work(read(ASKED), None, None, receive=parts.append, chunk=chunk)
        for name in METRICS:
            assert [value for part in parts for value in part[name]] == whole[name].tolist(), (chunk, name)


@pytest.mark.parametrize("scenes", [False, True], ids=["random", "scenes"])
def test_the_batch_solver_takes_what_shares_a_seed(scenes: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("scene.toml").write_text(SCENE)
    solvers = [{"name": "greedy"}, {"name": "greedy", "seed": 4}, {"name": "gspat", "balance": True}]
    request = {"scenes": ["scene.toml"], "solver": solvers, "seeds": 3} if scenes else changed(solver=solvers)
    batch = midair.solve_batch
    taken: list[str] = []

    def watched(array: midair.Array, points: Any, pressures: Any, solver: str, **options: Any) -> Any:
        taken.append(solver)
        return batch(array, points, pressures, solver, **options)

    monkeypatch.setattr(block._midair, "solve_batch", watched)
    midair.sweep(request, threads=1)
    settings = [part.settings for part in read(request).blocks]
    assert taken == [setting["solver"] for setting in settings if setting["options"]]


def test_csv_parquet_and_python_agree() -> None:
    table = midair.sweep(ASKED, "table.csv")
    with Path("table.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["sigma"]) for row in rows] == table["sigma"].tolist()
    assert [row["phases"] for row in rows[8:12]] == ["16", "16", "", ""]
    midair.sweep(ASKED, "table.parquet")
    stored = pq.read_table("table.parquet")
    for name, values in table.items():
        assert stored[name].to_pylist() == values.tolist(), name
    assert not [path for path in Path().iterdir() if path.name.startswith(".")]


def test_scenes_are_swept_relative_to_the_file() -> None:
    Path("scenes").mkdir()
    Path("scenes/two.toml").write_text(SCENE)
    Path("scenes/sweep.json").write_text(
        json.dumps({"scenes": ["two.toml"], "solver": {"name": "lm", "seed": 4}})
    )
    table = midair.sweep("scenes/sweep.json")
    assert list(table)[:6] == ["index", "scene", "transducers", "points", "solver", "seed"]
    expected = midair.solve(midair.Scene.load("scenes/two.toml"), "lm", seed=4).metrics
    assert table["residual"].tolist() == [expected.residual]


def test_a_stopped_sweep_goes_on_and_ends_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = midair.sweep(ASKED)
    written: list[Path] = []
    real = output.write

    def full(path: Path, content: bytes) -> None:
        if len(written) == 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(path)
        real(path, content)

    monkeypatch.setattr(output, "write", full)
    with pytest.raises(midair.SceneError, match=r"No space left on device.*what is done is kept$"):
        midair.sweep(ASKED, "table.csv", threads=1)
    assert not Path("table.csv").exists()
    assert len(list(Path().glob(".table.csv.chunks/*/*.npz"))) == 5

    monkeypatch.setattr(output, "write", lambda path, content: (written.append(path), real(path, content)))
    assert equal(midair.sweep(ASKED, "table.csv"), whole)
    assert len(written) == 12, "a chunk a block, none done twice"
    assert sorted(path.name for path in Path().iterdir()) == ["table.csv"]


def test_a_damaged_chunk_is_done_again(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = midair.sweep(ASKED)
    from midair.sweep.block import solve_block

    path = ".table.csv.chunks" / Job(solve_block, read(ASKED).blocks[0].settings, 0, 5).path
    path.parent.mkdir(parents=True)
    path.write_bytes(b"PK\x03\x04 and no more")
    assert equal(midair.sweep(ASKED, "table.csv"), whole)


def test_another_setting_seed_or_build_is_another_chunk(monkeypatch: pytest.MonkeyPatch) -> None:
    from midair.sweep import engine
    from midair.sweep.block import solve_block

    def path(**tables: Any) -> Path:
        return Job(solve_block, read(changed(**tables)).blocks[0].settings, 0, 5).path

    other = {**ASKED["points"], "pressure": 1.5}
    paths = [path(), path(seed=4), path(points=other), path(medium={"temperature": 25.0}), path(seeds=[1])]
    monkeypatch.setattr(engine, "build", lambda: "another")
    paths.append(path())
    assert len(set(paths)) == len(paths)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_keeps_what_is_done_and_says_so_in_one_line() -> None:
    Path("sweep.toml").write_text(TOML.replace('"greedy"', '"lm"').replace("seeds = 3", "seeds = 100000"))
    command = [sys.executable, "-m", "midair", "sweep", "sweep.toml", "--output", "table.csv"]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        end = time.monotonic() + HANG
        while not list(Path().glob(".table.csv.chunks/*/*.npz")):
            assert child.poll() is None
            assert time.monotonic() < end
            time.sleep(0.02)
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=HANG)
    finally:
        child.kill()
        child.wait()
    assert (child.returncode, out, err) == (130, "", "interrupted\n")
    assert list(Path().glob(".table.csv.chunks/*/*.npz"))
    assert not Path("table.csv").exists()
    assert not list(Path().rglob("*.part"))


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*arguments: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as left:
            cli.main(arguments)
        out, err = capsys.readouterr()
        return left.value.code, out, err

    return run


def test_the_command_writes_what_python_gives(run: Run) -> None:
    Path("sweep.toml").write_text(TOML)
    status, out, err = run("sweep", "sweep.toml", "-o", "table.csv", "--drives", "drives.zarr")
    assert (status, err) == (0, "")
    assert "wrote 18 rows to table.csv and drives.zarr" in out
    midair.sweep("sweep.toml", "again.csv")
    assert Path("table.csv").read_bytes() == Path("again.csv").read_bytes()
    assert zarr.open("drives.zarr", mode="r")["drive"].shape == (18, 400)


POINTS = ASKED["points"]
BAD: dict[str, tuple[dict[str, Any], str]] = {
    "an unknown key": ({"sedes": 4}, 'unknown key of sweep "sedes": known are seed, seeds'),
    "an unknown key of points": ({"points": {**POINTS, "w": 1}}, 'unknown key of points "w"'),
    "an unknown key of the array": (
        {"array": {"prest": "paper20"}},
        "array 0 or medium of the sweep: unknown field",
    ),
    "an unknown key of the medium": ({"medium": {"temprature": 20}}, "unknown field `temprature`"),
    "a medium that is none": ({"medium": 3}, "medium"),
    "an unknown solver": ({"solver": {"name": "gredy"}}, "unknown solver 'gredy': known are "),
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
    "no range": (
        {"points": {"count": 2, "x": 0.0, "y": 0.0}},
        "points.z is None: give a number or [low, high]",
    ),
    "a range turned round": ({"points": {**POINTS, "x": [1.0, -1.0]}}, "points.x is [1.0, -1.0]"),
    "a range that is none": ({"points": {**POINTS, "x": [0.0, float("nan")]}}, "points.x is [0.0, nan]"),
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
    Path("sweep.json").write_text(json.dumps(changed(**tables)))
    status, out, err = run("sweep", "sweep.json", "-o", "table.csv")
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert err.startswith("error: ")
    assert words in err
    assert not Path("table.csv").exists()


def test_files_that_cannot_be_written_are_refused_first(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("sweep.toml").write_text(TOML)
    Path("mine.zarr").mkdir()
    for arguments, words in (
        (["-o", "table.txt"], "no known ending"),
        (["-o", "nowhere/table.csv"], "not there"),
        (["-o", "table.csv", "--drives", "drives"], "ends in .zarr"),
        (["-o", "table.csv", "--drives", "mine.zarr"], "no Zarr group"),
        (["-o", "table.csv", "--drives", "nowhere/drives.zarr"], "cannot be written"),
        (["-o", "table.csv", "--seeds", "4"], "--seeds"),
        ([], "--output"),
    ):
        status, _, err = run("sweep", "sweep.toml", *arguments)
        assert (status, err.count("\n")) == (2, 1), err
        assert words in err
    for content, words in (("[array\n", "sweep.toml"), ("\x00", "sweep.toml")):
        Path("sweep.toml").write_text(content)
        status, _, err = run("sweep", "sweep.toml", "-o", "table.csv")
        assert (status, err.count("\n")) == (2, 1)
        assert words in err
    assert "No such file" in run("sweep", "missing.toml", "-o", "table.csv")[2]


def test_what_an_extra_brings_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    from midair import sweep as function

    module = sys.modules[function.__module__]
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    for files in ({"output": "table.parquet"}, {"drives": "drives.zarr"}):
        with pytest.raises(midair.SceneError, match=r'pip install "midair\[sweep\]"'):
            midair.sweep(ASKED, **files)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(midair.SceneError, match=r'pip install "midair\[cluster\]"'):
        midair.sweep(ASKED, scheduler="tcp://127.0.0.1:1")
